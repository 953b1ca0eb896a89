#!/usr/bin/env python3
"""Whether errors that a verdict could hide are as large, and as harmful, as result.json says.

    python3 validation/hidden-errors/run.py build/release/mottle [REPLICATIONS]

Three masses. k6 is put into the tests with the error that `verdict.could_hide` states, specimens are drawn and updated again and
again: how often is the model refused, and how far do the means move against the same specimens (same random numbers) without the
error? Once with shapes beside the frequencies, where the error is to be refused in 80 % of cases, once with the frequencies alone,
where it is never seen.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

MOTTLE = str(pathlib.Path(sys.argv[1]).resolve())
REPLICATIONS = int(sys.argv[2]) if len(sys.argv) > 2 else 200
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "01-three-masses"
K6 = 3.0


def run(*arguments):
    subprocess.run([MOTTLE, *map(str, arguments), "--quiet", "--threads", "1"], check=True)


def update(study, out, tests, settings):
    run("update", study, "--out", out, "--set", f'test.file="{tests}"', *settings)
    return json.loads((out / "result.json").read_text(encoding="utf-8"))


def replicate(folder, study, truth, settings, seed, k6):
    run("simulate", truth, "--out", folder / "truth", "--seed", seed, "--set", f"model.springs.k6.stiffness={k6!r}")
    return update(study, folder / "out", folder / "truth" / "specimens.csv", settings)


def examine(name, study, truth, settings, folder):
    """Rate of refusals and shift of k1 with the stated error of k6, against what was said of it."""
    first = replicate(folder, study, truth, settings, 1, K6)
    error = next(entry for entry in first["verdict"]["could_hide"] if entry["name"] == "k6")
    lower, upper = first["parameters"]["mean_ci95"][0]
    size = error["relative_change"]
    said = error["would_move"][0]["half_widths"] * 0.5 * (upper - lower)
    refused, shifts = 0, []
    for seed in range(1, REPLICATIONS + 1):
        right = replicate(folder, study, truth, settings, seed, K6)
        wrong = replicate(folder, study, truth, settings, seed, K6 * (1.0 + size))
        refused += wrong["verdict"]["conclusion"] == "inadequate"
        shifts.append(wrong["parameters"]["mean"][0] - right["parameters"]["mean"][0])
    rate = refused / REPLICATIONS
    shift = sum(shifts) / REPLICATIONS
    print(f"| {name} | {100.0 * size:.3g} % | {'80 %' if error['is_detected'] else 'never'} | {100.0 * rate:.1f} % "
          f"| {said:+.4f} | {shift:+.4f} |")
    return error["is_detected"], rate, said, shift


def main():
    print(f"{REPLICATIONS} replications\n\n| outputs | error of k6 | refused, stated | refused, counted | shift of k1, stated | shift of k1, measured |\n"
          "|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shapes = examine("f1 to f3, shapes of modes 1 and 2", EXAMPLES / "shapes.toml", EXAMPLES / "truth-shapes.toml", [], folder)
        alone = examine("f1 to f3", EXAMPLES / "case1.toml", EXAMPLES / "truth-case1.toml",
                        ["--set", 'update.method="maximum-likelihood"'], folder)
    deviation = math.sqrt(0.8 * 0.2 / REPLICATIONS)
    # From below: sampling alone. From above: the verdict's other tests may refuse too.
    is_right = shapes[0] and 0.8 - 3.0 * deviation <= shapes[1] <= min(0.9 + 3.0 * deviation, 1.0)
    is_right &= not alone[0] and alone[1] <= 0.05 + 3.0 * math.sqrt(0.05 * 0.95 / REPLICATIONS)
    for _, _, said, shift in (shapes, alone):
        is_right &= abs(shift - said) <= 0.15 * abs(said) + 0.002  # first order against an error of some per cent
    print("\nas said" if is_right else "\nNOT as said")
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main())
