"""What `index` gains in the engine, and where it does not: a page of Markdown.

    policies.py STUDY SCENARIOS [--runs-divided-by N] > policies.md      (./dev policies)

Every figure comes from dwell-study on a scenario of SCENARIOS, some changed here as the page says. All policies fly the
same runs; differences are paired by run, their intervals those of dwell-study (Student's t).
"""

import argparse
import math
import pathlib
import re
import sys
import tempfile
from dataclasses import dataclass

from laboratory import Laboratory, shown, table

POLICIES = ["index", "sa_imm", "round_robin", "largest_variance", "lookahead"]
FIGURES = {"weighted_mse_m2": "true error", "weighted_variance_m2": "filter cost", "tracks_lost": "tracks lost"}

# A false alarm in a million cells of 7.5 m (a pulse of 50 ns) by one beam of 1 degree: per metre and radian.
EVANS_CLUTTER = 1e-6 / (7.5 * math.radians(1))
# Where target two, seen again after 6 s, can be: 20 km from radar one and 3 km off its path, on two axes.
EVANS_FOOTPRINT = "dwell_azimuth_deg: 30 dwell_range_m: 20e3"
FLIGHTS_CLUTTER = 2e-4  # as in unequal_flights: .42 false plots in the footprint of a beam of 1 degree
# Of target two, the one that manoeuvres; the others' begin when it flies straight again, or does not yet.
LEG = "leg {{ start_s: {start} duration_s: 3 ax_mps2: {x} ay_mps2: {y} process_noise_scale: 10 }}"
OTHER_LEGS = {"one": LEG.format(start=35, x=133.33333333333333, y=166.66666666666667),
              "three": LEG.format(start=45, x=-166.66666666666667, y=133.33333333333333)}


@dataclass
class Row:
    title: str
    text: str
    runs: int
    scans: int
    from_s: int


def with_clutter(text, density):
    return re.sub(r'(radar +\{ name: "\w+")', rf"\1 clutter_density: {density:.3g}", text)


def evans(laboratory, snr_db, manoeuvring, footprint):
    text = laboratory.text("evans_three").replace("snr_reference_db: 50", f"snr_reference_db: {snr_db}")
    text = text.replace("dwell_azimuth_deg: 180 dwell_range_m: 1e6", f"{footprint} detection_probability: 0.9")
    if manoeuvring == "three":
        for name, leg in OTHER_LEGS.items():
            text = text.replace(f'target {{ name: "{name}"', f'target {{ name: "{name}" {leg}')
    title = (f"`evans_three`, {snr_db} dB at 100 km, {manoeuvring} manoeuvring"
             + ("" if footprint else ", footprints of 3 beamwidths and 10 km either way"))
    return Row(title, with_clutter(text, EVANS_CLUTTER), runs=400, scans=60, from_s=20)


def rows_of(laboratory):
    rows = [evans(laboratory, snr_db, manoeuvring, EVANS_FOOTPRINT) for snr_db in (50, 30) for manoeuvring in ("one", "three")]
    rows.append(evans(laboratory, 50, "one", ""))
    flights = with_clutter(laboratory.text("recorded_flights"), FLIGHTS_CLUTTER) + "\ntracker { association: IPDA }\n"
    rows.append(Row("`recorded_flights`", flights, runs=20, scans=600, from_s=100))
    rows.append(Row("`unequal_flights`: 8 targets", laboratory.text("unequal_flights"), runs=20, scans=600, from_s=100))
    rows.append(Row("`thirty_flights`: 30 targets", laboratory.text("thirty_flights"), runs=10, scans=300, from_s=100))
    return rows


def difference(results, other, metric):
    """Mean and interval of other - index."""
    pair = next(pair for pair in results["paired"]
                if (pair["a"], pair["b"], pair["metric"]) == ("index", other, metric))
    low, high = pair["ci95"]
    return tuple(0.0 - value for value in (pair["mean_difference"], high, low))


def verdict(interval):
    _, low, high = interval
    return "wins" if low > 0 else "loses" if high < 0 else "no clear difference"


