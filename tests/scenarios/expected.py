"""Scenarios against their expected summaries: NAME.textproto beside NAME.expected, for every scenario of this folder.

    expected.py STUDY            compares; a difference is shown line by line, and fails
    expected.py STUDY --accept   writes the expected summaries anew (./dev accept)

Figures have six digits: a change of the arithmetic shows, and the last bits of the C library's functions, which differ
between processors, do not.
"""

import difflib
import json
import pathlib
import subprocess
import sys

FOLDER = pathlib.Path(__file__).parent
RUNS = 4
POLICIES = "sa_imm,round_robin,largest_variance,fixed:sensor=2,bhattacharyya"


def summary(study, scenario):
    command = [study, "--config", scenario, "--policies", POLICIES, "--runs", str(RUNS), "--format", "json"]
    results = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    lines = [f"{scenario.name}: {results['runs']} runs of {results['scans']} scans, seeds from {results['seed']}"]
    for policy in results["policies"]:
        lines += ["", policy["name"]]
        for metric, value in policy["metrics"].items():
            lines.append(f"  {metric:40} {value['mean']:.6g} ({value['stderr']:.6g})")
        for kind, looks in policy["looks"].items():
            for name, value in looks.items():
                lines.append(f"  looks {kind} {name:31} {value['mean']:.6g}")
    return "".join(line + "\n" for line in lines)


def main(study, accept):
    scenarios = sorted(FOLDER.glob("*.textproto"))
    changed = 0
    for scenario in scenarios:
        file = scenario.with_suffix(".expected")
        before = file.read_text(encoding="utf-8") if file.exists() else ""
        now = summary(study, scenario)
        if now == before:
            continue
        changed += 1
        sys.stdout.writelines(difflib.unified_diff(before.splitlines(True), now.splitlines(True), file.name, "now"))
        if accept:
            file.write_text(now, encoding="utf-8")
    if accept:
        print(f"{changed} of {len(scenarios)} expected summaries written anew")
        return 0
    if changed:
        print(f"\n{changed} of {len(scenarios)} scenarios changed; where that was meant: ./dev accept, and commit the difference")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:] == ["--accept"]))
