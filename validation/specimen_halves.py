"""What validation/airmod and validation/airframe share: runs of mottle, the scatter of an updated model beside that of its tests,
and one half of the tests held out while the other is updated to."""
import csv
import json
import math
import subprocess
import time


def run(*arguments):
    """What a command with --json printed, and how long it took."""
    begin = time.monotonic()
    done = subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return json.loads(done.stdout), time.monotonic() - begin


def print_scatter(outputs):
    """Means and deviations of the updated model beside the tests'.

    Returns how many means lie within 0.02 % and how many deviations within 5 %.
    """
    print(f"\n| output | tested | mean, difference % | standard deviation, model / tests |\n|---|---|---|---|")
    means = ratios = 0
    for i, name in enumerate(outputs["names"]):
        difference = 100 * (outputs["final_mean"][i] / outputs["test_mean"][i] - 1)
        ratio = math.sqrt(outputs["final_covariance"][i][i] / outputs["test_covariance"][i][i])
        means += abs(difference) <= 0.02
        ratios += 0.95 <= ratio <= 1.05
        print(f"| {name} | {outputs['test_count'][i]} | {difference:.4f} | {ratio:.3f} |")
    return means, ratios


def correlation(covariance, i, j):
    return covariance[i][j] / math.sqrt(covariance[i][i] * covariance[j][j])


def update_half(mottle, study_text, predict, tests, folder, *options):
    """Updates to every second row of `tests` and predicts the rows between; prints and returns the held-out check.

    study_text  names "tests.csv" beside it and has no [predict]
    predict     keys of [predict]: its outputs
    """
    header, *rows = csv.reader(tests.open())
    folder.mkdir(exist_ok=True)
    for name, part in (("tests.csv", rows[0::2]), ("held-out.csv", rows[1::2])):
        with (folder / name).open("w", newline="") as file:
            csv.writer(file).writerows([header, *part])
    study_text += f'\n[predict]\n{predict}\nheld_out = "held-out.csv"\n'
    (folder / "study.toml").write_text(study_text)
    _, seconds = run(mottle, "update", folder / "study.toml", "--json", "--out", folder / "out", *options)
    result = json.loads((folder / "out" / "result.json").read_text())
    check = result["prediction"]["held_out"]
    print(f"\n{len(rows[0::2])} tests updated to, {len(rows[1::2])} held out, {seconds:.0f} s: inside the joint 95 % region "
          f"{100 * check['joint_coverage']:.1f} % of them; inside the interval of each output:")
    print("  " + ", ".join(f"{name} {100 * part:.0f} %" for name, part in zip(result["prediction"]["names"], check["coverage"])))
    return result
