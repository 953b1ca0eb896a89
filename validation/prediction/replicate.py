#!/usr/bin/env python3
"""Replicates predictions of specimens that were not used: do 95 % intervals hold 95 % of new specimens?

Each time ten specimens are drawn and updated to (three frequencies), and the frequencies and a shape component of the same
structure with mass m1 doubled are predicted and held against fifty new specimens of that structure. Rows: without noise; a
known noise of 1 % of each frequency; parameters that are normal on their logarithm (coefficient of variation 0.4) and on
their logit between 0.3 and 3 (deviation 1 there), the update working on that scale; a fifth of the entries missing; an
error of the model of 0.3 % of each frequency, stated as test.model_error, which all specimens share (the changed structure
has one of its own, the structure as it was, in the last row, the same). Writes the table to RESULTS.md beside this file.

    python3 validation/prediction/replicate.py [--mottle build/release/mottle] [--replications 200] [--jobs 2] [--rows NAME ...]
"""
import argparse
import concurrent.futures
import datetime
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FIRST_SEED = 7000
SHAPES = 'shapes = { modes = [1], dofs = ["m2"] }'
NOISE = "{ f1 = 0.0016, f2 = 0.0032, f3 = 0.0045 }"
NORMAL = 'distribution = { kind = "normal", mean = 2.0, std = 0.3 }'
LOWER, UPPER = 0.3, 3.0
ERROR = 0.003
ROWS = {
    "none": "no noise",
    "1 %": "noise of 1 % of each frequency, known",
    "log": "normal on the logarithm",
    "logit": "normal on the logit",
    "missing": "a fifth of the entries missing",
    "error": "model error of 0.3 % of each frequency, given",
    "error, as tested": "the same, frequencies of the structure as it was tested",
}


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def edited(text, old, new, count=1):
    if text.count(old) != count:
        sys.exit(f"study.toml: '{old}' stands {text.count(old)} times")
    return text.replace(old, new)


def outputs_of(k1, k2, k5, m1):
    """f1, f2, f3 in Hz and the mass-normalised first shape at m2 of the three masses, by the closed form of a cubic."""
    d = 1 / math.sqrt(m1)
    a = [[(k1 + 4) * d * d, -1 * d, -3 * d], [-1 * d, k2 + 1 + k5, -k5], [-3 * d, -k5, 1 + k5 + 3]]
    q = sum(a[i][i] for i in range(3)) / 3
    off = a[0][1] ** 2 + a[0][2] ** 2 + a[1][2] ** 2
    p = math.sqrt((sum((a[i][i] - q) ** 2 for i in range(3)) + 2 * off) / 6)
    b = [[(a[i][j] - (q if i == j else 0)) / p for j in range(3)] for i in range(3)]
    det = (b[0][0] * (b[1][1] * b[2][2] - b[1][2] ** 2) - b[0][1] * (b[0][1] * b[2][2] - b[1][2] * b[0][2])
           + b[0][2] * (b[0][1] * b[1][2] - b[1][1] * b[0][2]))
    phi = math.acos(max(-1.0, min(1.0, det / 2))) / 3
    squares = sorted(q + 2 * p * math.cos(phi + 2 * math.pi * k / 3) for k in range(3))
    c = [[a[i][j] - (squares[0] if i == j else 0) for j in range(3)] for i in range(3)]
    vectors = [[c[i][1] * c[j][2] - c[i][2] * c[j][1], c[i][2] * c[j][0] - c[i][0] * c[j][2],
                c[i][0] * c[j][1] - c[i][1] * c[j][0]] for i, j in ((0, 1), (0, 2), (1, 2))]
    shape = max(vectors, key=lambda v: sum(x * x for x in v))
    size = math.sqrt(sum(x * x for x in shape))
    return [math.sqrt(square) / (2 * math.pi) for square in squares] + [abs(shape[1]) / size]