def section(laboratory, row):
    """The table, and [(figure, other policy, verdict)]."""
    runs = laboratory.runs(row.runs)
    results = laboratory.study(row.text, POLICIES, "--runs", runs, "--seed", 1, "--scans", row.scans, "--from-s", row.from_s,
                               "--threads", 2)
    index = results["policies"][0]["metrics"]
    lines, verdicts = [], []
    for policy in results["policies"]:
        name = policy["name"]
        metric = {key: (value["mean"], value["stderr"]) for key, value in policy["metrics"].items()}
        cells = {}
        for figure in FIGURES:
            cells[figure] = ""
            if name == "index":
                continue
            interval = difference(results, name, figure)
            verdicts.append((figure, name, verdict(interval)))
            if figure == "tracks_lost":
                cells[figure] = "{:+.2f} [{:+.2f}, {:+.2f}]".format(*interval)
            else:
                cells[figure] = "{:+.3g} % [{:+.3g}, {:+.3g}]".format(*(100 * v / index[figure]["mean"] for v in interval))
        lines.append([f"`{name}`", shown(metric["position_rms_m"]), shown(metric["weighted_mse_m2"]), cells["weighted_mse_m2"],
                      shown(metric["weighted_variance_m2"]), cells["weighted_variance_m2"], shown(metric["tracks_lost"]),
                      cells["tracks_lost"], f"{100 * metric['answered'][0]:.1f} %"])
    heads = ["policy", "position RMS, m", "true error, m^2", "minus `index`", "filter cost, m^2", "minus `index`",
             "tracks lost", "minus `index`", "answered itself"]
    text = f"## {row.title}\n\n{runs} runs of {row.scans} scans; figures from {row.from_s} s on.\n\n{table(heads, lines)}"
    return text, verdicts


def not_won(row, verdicts):
    lines = []
    for figure, what in FIGURES.items():
        phrases = []
        for kind, phrase in (("loses", "worse than "), ("no clear difference", "not clearly apart from ")):
            others = [f"`{name}`" for of, name, result in verdicts if (of, result) == (figure, kind)]
            if others and (figure, kind) != ("tracks_lost", "no clear difference"):
                phrases.append(phrase + ", ".join(others))
        if phrases:
            lines.append(f"- {row.title}, {what}: {'; '.join(phrases)}.")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path)
    parser.add_argument("scenarios", type=pathlib.Path)
    parser.add_argument("--runs-divided-by", type=int, default=1)
    parser.add_argument("--only", default="", help="rows whose title has this text")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        laboratory = Laboratory(arguments.study, arguments.scenarios, arguments.runs_divided_by, pathlib.Path(directory))
        print("# Policies in the engine\n")
        print("Made by `./dev policies`. The scenarios are as they are shipped but for this: `evans_three` has P_d .9 and "
              f"{EVANS_CLUTTER:.2g} false plots per metre and radian, a false alarm in a million cells; where three manoeuvre, target "
              "one does at 35 s and target three at 45 s what target two does at 25 s, each to another side; its footprints are 30 "
              f"degrees and 20 km either way. `recorded_flights` has {FLIGHTS_CLUTTER:g} false plots per metre and radian, as the other "
              "flights, and IPDA. All flights have P_d .8 or .9, and weights of 1 to 30 but in `recorded_flights`. All policies fly "
              "the same runs, seeds from 1.\n")
        print("\"True error\": weight x squared position error, summed over tracks, mean over scans; \"filter "
              "cost\": the same of the filter's own variances, which the policies minimise. Each with its standard error; "
              "differences are paired by run, with their 95 % interval: above zero `index` wins. Tracks that are lost leave both "
              "figures, so read them beside the tracks lost. \"Answered itself\": share of the decisions that were not left to a "
              "cheaper policy; value sets come in four scans after they are asked for, never late.\n")
        lines = []
        for row in rows_of(laboratory):
            if arguments.only in row.title:
                text, verdicts = section(laboratory, row)
                print(text, flush=True)
                lines += not_won(row, verdicts)
        print("## Where `index` does not win\n")
        print("\n".join(lines or ["Nowhere."]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
