"""The papers' figures, printed and ours, as a page of Markdown.

    papers.py STUDY SCENARIOS [--runs-divided-by N] > papers.md      (./dev papers)

Every figure of ours comes from dwell-study on a scenario of SCENARIOS, some changed here in the text that is shown
beside them. A figure is "mean ± standard error".
"""

import argparse
import math
import pathlib
import random
import statistics
import sys
import tempfile

from laboratory import Laboratory, estimate, shown, table

RADARS = {"one": (120e3, 120e3), "two": (100e3, 50e3), "three": (150e3, 100e3)}


def agrees(mean_and_error, figure, part=0.01):
    """Within 1 % or four combined standard errors."""
    mean, error = mean_and_error
    reference, reference_error = figure
    return abs(mean - reference) <= max(part * abs(reference), 4 * math.hypot(error, reference_error))


# Evans, Krishnamurthy, Nair, Sciacca (2005)

EVANS_WINDOW = ("--from-s", 45, "--to-s", 60)
EVANS_POLICIES = ["fixed:sensor=1", "fixed:sensor=2", "fixed:sensor=3", "round_robin", "sa_imm:cost=x"]
# 1e-4 m^2 with standard errors: an independent reproduction under the assumptions of daemon/scenarios/README.md, a = 0.
EVANS_REFERENCE = [(4.13, .002), (90.8, .04), (11.4, .02), (29.9, .04), (.592, .001)]
EVANS_PRINTED = {0: ("108", "48", "0.527"), 1.5: ("123", "49", "0.532"), 15: ("568", "113", "15"),
                 150: ("124700", "10200", "4500")}


def displaced(text, spread_m, which, chance):
    for name, (x, y) in RADARS.items():
        if name not in which:
            continue
        old = next(line for line in text.splitlines() if f'radar {{ name: "{name}"' in line)
        head = old[:old.index("x_m:")]
        tail = old[old.index("beamwidth_deg"):]
        new = (f"{head}x_m: {x + chance.uniform(-spread_m, spread_m)} y_m: {y + chance.uniform(-spread_m, spread_m)} {tail}")
        text = text.replace(old, new)
    return text


def evans_single(laboratory, bank, which, spread_km):
    text = laboratory.text("evans_single").replace("as_printed", bank)
    chance = random.Random(f"{bank} {which} {spread_km}")
    texts = [displaced(text, 1e3 * spread_km, which, chance) for _ in range(laboratory.runs(200))]
    return laboratory.per_run(texts, EVANS_POLICIES, *EVANS_WINDOW)


def evans_scenario_1(laboratory):
    parts = ["### Scenario 1, Table I: mean filter variance of x, t = 45 .. 60 s, 200 runs, 1e-4 m^2\n",
             "Sensor 3 at (150, 100) km + U[-a, a]^2 (31), drawn anew in each run; the last columns are of all three sensors "
             "drawn so. \"Loses\": share of the runs in which the variance of SA-IMM (x cost) is above that of the best of "
             "the other four, and in which its true x error is.\n"]
    for bank in ("as_printed", "evans_practical"):
        rows = []
        for which, moved in ((("three",), "3"), (("one", "two", "three"), "all")):
            for spread_km in (0, 1.5, 15, 150):
                if spread_km == 0 and len(which) > 1:
                    continue
                runs = evans_single(laboratory, bank, which, spread_km)
                variance = [[run[p]["x_variance_m2"] / 1e-4 for run in runs] for p in range(5)]
                error = [[run[p]["x_rms_m"] for run in runs] for p in range(5)]
                ours = [estimate(values) for values in variance]
                loses = [sum(of_run[4] > min(of_run[:4]) for of_run in zip(*figures)) / len(runs)
                         for figures in (variance, error)]
                row = [f"{spread_km:g}", moved, *(shown(value) for value in ours),
                       f"{ours[3][0] / ours[4][0]:.0f}", f"{ours[1][0] / ours[4][0]:.0f}",
                       f"{100 * loses[0]:.0f} %, {100 * loses[1]:.0f} %"]
                if bank == "as_printed" and len(which) == 1:
                    printed = EVANS_PRINTED[spread_km]
                    row.append(" / ".join(printed))
                    if spread_km == 0:
                        good = all(agrees(value, figure) for value, figure in zip(ours, EVANS_REFERENCE))
                        row.append("ratios as reproduced elsewhere" if good else "NOT as reproduced elsewhere")
                    elif spread_km == 1.5:
                        row.append("as at a = 0, as printed")
                    else:
                        row.append("refuted: sensor 1 stays, and alone is far below the printed \"single\"")
                else:
                    row += ["", ""]
                rows.append(row)
        parts.append(f"Bank `{bank}`:\n")
        parts.append(table(["a, km", "moves", "sensor 1", "sensor 2", "sensor 3", "round robin", "SA-IMM", "RR / SA", "sensor 2 / SA",
                            "SA-IMM loses", "printed: single / RR / SA", "verdict"], rows))
    parts.append("The printed \"single\" is sensor 2, which is not the best single sensor: sensor 1 is, by twenty times. The printed absolute "
                 "figures hang on an SNR that the paper does not give (50 dB at 100 km here). \"Guaranteed to always perform better\" is "
                 "refuted where the shares above are not zero, and by the true error.\n")
    return "\n".join(parts)