def write_specimens(path, row, count, m1, names, generator):
    """Specimens whose k1, k2, k5 are normal on the row's scale."""
    lines = [",".join(names)]
    for _ in range(count):
        t = [generator.gauss(0, 1) for _ in range(3)]
        if row == "log":
            variance = math.log(1 + 0.4 ** 2)
            x = [math.exp(-0.5 * variance + math.sqrt(variance) * z) for z in t]
        else:
            x = [LOWER + (UPPER - LOWER) / (1 + math.exp(-(-1.0 + z))) for z in t]
        lines.append(",".join(f"{value:.12g}" for value in outputs_of(*x, m1)[:len(names)]))
    path.parent.mkdir()
    path.write_text("\n".join(lines) + "\n")


def leave_gaps(path, generator):
    """A fifth of the cells empty; every specimen keeps one, every output two."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = [line.split(",") for line in lines[1:]]
    while True:
        gaps = [[generator.random() < 0.2 for _ in row] for row in rows]
        if not any(map(all, gaps)) and all(sum(not row[k] for row in gaps) >= 2 for k in range(len(gaps[0]))):
            break
    rows = [["" if gap else cell for cell, gap in zip(row, mask)] for row, mask in zip(rows, gaps)]
    path.write_text("\n".join([lines[0]] + [",".join(row) for row in rows]) + "\n")


def make_wrong(path, errors):
    """The first columns as a model would have them that is wrong by these parts of them."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = [[float(cell) for cell in line.split(",")] for line in lines[1:]]
    for row in rows:
        row[:len(errors)] = [value * (1 + error) for value, error in zip(row, errors)]
    path.write_text("\n".join([lines[0]] + [",".join(f"{value:.15g}" for value in row) for row in rows]) + "\n")


def study_of(row):
    text = (HERE / "study.toml").read_text()
    if row == "1 %":
        text = edited(text, "specimens = 10", f"specimens = 10\nnoise = {NOISE}")
        text = edited(text, 'file = "truth/specimens.csv"', f'file = "truth/specimens.csv"\nrepeatability = {NOISE}')
    if row.startswith("error"):
        text = edited(text, 'file = "truth/specimens.csv"', f'file = "truth/specimens.csv"\nmodel_error = {{ "f*" = "{100 * ERROR} %" }}')
    if row == "log":
        text = edited(text, NORMAL, 'distribution = { kind = "lognormal", mean = 2.0, std = 0.3 }\nscale = "log"', 3)
    if row == "logit":
        text = edited(text, NORMAL, f'{NORMAL}\nbounds = [{LOWER}, {UPPER}]\nscale = "logit"', 3)
    return text


def make_specimens(mottle, row, text, folder, seed):
    if row in ("log", "logit"):
        generator = random.Random(seed)
        write_specimens(folder / "truth" / "specimens.csv", row, 10, 1.0, ["f1", "f2", "f3"], generator)
        write_specimens(folder / "held-out" / "specimens.csv", row, 50, 2.0, ["f1", "f2", "f3", "phi1:m2"], generator)
        return
    held_out = edited(text, "specimens = 10", "specimens = 50")
    if row != "error, as tested":
        held_out = edited(edited(held_out, "m1 = 1.0", "m1 = 2.0"), "frequencies = [1, 2, 3]",
                          f"frequencies = [1, 2, 3]\n{SHAPES}")
    (folder / "held-out.toml").write_text(held_out)
    run(mottle, "simulate", folder / "study.toml", "--seed", seed, "--out", folder / "truth", "--quiet")
    run(mottle, "simulate", folder / "held-out.toml", "--seed", seed + 1000000, "--out", folder / "held-out", "--quiet")
    if row.startswith("error"):
        generator = random.Random(seed)
        errors = [generator.gauss(0, ERROR) for _ in range(3)]
        make_wrong(folder / "truth" / "specimens.csv", errors)
        own = errors if row == "error, as tested" else [generator.gauss(0, ERROR) for _ in range(3)]
        make_wrong(folder / "held-out" / "specimens.csv", own)
    if row == "missing":
        leave_gaps(folder / "truth" / "specimens.csv", random.Random(seed))


