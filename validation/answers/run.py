#!/usr/bin/env python3
"""Are right models called right? Studies drawn as users have them, by NumPy; Mottle's answers are counted.

Writes RESULTS.md beside this file and ends with 1 where a goal is missed. Needs NumPy.

    python3 validation/answers/run.py [--program build/release/mottle] [--sets 40] [--jobs 2]
"""
import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from chains import between_walls, parts_in_a_row, storeys

HERE = pathlib.Path(__file__).resolve().parent
SEED = 3801
SCATTER = 0.03  # of the specimens' parameters
NOISE = 0.001  # of a frequency

# What it is, the chain, the prior's relative deviation, the frequencies, the method.
SETTINGS = [(f"four like parts in a row, prior {100 * std:.0f} %", parts_in_a_row(), std, modes, "maximum-likelihood")
            for std, modes in ((0.1, 6), (0.2, 6), (0.3, 6), (0.3, 8), (0.3, 12))]
SETTINGS += [("a uniform chain between two walls, prior 20 %", between_walls(), 0.2, 6, "maximum-likelihood")]
SETTINGS += [("four storeys, prior 20 %", storeys(), 0.2, 4, "maximum-likelihood")]
SETTINGS += [("four like parts in a row, prior 30 %", parts_in_a_row(), 0.3, 6, method)
             for method in ("deterministic", "inversion", "moment-matching", "covariance-adjustment", "mares")]


def study_text(chain, std, modes, method):
    """The study of a chain whose parts are the parameters."""
    rows = [chain.toml()]
    for part in range(len(chain.parts)):
        rows += ["[[parameter]]", f'name = "x{part}"', f"target = {chain.targets(part)}", "relative = true",
                 f'distribution = {{ kind = "normal", mean = 1, std = {std} }}']
    return "\n".join([*rows, "[outputs]", f"frequencies = {list(range(1, modes + 1))}", "[test]", 'file = "tests.csv"',
                      f'repeatability = {{ "*" = "{100 * NOISE} %" }}', "[update]", f'method = "{method}"'])


def draw_truth(rng, chain, std):
    """A population's mean from the prior, all springs positive, and 8 to 10 specimens [specimen x part]."""
    while True:
        mean = 1.0 + std * rng.standard_normal(len(chain.parts))
        if (mean > 0.2).all():
            break
    count = int(rng.integers(8, 11))
    return mean, mean * (1.0 + SCATTER * rng.standard_normal((count, mean.size)))


def solutions_of(result):
    """Means and their intervals: of the estimate, then of the others."""
    block = result["parameters"]
    found = [(np.array(block["mean"]), block.get("mean_ci95"))]
    return found + [(np.array(other["mean"]), other["mean_ci95"]) for other in result["other_solutions"]]


def one_set(program, number, setting):
    """Draws a set, updates, and says what came out."""
    _, chain, std, modes, method = SETTINGS[setting]
    rng = np.random.default_rng([SEED, setting, number])
    mean, specimens = draw_truth(rng, chain, std)
    tests = np.array([chain.modes(x)[0][:modes] for x in specimens])
    tests *= 1.0 + NOISE * rng.standard_normal(tests.shape)
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        (place / "study.toml").write_text(study_text(chain, std, modes, method), encoding="utf-8")
        np.savetxt(place / "tests.csv", tests, delimiter=",", header=",".join(f"f{k + 1}" for k in range(modes)), comments="")
        done = subprocess.run([program, "update", "study.toml", "--out", "out", "--quiet", "--threads", "1", "--cache", "off"],
                              cwd=place, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            return {"conclusion": "failed", "reason": done.stderr.strip()}
        result = json.loads((place / "out/result.json").read_text(encoding="utf-8"))
    solutions = solutions_of(result)
    nearest = min(range(len(solutions)), key=lambda k: np.abs(solutions[k][0] - mean).max())
    ends = solutions[nearest][1]
    known = [(low, high, true) for (low, high), true in zip(ends or [], mean) if low is not None]
    return {"conclusion": result["verdict"]["conclusion"], "others": len(solutions) - 1,
            "named": bool(np.abs(solutions[nearest][0] / specimens.mean(axis=0) - 1.0).max() < 0.1),
            "held": sum(low <= true <= high for low, high, true in known), "intervals": len(known)}


def row(program, setting, sets, jobs):
    """One line of the table, and whether its goal is met: inadequate in 5 % and two standard errors at most."""
    what, chain, _, modes, method = SETTINGS[setting]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        answers = list(pool.map(lambda number: one_set(program, number, setting), range(sets)))
    count = {kind: sum(answer["conclusion"] == kind for answer in answers)
             for kind in ("adequate", "inadequate", "undecided", "failed")}
    whole = [answer for answer in answers if answer["conclusion"] != "failed"]
    intervals = sum(answer["intervals"] for answer in whole)
    held = f"{100 * sum(answer['held'] for answer in whole) / intervals:.1f}" if intervals else "-"
    named, others = (sum(bool(answer[key]) for answer in whole) for key in ("named", "others"))
    is_met = count["inadequate"] <= sets * (0.05 + 2 * np.sqrt(0.05 * 0.95 / sets)) and count["failed"] == 0
    line = (f"| {what}, {modes} frequencies | {method} | {sets} | {count['adequate']} | {count['inadequate']} | {count['undecided']} | "
            f"{count['failed']} | {named} | {others} | {held} | {'yes' if is_met else 'no'} |")
    print(line, flush=True)
    return line, is_met


HEAD = ("| what | method | sets | adequate | inadequate | undecided | failed | true parameters among the solutions | with other solutions "
        "| means within their 95 % intervals, % | reached |\n|---|---|---|---|---|---|---|---|---|---|---|")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, default=HERE.parent.parent / "build/release/mottle")
    parser.add_argument("--sets", type=int, default=40)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    print(HEAD)
    rows = [row(arguments.program.resolve(), k, arguments.sets, arguments.jobs) for k in range(len(SETTINGS))]
    text = ["# Answers to right models", "",
            f"Made by run.py, seed {SEED}. True means are drawn from the prior, 8 to 10 specimens scatter by {100 * SCATTER:.0f} % "
            f"about them, frequencies by rank with a stated noise of {100 * NOISE} %. *True parameters among the solutions*: all within "
            "10 % of the specimens' mean, of the estimate or of another solution that is named. Intervals are those of the solution nearest to "
            "the truth. Goal: inadequate in 5 % and two standard errors at most.", "", HEAD, *(line for line, _ in rows)]
    (HERE / "RESULTS.md").write_text("\n".join(text) + "\n", encoding="utf-8")
    return 0 if all(met for _, met in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