SCENARIO_2_POLICIES = ["round_robin:order=radar_fastest", "round_robin:order=track_fastest", "round_robin:order=locked",
                       "sa_imm:cost=x", "sa_imm:cost=position", "largest_variance"]
SCENARIO_2_REFERENCE = [10.1, 1.90, 1.80, 1.41, 1.53, 1.45]  # m^2, bank as printed, an independent reproduction


def evans_scenario_2(laboratory):
    parts = ["### Scenario 2: three targets, t = 20 .. 60 s, 200 runs\n",
             "The paper shows a plot and does not say in which order its round robin goes, which matters more than the policy: "
             "`radar_fastest` changes sensor every second and track every third, `track_fastest` the other way round, `locked` "
             "looks with sensor i at track i.\n"]
    runs = laboratory.runs(200)
    for scenario in ("evans_three_as_printed", "evans_three"):
        results = laboratory.study(laboratory.text(scenario), SCENARIO_2_POLICIES, "--runs", runs, "--from-s", 20, "--to-s", 60,
                                   "--threads", 2)
        rows = []
        for policy, reference in zip(results["policies"], SCENARIO_2_REFERENCE):
            metric = {name: (value["mean"], value["stderr"]) for name, value in policy["metrics"].items()}
            rows.append([f"`{policy['name']}`", shown(metric["x_variance_m2"]),
                         f"{reference}" if scenario.endswith("printed") else "", shown(metric["position_rms_m"]),
                         shown(metric["nees"]), shown(metric["tracks_lost"])])
        parts.append(f"`{scenario}`:\n")
        parts.append(table(["policy", "filter variance of x, m^2", "reproduced elsewhere", "true position RMS, m",
                            "NEES (4 if consistent)", "tracks lost"], rows))
        parts.append("Share of runs in which `sa_imm:cost=position` has the larger true mean square error: " + ", ".join(
            f"{100 * pair['a_better_share']:.1f} % against `{pair['a']}`" for pair in results["paired"]
            if pair["metric"] == "position_mse_m2" and pair["b"] == "sa_imm:cost=position") + ".\n")
    return "\n".join(parts)


# Liu, Hwang (2011)

LIU_HWANG_PRINTED = {"bhattacharyya": ("3.5233", "4.3354", "17"), "fixed:sensor=1": ("4.4327", "7.5244", "35"),
                     "fixed:sensor=2": ("4.2359", "5.8382", "33")}
LIU_HWANG_REFERENCE = {"bhattacharyya": (3.80, 4.66, 18.3), "fixed:sensor=1": (5.56, 7.40, 34.9),
                       "fixed:sensor=2": (5.23, 6.59, 29.8)}


