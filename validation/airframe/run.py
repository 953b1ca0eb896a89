#!/usr/bin/env python3
"""The airframe of examples/02-airframe with known truth: the population of aeroplanes drawn from truth.toml.

    validation/airframe/run.py MOTTLE [--replications N] [--keep FOLDER]

1. 80 aeroplanes, method maximum-likelihood: the updated model's scatter beside the tests', the parameters beside the truth.
2. Half of them updated to, the other half held out.
3. Twenty aeroplanes, N times: how often the true means and deviations lie inside their 95 % intervals.
Prints the tables and ends with 1 where a claim of README.md does not hold.
"""
import argparse
import json
import math
import pathlib
import re
import shutil
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from specimen_halves import correlation, print_scatter, run, update_half  # noqa: E402

EXAMPLE = HERE.parent.parent / "examples" / "02-airframe"
FREQUENCIES = "frequencies = [7, 8, 9, 10, 11, 12, 13, 14, 15, 16]"


def truth():
    """Noise of the frequencies, and (name, mean, deviation) of the parameters, as truth.toml has them."""
    study = tomllib.loads((EXAMPLE / "truth.toml").read_text())["truth"]
    noise = {name: value for name, value in study["noise"].items() if name.startswith("f")}
    return noise, [(p["name"], p["distribution"]["mean"], p["distribution"]["std"]) for p in study["parameter"]]


def draw(mottle, specimens, seed, folder):
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(EXAMPLE / "airframe.bdf", folder)
    text = (EXAMPLE / "truth.toml").read_text()
    text = re.sub(r"shapes = .*\n", "", re.sub(r'"phi.*\n', "", text))
    (folder / "truth.toml").write_text(text)
    run(mottle, "simulate", folder / "truth.toml", "--json", "--out", folder / "truth", "--seed", seed,
        "--set", f"truth.specimens={specimens}")
    # Columns of the true parameters are left out by the reader of tests; here nobody should even see them.
    (folder / "tests.csv").write_bytes((folder / "truth" / "specimens.csv").read_bytes())
    return folder / "tests.csv"


def study_text():
    noise, _ = truth()
    text = (EXAMPLE / "study.toml").read_text()
    text = text[:text.index("[update]")]
    levels = ", ".join(f"{name} = {value}" for name, value in noise.items())
    text = text.replace('file = "specimens.csv"', f'file = "tests.csv"\nrepeatability = {{ {levels} }}')
    return text + '[update]\nmethod = "maximum-likelihood"\nsamples = 4000\nsampling = "latin-hypercube"\n'


def update(mottle, folder, *options):
    (folder / "study.toml").write_text(study_text())
    _, seconds = run(mottle, "update", folder / "study.toml", "--json", "--out", folder / "out", *options)
    return json.loads((folder / "out" / "result.json").read_text()), seconds


def check_scatter(mottle, folder):
    tests = draw(mottle, 80, 1997, folder)
    result, seconds = update(mottle, folder, "--threads", 1)
    outputs, parameters = result["outputs"], result["parameters"]
    means, ratios = print_scatter(outputs)
    differences = [abs(correlation(outputs["final_covariance"], i, j) - correlation(outputs["test_covariance"], i, j))
                   for i in range(10) for j in range(i)]
    print(f"means within 0.02 %: {means} of 10, standard deviations within 5 %: {ratios} of 10, largest difference of a correlation "
          f"{max(differences):.3f}; {result['verdict']['conclusion']}; {seconds:.1f} s on one core")
    print("\n| parameter | true mean | found | 95 % | true standard deviation | found | 95 % |\n|---|---|---|---|---|---|---|")
    inside = 0
    for i, (_, mean, std) in enumerate(truth()[1]):
        found = [parameters[key][i] for key in ("mean", "mean_ci95", "std", "std_ci95")]
        inside += (found[1][0] <= mean <= found[1][1]) + (found[3][0] <= std <= found[3][1])
        numbers = [mean, found[0], *found[1], std, found[2], *found[3]]
        cells = [f"{number:.4g}" for number in numbers]
        print(f"| {parameters['names'][i]} | {cells[0]} | {cells[1]} | {cells[2]} to {cells[3]} | {cells[4]} | {cells[5]} | "
              f"{cells[6]} to {cells[7]} |")
    print(f"{inside} of 16 inside")
    for direction in result["identifiability"]["unseen_directions"]:
        print("  " + direction["meaning"])
    half = update_half(mottle, study_text().replace('"airframe.bdf"', json.dumps(str(folder / "airframe.bdf"))),
                       FREQUENCIES + '\ntracking = "mac"', tests, folder / "half")
    coverage = half["prediction"]["held_out"]["joint_coverage"]
    # 40 held out: 95 % +- 2.6 standard errors of 3.4 %, and of what 40 specimens leave open
    return result["verdict"]["adequate"] and means >= 9 and ratios >= 9 and inside >= 13 and coverage >= 0.85


def check_coverage(mottle, folder, replications):
    hits = {"mean": [], "std": []}
    verdicts = []
    for replication in range(replications):
        draw(mottle, 20, 5000 + replication, folder)
        result, _ = update(mottle, folder, "--set", "update.maximum-likelihood.starts=0", "--set", "update.samples=200")
        parameters = result["parameters"]
        verdicts.append(result["verdict"]["conclusion"] == "adequate")
        for i, (_, mean, std) in enumerate(truth()[1]):
            for key, value in (("mean", mean), ("std", std)):
                low, high = parameters[key + "_ci95"][i]
                hits[key].append(low <= value <= high)
    parts = {key: sum(values) / len(values) for key, values in hits.items()}
    limit = 0.95 - 3 * math.sqrt(0.95 * 0.05 / (2 * replications))  # the eight of a replication are not independent
    print(f"\n{replications} replications of twenty aeroplanes: {100 * parts['mean']:.1f} % of the true means and "
          f"{100 * parts['std']:.1f} % of the true standard deviations inside their 95 % intervals (at least {100 * limit:.1f} % wanted); "
          f"adequate: {sum(verdicts)} of {replications}")
    return min(parts.values()) >= limit and sum(verdicts) >= replications - 4


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mottle", type=pathlib.Path)
    parser.add_argument("--replications", type=int, default=25)
    parser.add_argument("--keep", type=pathlib.Path, help="leave the results there")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        claims = [check_scatter(options.mottle.resolve(), folder / "scatter"),
                  check_coverage(options.mottle.resolve(), folder / "coverage", options.replications)]
    return 0 if all(claims) else 1


if __name__ == "__main__":
    raise SystemExit(main())
