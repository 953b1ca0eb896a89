#!/usr/bin/env python3
"""Does any method fail on a sound problem? A thousand of them, drawn at random, by every method that estimates a population.

Chains of 1 to 7 masses, 2 to 6 specimens, 1 to 6 parameters, 1 to 7 frequencies (more or fewer than parameters); scatter
independent, correlated, in one or two directions, of some parameters only, nearly none or none (identical specimens);
noise none, known, as large as the scatter, or present and unknown; gaps; identity, logarithm and logit; full and diagonal
covariance. A result must be finite, with a covariance, ordered intervals, a verdict and a prediction. Needs the program built
with -DMOTTLE_BUILD_VALIDATION=ON; writes RESULTS.md beside this file and ends with 1 where a problem failed.

    python3 validation/sound-problems/run.py [--program build/release/validation/sound-problems/mottle_sound_problems]
"""
import argparse
import datetime
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

ROOT = HERE.parent.parent
DEFAULT = ROOT / "build/release/validation/sound-problems/mottle_sound_problems"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=pathlib.Path, default=DEFAULT)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--bootstraps", type=int, default=100)
    arguments = parser.parse_args()
    found = call(arguments.program, 0, arguments.count)
    bootstrap = call(arguments.program, 0, arguments.bootstraps, "maximum-likelihood", "intervals=bootstrap")
    found[f"maximum-likelihood, intervals = \"bootstrap\" (the first {arguments.bootstraps})"] = bootstrap["maximum-likelihood"]
    endings = ["converged", "max-iterations", "stalled", "refused", "FAILED"]
    lines = ["# Sound problems", "",
             f"Problems 0 to {arguments.count - 1} of seed 20141 (tests/support/random_problem.hpp), at most 30 iterations, "
             f"{datetime.date.today().isoformat()}; made by run.py.", "",
             "| method | " + " | ".join(endings) + " |", "|---" * (len(endings) + 1) + "|"]
    for method, outcome in found.items():
        counts = outcome["endings"]
        if set(counts) - set(endings):
            sys.exit(f"{method}: endings that the table does not have: {counts}")
        lines.append(f"| {method} | " + " | ".join(str(counts.get(ending, 0)) for ending in endings) + " |")
    reasons = {}
    for outcome in found.values():
        for number, text, description in outcome["odd"]:
            reasons.setdefault(text, []).append((number, description))
    lines += ["", "Refusals (the user can mend them: the message says how) and failures:", ""]
    lines += [f"- {len(cases)} x {text} First: problem {cases[0][0]}, {cases[0][1]}." for text, cases in sorted(reasons.items())]
    if not reasons:
        lines.append("none.")
    (HERE / "RESULTS.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))
    return 1 if any("FAILED" in outcome["endings"] for outcome in found.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