def liu_hwang(laboratory):
    policies = ["bhattacharyya", "fixed:sensor=1", "fixed:sensor=2", "round_robin", "sa_imm"]
    batches = {name: [] for name in policies}
    for batch in range(20):
        runs = laboratory.runs(100)
        results = laboratory.study(laboratory.text("liu_hwang"), policies, "--runs", runs, "--seed", 1 + batch * runs,
                                   "--threads", 2)
        for policy in results["policies"]:
            series = [point["position_rms_m"] for point in policy["series"]]
            batches[policy["name"]].append((statistics.fmean(series), max(series), policy["metrics"]["mode_errors"]["mean"]))
    rows = []
    for name in policies:
        average, peak, modes = (estimate(values) for values in zip(*batches[name]))
        axis = [tuple(value / math.sqrt(2) for value in figure) for figure in (average, peak)]
        row = [f"`{name}`", shown(axis[0]), shown(axis[1]), shown(average), shown(peak), shown(modes)]
        row.append(" / ".join(LIU_HWANG_PRINTED.get(name, ())))
        reference = LIU_HWANG_REFERENCE.get(name)
        if reference:
            good = all(agrees(figure, (value, 0), 0.02) for figure, value in zip((*axis, modes), reference))
            row.append(" / ".join(map(str, reference)) + (": agrees within 2 %" if good else ": DIFFERS"))
        else:
            row.append("")
        rows.append(row)
    robin, scheduled = (estimate([value[0] for value in batches[name]]) for name in ("round_robin", "bhattacharyya"))
    return "\n".join([
        "### Table I: RMS position error and mode errors, 20 batches of 100 runs of 110 scans\n",
        "Base setting: truth from the printed chain without process noise, starting at constant velocity, 18 m/s; start drawn "
        "around the truth with P = I. \"Peak\" is the largest RMS over the runs of a batch at any scan, \"average\" the mean over scans. The "
        "printed errors are nearest to ours per axis.\n",
        table(["policy", "average per axis, m", "peak per axis, m", "average 2-D, m", "peak 2-D, m", "mode errors",
               "printed: average / peak / modes", "reproduced elsewhere"], rows),
        f"Mode errors: reproduced. The order of the three: reproduced. \"Selects the best sensor such that the estimation error is minimized\": "
        f"**refuted**, round robin has {robin[0]:.2f} m where the scheduled sensors have {scheduled[0]:.2f} m (2-D), with more mode errors. "
        "(12) and (13) as printed are no bound: the determinant is of the mean of the covariances.\n"])


# Chung et al. (2004), Gupta et al. (2004), Alriksson, Rantzer

def linear_rows(laboratory, problem, claims):
    """claims: (policy, what, printed, field, reference, tolerance)."""
    policies = list(dict.fromkeys(claim[0] for claim in claims))
    results = laboratory.study(laboratory.text(f"problems/{problem}"), policies)
    by_name = {policy["name"]: policy for policy in results["policies"]}
    rows = []
    for policy, what, printed, field, reference, tolerance in claims:
        ours = by_name[policy][field]
        if isinstance(reference, str):
            ours = "".join(map(str, ours))
            good = ours == reference
        elif isinstance(reference, list):
            good = len(ours) == len(reference) and all(abs(a - b) <= tolerance for a, b in zip(ours, reference))
            ours = ", ".join(f"{value:.5f}" for value in ours)
        else:
            good = abs(ours - reference) <= tolerance * abs(reference)
            ours = f"{ours:.13g}"
        shown_reference = ", ".join(map(str, reference)) if isinstance(reference, list) else str(reference)
        rows.append([f"`{policy}`", what, printed, ours, shown_reference, "agrees" if good else "DIFFERS"])
    return table(["policy", "figure", "printed", "ours", "reproduced elsewhere", "verdict"], rows)


