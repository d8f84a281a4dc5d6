"""dwell-study on scheduling problems: the papers' figures from the shipped files, formats, bad input, exit codes."""

import csv
import io
import json
import os
import subprocess
import unittest

from daemon import PATIENCE_S, SCENARIOS, SystemTest, run

STUDY = os.environ["DWELL_STUDY"]
PROBLEMS = os.path.join(SCENARIOS, "problems")

SCALAR = """lti {
  horizon: 12
  a: [1.1] w: [1] initial_covariance: [1]
  sensor { c: [1] r: [1] }
  sensor { c: [1] r: [2] }
}
"""


def study(*arguments):
    """Exit code, standard output, standard error."""
    done = subprocess.run([STUDY, *map(str, arguments)], capture_output=True, text=True, timeout=PATIENCE_S,
                          check=False)
    return done.returncode, done.stdout, done.stderr


def digits(schedule):
    return "".join(map(str, schedule))


class StudyProblems(SystemTest):
    def write(self, text):
        path = self.path("problem.textproto")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def policies(self, config, *arguments):
        """The policies of a study by name."""
        code, output, errors = study("--config", config, "--format", "json", *arguments)
        self.assertEqual((code, errors), (0, ""))
        return {policy["name"]: policy for policy in json.loads(output)["policies"]}

    def of(self, name, *arguments):
        return self.policies(os.path.join(PROBLEMS, name + ".textproto"), *arguments)

    def refusals(self, text, *arguments):
        path = self.write(text)
        code, output, errors = study("--config", path, *arguments)
        self.assertEqual((code, output), (78, ""), errors)
        return [line.removeprefix(path + ":") for line in errors.splitlines()]

    def assert_close(self, value, expected):
        self.assertLessEqual(abs(value - expected), 1e-9 * expected)

    def test_chung(self):
        policies = self.of("chung")
        self.assert_close(policies["fixed:sensor=1"]["cost"], 0.935735092095736)
        self.assert_close(policies["fixed:sensor=2"]["cost"], 0.751210466486798)
        self.assert_close(policies["window:d=1"]["cost"], 0.582617159292125)
        for name in ("window:d=4", "optimum"):
            self.assert_close(policies[name]["cost"], 0.578845065317272)
            self.assertEqual(digits(policies[name]["schedule"]), "12122122122122122122")

    def test_gupta(self):
        policies = self.of("gupta")
        self.assert_close(policies["fixed:sensor=1"]["cost"], 101.656893043575)
        self.assert_close(policies["window:d=1"]["cost"], 70.6712684547109)
        for name in ("window:d=3", "threshold:f=1.001"):
            self.assert_close(policies[name]["cost"], 70.5657678216804)
        for name in ("threshold:f=1.005", "optimum"):
            self.assert_close(policies[name]["cost"], 70.5643540213715)
            self.assertEqual(digits(policies[name]["schedule"]), "131313213212312")
        optimised = policies["random:q=optimised"]
        for value, expected in zip(optimised["probabilities"], (0.45065, 0.32392, 0.22543)):
            self.assertLess(abs(value - expected), 1e-5)
        self.assertLess(abs(optimised["bound"] - 2.5090032515), 1e-9)

    def test_alriksson(self):
        with open(os.path.join(PROBLEMS, "alriksson.textproto"), encoding="utf-8") as file:
            text = file.read()
        for r, sets, second, trace in ((10, 3, 32, 32.8766460016921), (50, 4, 36, 39.3436694032755),
                                       (110, 5, 39, 43.8557219109654)):
            path = self.write(text.replace("c: [0, 1] r: [10]", f"c: [0, 1] r: [{r}]"))
            policies = self.policies(path, "--policies", "relaxed_dp:alpha=1.01,optimum")
            relaxed = policies["relaxed_dp:alpha=1.01"]
            self.assert_close(relaxed["final_trace"], trace)
            self.assertEqual((len(relaxed["set_sizes"]), relaxed["set_sizes"][-1]), (50, sets))
            self.assertEqual(relaxed["schedule"].count(2), second)
            self.assertLessEqual(trace, 1.01 ** 2 * policies["optimum"]["final_trace"])

    def test_a_spread_budget_lasts(self):
        policies = self.of("few_good_looks")
        greedy, spread = policies["window:d=1"], policies["window:d=1:spread=true"]
        self.assertEqual(greedy["schedule"], 10 * [1] + 50 * [2])
        self.assertEqual([k for k, sensor in enumerate(spread["schedule"], 1) if sensor == 1], list(range(1, 61, 6)))
        # Two sensors: the objective counts a variance twice.
        self.assertLess(abs(greedy["cost"] / 120 - 5.0462), 5e-5)
        self.assertLess(spread["cost"] / 120, 2.3409)

    def test_every_policy_has_the_members_of_its_row(self):
        members = ["name", "schedule", "cost", "final_trace", "expanded"]
        texts = ("fixed:sensor=1", "window:d=3", "threshold:f=1.01", "relaxed_dp:alpha=1.05", "random",
                 "random:q=uniform", "beam:width=10", "optimum", "round_robin")
        policies = self.policies(self.write(SCALAR), "--policies", ",".join(texts))
        self.assertEqual(tuple(policies), texts)
        for name, policy in policies.items():
            own = {"random": ["probabilities", "bound"], "relaxed_dp": ["set_sizes"]}.get(name.split(":")[0], [])
            self.assertEqual([m for m in policy if m != "seconds"], members + own)
            self.assertEqual(len(policy["schedule"]), 12)
            self.assertGreaterEqual(policy["seconds"], 0)
            self.assertGreaterEqual(policy["cost"], policies["optimum"]["cost"] * (1 - 1e-12))

    def test_no_bound_is_null(self):
        blind = SCALAR.replace("c: [1]", "c: [0]")
        self.assertIsNone(self.policies(self.write(blind), "--policies", "random")["random"]["bound"])

    def test_manoeuvre(self):
        policies = self.of("manoeuvre")
        best = policies["optimum"]["cost"]
        for policy in policies.values():
            self.assertEqual(policy["stderr"], 0, "a tree of this size is exact")
            self.assertGreaterEqual(policy["cost"], best * (1 - 1e-12))
            self.assertAlmostEqual(sum(policy["looks"]), 8)
            self.assertIn(policy["first"], (1, 2))

    def test_all_that_is_wrong_is_listed_at_once(self):
        lines = self.refusals("""lti {
  a: [1, 2, 3]
  w: [1, 2,  0, 1]
  initial_covariance: [1, 0,  0, nan]
  communication_noise: -1
  sensor { c: [1, 0] r: [-1] }
  sensor { c: [1, 0, 0] r: [1] cost: -1 }
}
radar { name: "west" }
""", "--policies", "window:d=0,optimal,fixed:sensor=3,threshold:f=0.9,window:e=1")
        self.assertEqual(lines, [
            "9:1: radar: must not stand beside lti: a config is a scenario or one problem",
            "1:1: lti.horizon: is required",
            "5:3: lti.communication_noise = -1: must be in [0, 1e+18]",
            "2:3: lti.a = 3 values: must have 2 x 2 values, row-major",
            "4:3: lti.initial_covariance = nan: must be in [-1e+18, 1e+18]",
            "7:12: lti.sensor[2].c = 3 values: must have 1 x 2 values, row-major",
            "7:32: lti.sensor[2].cost = -1: must be in [0, 1000000000000]",
            "3:3: lti.w: must be symmetric, but entries differ by 2",
            "6:22: lti.sensor[1].r: must be positive definite",
            " --policies: policy = optimal: must be one of: round_robin, fixed, random, window, threshold, beam, "
            "relaxed_dp, optimum",
            " --policies: window.e = 1: unknown parameter; known: d, spread",
            " --policies: window.d = 0: must be a whole number from 1 to 10000",
            " --policies: fixed.sensor = 3: must be a whole number from 1 to 2",
            " --policies: threshold.f = 0.9: must be in [1, 1000000000]"])

    def test_bad_policies_alone_name_the_flag(self):
        code, output, errors = study("--config", self.write(SCALAR), "--policies", "relaxed_dp:alpha=0.5")
        self.assertEqual((code, output), (78, ""))
        self.assertEqual(errors, "--policies: relaxed_dp.alpha = 0.5: must be in [1, 1000]\n")

    def test_two_problems_are_a_syntax_error(self):
        lines = self.refusals(SCALAR + "hmm_selection {}\n")
        self.assertEqual(len(lines), 1)
        self.assertIn("syntax", lines[0])

    def test_hmm_selection_is_refused_with_all_that_is_wrong(self):
        lines = self.refusals("""hmm_selection {
  horizon: 0
  transition: [0.5, 0.6,   0, 1]
  belief: [1]
  sensor { emission: [1, 0, 0] }
  policy { fixed { sensor: 2 } }
  policy {}
}
""")
        self.assertEqual([line.split(": ")[1].split(" = ")[0] for line in lines], [
            "hmm_selection.horizon", "hmm_selection.belief", "hmm_selection.sensor[1].emission",
            "hmm_selection.transition", "hmm_selection.policy[1].fixed.sensor", "hmm_selection.policy[2]"])

    def test_what_is_too_large_is_said_and_the_others_are_there(self):
        # Of equals a factor of 1e9 keeps all: two to the thirtieth schedules.
        config = self.write("""lti {
  horizon: 30
  a: [1, 0,  0, 1] w: [1, 0,  0, 1] initial_covariance: [1, 0,  0, 1]
  sensor { c: [1, 0] r: [1] }
  sensor { c: [0, 1] r: [1] }
}
""")
        code, output, errors = study("--config", config, "--policies", "window,threshold:f=1e9,beam", "--format", "json")
        self.assertEqual(code, 1)
        self.assertRegex(errors, r"^threshold:f=1e9: more than \d+ schedules in one step of the search: take ")
        self.assertEqual([policy["name"] for policy in json.loads(output)["policies"]], ["window", "beam"])

    def test_out_holds_the_same_whenever_it_is_made(self):
        config = self.write(SCALAR + "seed: 5\n")
        written = []
        for name in ("a", "b"):
            directory = self.path(name)
            code, output, _ = study("--config", config, "--policies", "random,window:d=2", "--out", directory,
                                    "--format", "json")
            self.assertEqual(code, 0)
            files = {}
            for file in ("results.json", "results.csv", "config.textproto"):
                with open(os.path.join(directory, file), encoding="utf-8") as text:
                    files[file] = text.read()
            printed = json.loads(output)
            for policy in printed["policies"]:
                del policy["seconds"]
            self.assertEqual(json.loads(files["results.json"]), printed)
            written.append(files)
        self.assertEqual(written[0], written[1])
        # The effective config is the study again.
        effective = os.path.join(self.path("a"), "config.textproto")
        self.assertEqual(study("--config", effective, "--format", "csv")[1].splitlines()[1].split(",", 1)[1],
                         written[0]["results.csv"].splitlines()[1].split(",", 1)[1])

    def test_csv_has_a_row_for_each_policy(self):
        _, output, _ = study("--config", self.write(SCALAR), "--policies", "window,random", "--format", "csv")
        rows = list(csv.DictReader(io.StringIO(output)))
        self.assertEqual([row["policy"] for row in rows], ["window", "random"])
        self.assertEqual(rows[0]["schedule"], " ".join(12 * ["1"]))
        self.assertEqual(rows[0]["bound"], "")

    def test_the_seed_draws_the_schedule(self):
        def schedule(*arguments):
            return self.policies(self.write(SCALAR), "--policies", "random:q=uniform",
                                 *arguments)["random:q=uniform"]["schedule"]
        self.assertEqual(schedule(), schedule("--seed", 1))
        self.assertNotEqual(schedule(), schedule("--seed", 2))

    def test_the_daemon_runs_no_problem(self):
        path = self.write(SCALAR)
        code, output, errors = run("--config", path)
        self.assertEqual((code, output), (78, ""))
        self.assertEqual(errors, f"{path}:1:1: lti: is a problem for dwell-study, and no scenario\n")

    def test_the_table_shows_every_policy(self):
        code, output, _ = study("--config", self.write(SCALAR), "--policies", "window,optimum")
        self.assertEqual(code, 0)
        self.assertRegex(output, r"(?m)^policy +cost +final_trace +expanded +seconds$")
        self.assertRegex(output, r"(?m)^optimum  1 1 1")


if __name__ == "__main__":
    unittest.main()
