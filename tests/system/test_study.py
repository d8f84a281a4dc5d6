"""dwell-study on scenarios: what it writes, that threads do not change it, what it refuses."""

import csv
import io
import json
import os
import select
import signal
import subprocess
import time
import unittest

from daemon import BUSY, PATIENCE_S, SystemTest, scaled, scenario

STUDY = os.environ["DWELL_STUDY"]
POLICIES = "sa_imm,round_robin:order=locked,largest_variance"


class Study(SystemTest):
    def config(self, text=BUSY):
        path = self.path("scenario.textproto")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def study(self, *arguments, config=None):
        """Exit code, standard output, standard error."""
        command = [STUDY, "--config", config or self.config(), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        return done.returncode, done.stdout, done.stderr

    def test_threads_do_not_change_a_byte(self):
        for threads in (1, 2, 3):
            code, _, log = self.study("--policies", POLICIES, "--runs", scaled(20), "--threads", threads, "--out",
                                      self.path(f"threads{threads}"))
            self.assertEqual(code, 0, log)
        names = sorted(os.listdir(self.path("threads1")))
        for name in ("config.textproto", "error_over_time.svg", "results.csv", "results.json", "schedule.svg"):
            self.assertIn(name, names)
        for name in names:
            if name == "times.json":  # wall clock
                continue
            with open(self.path(f"threads1/{name}"), "rb") as one:
                expected = one.read()
            for threads in (2, 3):
                with open(self.path(f"threads{threads}/{name}"), "rb") as other:
                    self.assertEqual(other.read(), expected, name)

    def test_written_config_gives_the_same_results(self):
        first, second = self.path("first"), self.path("second")
        arguments = ["--policies", "round_robin", "--runs", 3, "--out"]
        self.assertEqual(self.study(*arguments, first)[0], 0)
        self.assertEqual(self.study(*arguments, second, config=os.path.join(first, "config.textproto"))[0], 0)
        with open(os.path.join(first, "results.csv"), "rb") as one, open(os.path.join(second, "results.csv"), "rb") as two:
            self.assertEqual(one.read(), two.read())

    def test_json_agrees_with_csv(self):
        runs = 8
        results = json.loads(self.study("--policies", POLICIES, "--runs", runs, "--format", "json")[1])
        rows = list(csv.DictReader(io.StringIO(self.study("--policies", POLICIES, "--runs", runs, "--format", "csv")[1])))
        self.assertEqual(results["runs"], runs)
        self.assertEqual([policy["name"] for policy in results["policies"]], POLICIES.split(","))
        by_policy = {}
        for policy in results["policies"]:
            of_policy = [row for row in rows if row["policy"] == policy["name"]]
            self.assertEqual(len(of_policy), runs)
            by_policy[policy["name"]] = of_policy
            for metric, value in policy["metrics"].items():
                values = [float(row[metric]) for row in of_policy]
                mean = sum(values) / runs
                variance = sum((v - mean) ** 2 for v in values) / (runs - 1)
                self.assertAlmostEqual(value["mean"], mean, delta=1e-9 * max(1.0, abs(mean)), msg=metric)
                self.assertAlmostEqual(value["stderr"] ** 2 * runs, variance, delta=1e-9 * max(1.0, variance), msg=metric)
            looks = sum(value["mean"] for value in policy["looks"]["by_radar"].values())
            self.assertAlmostEqual(looks, sum(value["mean"] for value in policy["looks"]["by_track"].values()))
        for pair in results["paired"]:
            differences = [float(a[pair["metric"]]) - float(b[pair["metric"]])
                           for a, b in zip(by_policy[pair["a"]], by_policy[pair["b"]])]
            low, high = pair["ci95"]
            mean = sum(differences) / runs
            self.assertAlmostEqual(pair["mean_difference"], mean, delta=1e-9 * max(1.0, abs(mean)))
            self.assertLessEqual(low, pair["mean_difference"])
            self.assertLessEqual(pair["mean_difference"], high)
            self.assertEqual(pair["a_better_share"], sum(d < 0 for d in differences) / runs)

    def test_policies_meet_the_same_truth(self):
        """Common random numbers: a policy's figures do not depend on which others it is compared with."""
        alone = json.loads(self.study("--policies", "round_robin", "--runs", 3, "--format", "json")[1])
        beside = json.loads(self.study("--policies", "sa_imm,round_robin", "--runs", 3, "--format", "json")[1])
        self.assertEqual(alone["policies"][0]["metrics"], beside["policies"][1]["metrics"])

    def test_window_takes_its_scans_alone(self):
        def variance(*window):
            results = json.loads(self.study("--runs", 1, "--format", "json", *window)[1])
            return results["policies"][0]["metrics"]["position_variance_m2"]["mean"]
        both = variance("--to-s", 60)
        halves = variance("--to-s", 30), variance("--from-s", 31)
        self.assertAlmostEqual(both, sum(halves) / 2, delta=1e-9 * both)
        self.assertNotAlmostEqual(halves[0], halves[1], delta=1e-3 * both)

    def test_interrupt_writes_what_is_finished(self):
        command = [STUDY, "--config", self.config(), "--runs", "1000000", "--format", "json", "--out", self.path("cut")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            deadline = time.monotonic() + PATIENCE_S
            status = f"/proc/{process.pid}/stat"
            while int(open(status, encoding="utf-8").read().split()[13]) < 30:  # ticks of work: some runs are done
                self.assertLess(time.monotonic(), deadline)
                select.select([], [], [], 0.02)
            process.send_signal(signal.SIGINT)
            output, log = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 0, log)
        runs = json.loads(output)["runs"]
        self.assertGreater(runs, 0)
        self.assertIn(f"ended early: {runs} of 1000000 runs", log)
        with open(self.path("cut/results.csv"), encoding="utf-8") as file:
            self.assertEqual(len(file.readlines()), runs + 1)

    def test_bad_input_is_all_reported(self):
        code, _, log = self.study("--policies", "sa_im,sa_imm:nodes=1:beta=-1,fixed:sensor=9,round_robin:order=up")
        self.assertEqual(code, 78)
        for complaint in ("sa_im", "sa_imm.nodes", "sa_imm.beta", "fixed.sensor", "round_robin.order"):
            self.assertIn(complaint, log)
        code, _, log = self.study(config=self.config(BUSY + "seed: -1"))
        self.assertEqual(code, 78, log)
        code, _, log = self.study(config=self.path("missing.textproto"))
        self.assertEqual(code, 78, log)
        for arguments in (["--runs", 0], ["--threads", 0], ["--format", "xml"], ["--no-such-flag"], ["--seed", -1],
                          ["--seed", 2 ** 64], ["--scans", "1.5"], ["--policies", ""]):
            self.assertEqual(self.study(*arguments)[0], 2, arguments)
        for window in (["--from-s", 40, "--to-s", 30], ["--from-s", 61], ["--from-s", "nan"], ["--to-s", 0.5]):
            code, _, log = self.study("--scans", 60, *window)
            self.assertEqual(code, 78, window)
            self.assertIn("must hold a scan", log)

    def test_calibration_from_a_recording_is_that_of_its_scenario(self):
        """The run that dwelld has recorded is the one that the study flies."""
        journal, scans = self.path("journal"), 300
        config = scenario("calibration_traffic")
        with self.daemon(config, "--fast", "--scans", scans, "--record", journal) as daemon:
            self.assertEqual(daemon.wait(), 0, daemon.log)

        def recorded(*arguments):
            done = subprocess.run([STUDY, "--replay", journal, "--format", "json", *map(str, arguments)],
                                  capture_output=True, text=True, timeout=PATIENCE_S, check=False)
            return done.returncode, done.stdout, done.stderr

        results = {}
        for known in ([], ["--known-flights"]):
            arguments = ["--calibrate", "joint", *known]
            code, output, log = recorded(*arguments)
            self.assertEqual(code, 0, log)
            flown = self.study(*arguments, "--runs", 1, "--scans", scans, "--format", "json",
                               config=self.config(config))[1]
            self.assertEqual(json.loads(output), json.loads(flown))
            results[len(known)] = {(row["radar"], row["parameter"]): row for row in json.loads(output)["parameters"]}
        # Of unknown flights no time bias is seen, of known ones each bias is better known than before.
        for (radar, parameter), row in results[0].items():
            if parameter == "time_bias_s":
                self.assertEqual(row["observable"], 0.0)
            if "bias" in parameter:
                self.assertLess(results[1][radar, parameter]["standard_error"], row["standard_error"])
        code, output, log = recorded("--calibrate", "innovations", "--scans", 100)
        self.assertEqual(code, 0, log)
        self.assertEqual(json.loads(output)["scans"], 100)
        for arguments in ([], ["--calibrate", "joint", "--config", self.config()], ["--known-flights"]):
            self.assertEqual(recorded(*arguments)[0], 2, arguments)
        code, _, log = self.study("--known-flights")
        self.assertEqual(code, 2, log)

    def test_a_recording_that_applied_what_it_learned_is_repeated_as_it_was(self):
        journal = self.path("journal")
        config = BUSY + "calibration { mode: APPLY }\n"
        with self.daemon(config, "--fast", "--scans", 150, "--record", journal) as daemon:
            self.assertEqual(daemon.wait(), 0, daemon.log)
        command = [STUDY, "--replay", journal, "--calibrate", "joint"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("1 with a result", done.stdout)
        done = subprocess.run([*command, "--known-flights"], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        self.assertEqual(done.returncode, 78)
        self.assertIn("calibration.mode", done.stderr)

    def test_out_that_cannot_be_written_is_said(self):
        code, _, log = self.study("--runs", 1, "--out", "/proc/dwell")
        self.assertEqual(code, 1)
        self.assertIn("/proc/dwell", log)
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([STUDY, "--config", self.config(), "--runs", "1"], stdout=full, stderr=subprocess.PIPE,
                                  text=True, timeout=PATIENCE_S, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("cannot write to standard output", done.stderr)


if __name__ == "__main__":
    unittest.main()
