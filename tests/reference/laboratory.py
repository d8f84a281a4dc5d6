"""dwell-study on scenarios and on texts made from them, and what pages of its figures need."""

import json
import math
import statistics
import subprocess
from concurrent.futures import ThreadPoolExecutor


class Laboratory:
    def __init__(self, study, scenarios, divisor, directory):
        self.command, self.scenarios, self.divisor, self.directory = study.resolve(), scenarios.resolve(), divisor, directory

    def runs(self, count):
        return max(2, count // self.divisor)

    def text(self, scenario):
        return (self.scenarios / f"{scenario}.textproto").read_text(encoding="utf-8")

    def study(self, text, policies, *flags, name="scenario"):
        """The results of dwell-study on a config; its files are those of the scenarios."""
        text = text.replace('file: "', f'file: "{self.scenarios}/')
        config = self.directory / f"{name}.textproto"
        config.write_text(text, encoding="utf-8")
        command = [self.command, "--config", config, "--policies", ",".join(policies), "--format", "json", *map(str, flags)]
        return json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout)

    def per_run(self, texts, policies, *flags):
        """One run of each config, run r on the seed r: [run][policy] -> metrics."""
        def one(numbered):
            run, text = numbered
            results = self.study(text, policies, "--runs", 1, "--seed", run, *flags, name=f"run{run}")
            return [{name: value["mean"] for name, value in policy["metrics"].items()} for policy in results["policies"]]
        with ThreadPoolExecutor(2) as pool:
            return list(pool.map(one, enumerate(texts, start=1)))


def estimate(values):
    return statistics.fmean(values), statistics.stdev(values) / math.sqrt(len(values))


def shown(mean_and_error, unit=1.0):
    mean, error = (value / unit for value in mean_and_error)
    return f"{mean:.4g} ± {error:.1g}"


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"