def replicate(mottle, row, seed):
    text = study_of(row)
    changed = f'{SHAPES}\nmodel = {{ "mass:m1" = 2.0 }}\n' if row != "error, as tested" else ""
    predict = f'\n[predict]\nfrequencies = [1, 2, 3]\n{changed}held_out = "held-out/specimens.csv"\n'
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "study.toml").write_text(text + predict)
        make_specimens(mottle, row, text, folder, seed)
        run(mottle, "update", folder / "study.toml", "--quiet", "--threads", 1, "--out", folder / "out")
        return json.loads((folder / "out" / "result.json").read_text())["prediction"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--mottle", type=pathlib.Path, default=ROOT / "build" / "release" / "mottle")
    parser.add_argument("--replications", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rows", nargs="*", choices=list(ROWS), default=list(ROWS))
    arguments = parser.parse_args()
    lines = ["| specimens | f1 | f2 | f3 | phi1:m2 | joint region | uniformity rejected at 5 % |", "|---|---|---|---|---|---|---|"]
    checks = {}
    for row in arguments.rows:
        seeds = range(FIRST_SEED, FIRST_SEED + arguments.replications)
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            found = list(pool.map(lambda seed: replicate(arguments.mottle, row, seed), seeds))
        checked = [prediction["held_out"] for prediction in found]
        outputs = len(checked[0]["coverage"])
        columns = [[check["coverage"][k] for check in checked] for k in range(outputs)]
        columns.append([check["joint_coverage"] for check in checked if check["joint_coverage"] is not None])
        means = [sum(column) / max(len(column), 1) for column in columns]
        errors = [math.sqrt(sum((value - mean) ** 2 for value in column) / max(len(column) - 1, 1) / max(len(column), 1))
                  for column, mean in zip(columns, means)]
        rejected = sum(check["adjusted_p_value"] < 0.05 for check in checked) / len(checked)
        cells = [f"{100 * mean:.1f} % ± {100 * error:.1f}" for mean, error in zip(means, errors)]
        if len(columns[-1]) < len(checked):
            cells[-1] += f" (of {len(columns[-1])} that have one)"
        cells[outputs:outputs] = ["-"] * (4 - outputs)
        lines.append(f"| {ROWS[row]} | " + " | ".join(cells) + f" | {100 * rejected:.1f} % |")
        print(lines[-1], flush=True)
        # Where noise hides an output's scatter, the scatter cannot be negative: intervals are then too wide, never too narrow.
        most = 1.0 if row == "1 %" else 0.97
        checks[f"{ROWS[row]}: coverage of every output and of the joint region "
               f"{'at least 93 %' if row == '1 %' else '93 to 97 %'}"] = all(
            0.93 <= mean <= most for mean, column in zip(means, columns) if len(column) >= 0.5 * len(checked))
        checks[f"{ROWS[row]}: uniformity rejected in at most 7 %"] = rejected <= 0.07
    verdicts = [f"- {'passed' if passed else 'FAILED'}: {claim}" for claim, passed in checks.items()]
    version = run(arguments.mottle, "--version").strip()
    text = "\n".join([
        "# Prediction of held-out specimens", "",
        f"{arguments.replications} replications, ten specimens to update to and fifty held out, seeds from {FIRST_SEED} on, "
        f"{version}, {datetime.date.today().isoformat()}; made by replicate.py.", "",
        "Fraction of the held-out specimens inside the predicted 95 % intervals of each output and inside the joint region, with "
        "the standard error of the mean over the replications.", "", *lines, "", *verdicts, ""])
    if arguments.rows == list(ROWS):
        (HERE / "RESULTS.md").write_text(text)
    print(text)
    return 0 if all(checks.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
