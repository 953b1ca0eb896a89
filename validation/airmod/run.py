#!/usr/bin/env python3
"""AIRMOD: the deck's modes against MD Nastran's, its 18 parameters updated on the means of 14 test modes, the population of
its 86 assemblies, and a wide cloud by the certified reduced model against full solutions.

    validation/airmod/run.py MOTTLE DATA [--keep FOLDER]

MOTTLE is the command, DATA the folder with AIRMOD103.bdf, its f06 table and airmod_tests.csv (not part of this repository).
Prints the tables and ends with 1 where a claim of README.md does not hold.
"""
import argparse
import csv
import json
import pathlib
import re
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from specimen_halves import correlation, print_scatter, run, update_half  # noqa: E402

TEST_MODES = [1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 14, 19, 20]
NASTRAN_MASS = (42.0211, 42.2211, 42.0211)


def nastran_frequencies(file):
    """The column CYCLES of the eigenvalue table."""
    rows = [line.split() for line in file.read_text().splitlines()]
    return [float(row[4]) for row in rows if len(row) == 7 and row[0].isdigit()]


def check_modes(mottle, data, folder):
    deck = data / "AIRMOD103.bdf"
    found, seconds = run(mottle, "modes", deck, "--json", "--out", folder / "modes")
    reference = nastran_frequencies(data / "AIRMOD103_nominal_eigenvalues_f06.txt")
    print(f"{'mode':>4} {'Nastran Hz':>12} {'Mottle Hz':>12} {'difference %':>13}")
    differences = []
    for mode, (ours, theirs) in enumerate(zip(found["frequencies"], reference), start=1):
        differences.append(100 * (ours / theirs - 1))
        print(f"{mode:>4} {theirs:>12.6g} {ours:>12.6g} {differences[-1]:>13.4f}")
    elastic = [abs(value) for value in differences[1:]]
    near = sum(value <= 0.15 for value in elastic)
    print(f"modes 2-35: largest {max(elastic):.3f} %, {near} of 34 within 0.15 %")
    print("mass along x, y, z:", " ".join(f"{value:.6f}" for value in found["mass"]), "Nastran:", *NASTRAN_MASS)
    print(f"read, assembled, {len(found['frequencies'])} modes solved and counted in {found['seconds']:.3f} s, "
          f"with page and files {seconds:.3f} s")
    masses = all(abs(ours / theirs - 1) < 1e-5 for ours, theirs in zip(found["mass"], NASTRAN_MASS))
    return max(elastic) <= 0.6 and near >= 28 and masses and found["counted_below"] == 35


def write_study(data, folder):
    rows = list(csv.reader((data / "airmod_tests.csv").open()))
    lines = [",".join(f"f{mode + 2}" for mode in TEST_MODES)]
    for row in rows:
        cells = [row[mode - 1].strip() for mode in TEST_MODES]
        if any(cell.lower() != "nan" for cell in cells):
            lines.append(",".join("" if cell.lower() == "nan" else cell for cell in cells))
    (folder / "tests.csv").write_text("\n".join(lines) + "\n")
    study = (HERE / "study.toml").read_text().replace('"AIRMOD103.bdf"', json.dumps(str(data / "AIRMOD103.bdf")))
    (folder / "study.toml").write_text(study)


def check_update(mottle, data, folder):
    write_study(data, folder)
    _, seconds = run(mottle, "update", folder / "study.toml", "--json", "--out", folder / "update")
    result = json.loads((folder / "update" / "result.json").read_text())
    outputs, parameters = result["outputs"], result["parameters"]
    print(f"\n{'output':>6} {'tests Hz':>12} {'prior mean':>12} {'updated Hz':>12} {'difference %':>13}")
    worst = 0.0
    for name, test, start, end in zip(outputs["names"], outputs["test_mean"], result["iterations"][0]["output_mean"],
                                      outputs["final_mean"]):
        worst = max(worst, abs(100 * (end / test - 1)))
        print(f"{name:>6} {test:>12.6g} {start:>12.6g} {end:>12.6g} {100 * (end / test - 1):>13.4f}")
    print("\nfactors on the deck's values:")
    for name, mean, std in zip(parameters["names"], parameters["mean"], parameters["std"]):
        print(f"{name:>6} {mean:>9.4f} +- {std:.4f}")
    print(f"{result['status']}: {result['message']}; {result['model_evaluations']} model runs, {seconds:.1f} s")
    print("combinations that cannot be identified from the tests (rank "
          f"{result['identifiability']['rank']} of {len(parameters['names'])}), in standard deviations of the prior:")
    for direction in result["identifiability"]["unseen_directions"]:
        weights = sorted(direction["weights"].items(), key=lambda item: -abs(item[1]))
        print("  " + " ".join(f"{weight:+.2f} {name}" for name, weight in weights if abs(weight) > 0.1))
    return result["status"] == "converged" and worst <= 0.02 and not result["failed_evaluations"]