def chung(laboratory):
    return "\n".join([
        "### IV: two sensors, 20 steps\n",
        "The initial covariance is not printed; 0.01 I here. Costs J are in the units of the paper's.\n",
        linear_rows(laboratory, "chung", [
            ("fixed:sensor=1", "J", "", "cost", 0.935735092095736, 1e-9),
            ("fixed:sensor=2", "J", "", "cost", 0.751210466486798, 1e-9),
            ("window:d=1", "J", "", "cost", 0.582617159292125, 1e-9),
            ("window:d=4", "J", "", "cost", 0.578845065317272, 1e-9),
            ("optimum", "J", "", "cost", 0.578845065317272, 1e-9),
            ("optimum", "schedule", "", "schedule", "12122122122122122122", None)]),
        "\">42 %\" better than sensor 1 and \"24 %\" better than sensor 2: here 38.1 % and 22.9 %. **Not reproduced**: no initial covariance "
        "tried gives both with the sensors labelled as printed. \"A longer window is better\": **refuted** by systems of "
        "`tests/bandit/lti`, though true here.\n"])


def gupta(laboratory):
    return "\n".join([
        "### Three sensors, 15 steps\n",
        "In the text sensors 2 and 3 are exchanged; labels here are as printed in the matrices.\n",
        linear_rows(laboratory, "gupta", [
            ("fixed:sensor=1", "J", "", "cost", 101.656893043575, 1e-9),
            ("window:d=1", "J", "", "cost", 70.6712684547109, 1e-9),
            ("window:d=3", "J", "", "cost", 70.5657678216804, 1e-9),
            ("threshold:f=1.001", "J", "", "cost", 70.5657678216804, 1e-9),
            ("threshold:f=1.005", "J", "", "cost", 70.5643540213715, 1e-9),
            ("optimum", "J", "", "cost", 70.5643540213715, 1e-9),
            ("optimum", "schedule", "", "schedule", "131313213212312", None),
            ("random", "q", "", "probabilities", [.45065, .32392, .22543], 1e-4),
            ("random", "bound", "2.51", "bound", 2.5090032515, 1e-8)])])


ALRIKSSON_REFERENCE = {10: (5, 3, 32, 32.8766460016921), 50: (5, 4, 36, 39.3436694032755), 110: (5, 5, 39, 43.8557219109654)}


def alriksson(laboratory):
    rows = []
    for r, (printed, size, looks, trace) in ALRIKSSON_REFERENCE.items():
        text = laboratory.text("problems/alriksson").replace("r: [10]", f"r: [{r}]")
        ours, = laboratory.study(text, ["relaxed_dp:alpha=1.01"])["policies"]
        figures = ours["set_sizes"][-1], ours["schedule"].count(2), ours["final_trace"]
        good = figures[:2] == (size, looks) and abs(figures[2] - trace) <= 1e-9 * trace
        rows.append([str(r), str(printed), f"{figures[0]}, {figures[1]}, {figures[2]:.13g}", f"{size}, {looks}, {trace}",
                     "agrees" if good else "DIFFERS"])
    return "\n".join([
        "### Relaxed dynamic programming, alpha = 1.01, 50 steps, P(0) = I\n",
        "The overbars of the text are lost; the reading is the one that keeps the guarantee, and keeps smaller sets than the paper's. "
        "\"r > 104\" has lost an exponent: r > 10^4. The helicopter's A is printed nowhere: not reproduced.\n",
        table(["r", "printed: size of the set", "ours: size at the end, looks of sensor 2, tr P(50)", "reproduced elsewhere",
               "verdict"], rows)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path)
    parser.add_argument("scenarios", type=pathlib.Path)
    parser.add_argument("--runs-divided-by", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        laboratory = Laboratory(arguments.study, arguments.scenarios, arguments.runs_divided_by, pathlib.Path(directory))
        print("# The papers, claim by claim\n")
        print("Made by `./dev papers`. Assumptions: `daemon/scenarios/README.md`. \"Reproduced elsewhere\": figures of an independent "
              "implementation under the same assumptions.\n")
        for title, sections in (("Evans, Krishnamurthy, Nair, Sciacca (2005)", (evans_scenario_1, evans_scenario_2)),
                                ("Liu, Hwang (2011)", (liu_hwang,)), ("Chung et al. (2004)", (chung,)),
                                ("Gupta et al. (2004)", (gupta,)), ("Alriksson, Rantzer", (alriksson,))):
            print(f"## {title}\n")
            for section in sections:
                print(section(laboratory), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
