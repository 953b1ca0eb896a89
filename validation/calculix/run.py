#!/usr/bin/env python3
"""Frequencies inside Mottle against CalculiX's own, and what a cloud costs either way. See RESULTS.md.

    python3 validation/calculix/run.py build/release/mottle [seed]

Standard library only; needs ccx on the PATH.
"""
import csv
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLE = HERE.parents[1] / "examples" / "03-plate-calculix"
ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
MODES = 10
POINTS = 50
NOMINAL = {"thickness": 0.006, "sheet_E": 70e9, "lap_E": 25e9, "mount_z": 8e5, "mount_xy": 1.0}


def numbers_of(point):
    """What the deck's cards say at a point, by our own text substitution and not by Mottle's."""
    return [("*SHELL SECTION, ELSET=SHEETS, MATERIAL=ALUMINIUM\n0.006", point["thickness"]),
            ("*SHELL SECTION, ELSET=JOINT, MATERIAL=LAP\n0.006", point["thickness"]),
            ("*MATERIAL, NAME=ALUMINIUM\n*ELASTIC\n70e9", point["sheet_E"]),
            ("*MATERIAL, NAME=LAP\n*ELASTIC\n25e9", point["lap_E"]),
            ("*SPRING, ELSET=MOUNTS3\n3\n800000.0", point["mount_z"]),
            ("*SPRING, ELSET=MOUNTS1\n1\n2000000.0", 2e6 * point["mount_xy"]),
            ("*SPRING, ELSET=MOUNTS2\n2\n1500000.0", 1.5e6 * point["mount_xy"])]


def calculix(point, folder):
    """The lowest frequencies, from eigenvalues of 7 digits."""
    deck = (EXAMPLE / "plate.inp").read_text()
    for place, value in numbers_of(point):
        assert deck.count(place) == 1, place
        head = place[:max(place.rfind("\n"), place.rfind(" ")) + 1]
        deck = deck.replace(place, f"{head}{value:.13e}")
    (folder / "plate.inp").write_text(deck)
    subprocess.run(["ccx", "plate"], cwd=folder, env=ONE_THREAD, check=True, stdout=subprocess.DEVNULL)
    rows = re.findall(r"^ +\d+ +(\d\.\d+E[+-]\d+) +\S+ +\S+ +\S+$", (folder / "plate.dat").read_text(), re.M)
    return [float(value) ** 0.5 / (2 * 3.141592653589793) for value in rows[:MODES]]


def with_thickness(folder):
    """The example's study with one parameter more."""
    text = (EXAMPLE / "study.toml").read_text()
    for name in ("plate.inp", "specimens.csv"):
        text = text.replace(f'"{name}"', f'"{EXAMPLE / name}"')
    text += """
[[parameter]]
name = "thickness"
target = ["*SHELL SECTION:SHEETS:T", "*SHELL SECTION:JOINT:T"]
distribution = { kind = "normal", mean = 0.006, std = 0.0001 }
"""
    (folder / "thickness.toml").write_text(text)
    return folder / "thickness.toml"


def mottle(program, *arguments):
    begin = time.perf_counter()
    done = subprocess.run([program, *map(str, arguments), "--quiet", "--threads", "1"], check=True, text=True,
                          stdout=subprocess.PIPE)
    return time.perf_counter() - begin, done.stdout


def main():
    program, seed = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 2026
    stream = random.Random(seed)
    points = [{name: value * stream.uniform(0.8, 1.25) for name, value in NOMINAL.items()} for _ in range(POINTS)]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        with open(folder / "points.csv", "w", newline="") as file:
            csv.writer(file).writerows([list(NOMINAL), *([repr(p[k]) for k in NOMINAL] for p in points)])
        study = EXAMPLE / "study.toml"
        common = ["--out", folder / "out", "--cache", folder / "cache", "--set", 'outputs.tracking="order"']
        mottle(program, "propagate", with_thickness(folder), "--points", folder / "points.csv", *common,
                          "--set", 'model.reduction="off"')
        with open(folder / "out" / "cloud.csv", newline="") as file:
            ours = [[float(row[f"f{m}"]) for m in range(1, MODES + 1)] for row in csv.DictReader(file)]
        decks = len(list((folder / "cache").glob("*.matrices")))
        begin = time.perf_counter()
        theirs = [calculix(point, folder) for point in points]
        one_run = (time.perf_counter() - begin) / POINTS
        worst = max(abs(a - b) / b for left, right in zip(ours, theirs) for a, b in zip(left, right))
        cold = [folder / f"cache-{k}" for k in range(3)]
        cloud = sorted(mottle(program, "propagate", study, "--out", folder / "out", "--cache", place,
                              "--set", "update.samples=1000")[0] for place in cold)[1]
        runs = len(list(cold[0].glob("*.matrices")))
        again, _ = mottle(program, "propagate", study, "--out", folder / "out", "--cache", cold[0],
                          "--set", "update.samples=1000")
    print(json.dumps({"seed": seed, "points": POINTS, "modes": MODES, "worst_relative_difference": worst,
                      "decks_with_thickness": decks, "decks_of_the_cloud": runs, "ccx_run_s": round(one_run, 3), "cloud_of_1000_s": round(cloud, 2),
                      "cloud_again_s": round(again, 2), "by_runs_s": round(1000 * one_run, 1),
                      "ratio": round(1000 * one_run / cloud, 1)}, indent=1))
    if not worst < 1e-6:
        sys.exit("frequencies differ by more than 1e-6")


if __name__ == "__main__":
    main()