def check_population(mottle, folder):
    """The population of the 86 assemblies by maximum likelihood: the scatter of the updated model against the tests'."""
    text = (folder / "study.toml").read_text()
    text = re.sub(r"method = .*\nsamples = .*\n", 'method = "maximum-likelihood"\nsamples = 1000\n', text)
    text = re.sub(r"tolerance = .*\n\[update.deterministic\]\n.*\n", "tolerance = 1e-3\n", text)
    text = text.replace("relative = true", 'relative = true\nscale = "log"')
    text = text.replace('file = "tests.csv"', 'file = "tests.csv"\nrepeatability = { "f*" = "0.02 %" }')
    (folder / "population.toml").write_text(text)
    options = ("--threads", 1, "--cache", "off", "--set", "update.maximum-likelihood.starts=0")
    _, seconds = run(mottle, "update", folder / "population.toml", "--json", "--out", folder / "population", *options)
    result = json.loads((folder / "population" / "result.json").read_text())
    outputs = result["outputs"]
    means, ratios = print_scatter(outputs)
    first, second = outputs["names"].index("f21"), outputs["names"].index("f22")
    correlations = [correlation(outputs[name], first, second) for name in ("final_covariance", "test_covariance")]
    print(f"means within 0.02 %: {means} of 14, standard deviations within 5 %: {ratios} of 14, correlation of test modes 19 and "
          f"20: {correlations[0]:.3f}, tests {correlations[1]:.3f}")
    print(f"{result['status']}: {result['message']}; {result['model_evaluations']} model runs, {seconds:.0f} s on one core")
    for direction in result["identifiability"]["unseen_directions"]:
        print("  " + direction["meaning"])
    frequencies = [int(name[1:]) for name in outputs["names"]]
    half = update_half(mottle, text, f"frequencies = {frequencies}", folder / "tests.csv", folder / "half", *options)
    return (result["status"] == "converged" and means >= 11 and ratios >= 9 and half["status"] == "converged" and
            abs(correlations[0] - correlations[1]) <= 0.05)


def propagate(mottle, folder, name, samples, reduction):
    settings = {"update.samples": samples, "model.reduction": json.dumps(reduction)}
    words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    _, seconds = run(mottle, "propagate", folder / "cloud.toml", "--json", "--threads", 1, "--cache", "off", "--out",
                     folder / name, *words)
    table = list(csv.DictReader((folder / name / "cloud.csv").open()))
    return json.loads((folder / name / "result.json").read_text()), table, seconds


def check_cloud(mottle, folder, samples=4000, exact_samples=60):
    """18 parameters uniform over 0.3 to 1.9 of the deck's values, modes 2 to 36."""
    text = (folder / "study.toml").read_text()
    text = re.sub(r"distribution = \{.*\}", 'distribution = { kind = "uniform", lower = 0.3, upper = 1.9 }', text)
    text = re.sub(r"frequencies = \[.*\]", f'frequencies = {list(range(2, 37))}\ntracking = "order"', text)
    text = re.sub(r"bounds = .*\n|\[test\]\nfile = .*\n", "", text)
    (folder / "cloud.toml").write_text(text)
    result, cloud, seconds = propagate(mottle, folder, "cloud", samples, "auto")
    _, exact, exact_seconds = propagate(mottle, folder, "exact", exact_samples, "off")
    names = [name for name in cloud[0] if re.fullmatch(r"f\d+", name)]
    errors = [abs(float(ours[name]) / float(full[name]) - 1) for ours, full in zip(cloud, exact) for name in names]
    used = result["reduction"]
    ratio = exact_seconds / exact_samples * samples / seconds
    print(f"\ncloud of {samples}, {len(names)} modes: {seconds:.1f} s on one core with {used['basis_vectors']} vectors, "
          f"{ratio:.0f} times as fast as {exact_seconds / exact_samples:.3f} s a full solution; "
          f"{used['exact_samples']} samples in full, bound {used['frequency_error_bound']:.1e}, "
          f"largest true error of {len(errors)} frequencies {max(errors):.1e}")
    return max(errors) <= used["frequency_error_bound"] <= 1e-4


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mottle", type=pathlib.Path)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path, help="leave the results there")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        claims = [check_modes(options.mottle, options.data.resolve(), folder),
                  check_update(options.mottle, options.data.resolve(), folder),
                  check_population(options.mottle, folder),
                  check_cloud(options.mottle, folder)]
    return 0 if all(claims) else 1


if __name__ == "__main__":
    raise SystemExit(main())
