#!/usr/bin/env python3
"""How often the verdict of `abc` refuses right models and a wrong one, by replication, beside `maximum-likelihood` on the same tests.

Each data set is simulated by `mottle simulate` with a seed of its own. Writes VERDICTS.md beside this file and ends with exit code 1
if right models are refused in more cases than the level and four standard errors allow.

    /usr/bin/python3 validation/abc/verdicts.py [--replications N] [--lines FOLDER] [--program mottle] [--case NAME ...]
"""
import argparse
import datetime
import json
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
EXAMPLE = ROOT / "examples" / "01-three-masses"
LEVEL, STANDARD_ERRORS = 0.05, 4.0
FEW = ["update.abc.simulations=4000"]
SHAPES = 'shapes = { modes = [1, 2], dofs = ["m1", "m2", "m3"] }'


def drop_parameter(text, name, head):
    """The study without the block of a parameter."""
    return re.sub(rf'\n\[\[{head}\]\]\nname = "{name}"\n(?:[^\n\[][^\n]*\n)*', "\n", text)


def frequencies_of_two(study, truth):
    """Two parameters of three frequencies with 0.5 % noise."""
    study, truth = (text.replace(SHAPES, "") for text in (study, truth))
    study, truth = (re.sub(r'"f\*" = "0.1 %"', '"f*" = "0.5 %"', text) for text in (study, truth))
    study, truth = (re.sub(r', "phi\*" = 0.006', "", text) for text in (study, truth))
    return drop_parameter(study, "k5", "parameter"), drop_parameter(truth, "k5", "truth.parameter")


def wrong(spring, value):
    """A fixed spring of the structures differs from the model's."""
    return lambda study, truth: (study, re.sub(rf'(name = "{spring}".*?stiffness = )[\d.]+', rf"\g<1>{value}", truth))


def both(first, second):
    return lambda study, truth: second(*first(study, truth))


CASES = {  # name: (what, change of study and truth, whether the model is right)
    "two": ("two parameters, three frequencies", frequencies_of_two, True),
    "shapes": ("examples/01, shapes.toml", lambda study, truth: (study, truth), True),
    "two-wrong": ("two parameters, three frequencies, k6 3.2 where the model has 3.0", both(frequencies_of_two, wrong("k6", 3.2)), False),
    "shapes-wrong": ("examples/01, shapes.toml, k6 3.2 where the model has 3.0", wrong("k6", 3.2), False),
}


def conclusion(options, folder, method, seed, extra):
    settings = [word for text in ["update.method=\"" + method + '"', *extra] for word in ("--set", text)]
    subprocess.run([options.program, "update", "study.toml", "--seed", str(seed), "--out", method, "--threads", "1", *settings], cwd=folder, check=True,
                   capture_output=True)
    verdict = json.loads((folder / method / "result.json").read_text(encoding="utf-8"))["verdict"]
    return {"conclusion": verdict["conclusion"], "p": {test["name"]: test["p_value"] for test in verdict["tests"]}}


def replicate(options, change, seed):
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        study, truth = change((EXAMPLE / "shapes.toml").read_text(encoding="utf-8"), (EXAMPLE / "truth-shapes.toml").read_text(encoding="utf-8"))
        (folder / "study.toml").write_text(study, encoding="utf-8")
        (folder / "truth.toml").write_text(truth, encoding="utf-8")
        subprocess.run([options.program, "simulate", "truth.toml", "--seed", str(seed), "--out", "drawn"], cwd=folder, check=True, capture_output=True)
        (folder / "specimens-shapes.csv").write_bytes((folder / "drawn" / "specimens.csv").read_bytes())
        return {"abc": conclusion(options, folder, "abc", seed, FEW), "likelihood": conclusion(options, folder, "maximum-likelihood", seed, [])}


def rows_of(options, name, number):
    """One line of JSON a data set; only missing ones are computed."""
    path = options.lines / f"{name}.jsonl"
    rows = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    with path.open("a", encoding="utf-8") as file:
        for seed in range(len(rows) + 1, number + 1):
            rows.append(json.dumps(replicate(options, CASES[name][1], seed)))
            file.write(rows[-1] + "\n")
            file.flush()
    return [json.loads(row) for row in rows[:number]]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--replications", type=int, help="of every case; default: 200 of two parameters, 160 of the shapes, 60 of wrong models")
    parser.add_argument("--lines", type=pathlib.Path, default=pathlib.Path("build/abc-verdicts"))
    parser.add_argument("--program", type=lambda text: str(pathlib.Path(text).resolve()), default=ROOT / "build" / "release" / "mottle")
    parser.add_argument("--case", nargs="*", default=list(CASES))
    options = parser.parse_args()
    options.lines.mkdir(parents=True, exist_ok=True)
    lines, reached_all = [], True
    for name in options.case:
        what, _, is_right = CASES[name]
        rows = rows_of(options, name, options.replications or {"two": 200, "shapes": 160}.get(name, 60))
        counts = {method: {answer: sum(row[method]["conclusion"] == answer for row in rows) for answer in ("adequate", "inadequate", "undecided")}
                  for method in ("abc", "likelihood")}
        most = LEVEL * len(rows) + STANDARD_ERRORS * (LEVEL * (1 - LEVEL) * len(rows)) ** 0.5
        reached = not is_right or counts["abc"]["inadequate"] <= most
        reached_all = reached_all and reached
        lines.append(f"| {what} | {'right' if is_right else 'wrong'} | {len(rows)} | " +
                     " | ".join(f"{counts[m]['adequate']}, {counts[m]['inadequate']}, {counts[m]['undecided']}" for m in ("abc", "likelihood")) +
                     f" | {f'at most {most:.0f}' if is_right else ''} | {'yes' if reached else 'no'} |")
        print(lines[-1], flush=True)
    (HERE / "VERDICTS.md").write_text(
        "# Verdicts of `abc` by replication\n\n"
        f"Made by verdicts.py, {datetime.date.today()}, with {' and '.join(FEW)}. Ten specimens; verdicts adequate, inadequate, undecided; goal: right models\n"
        "inadequate no more often than the level of 5 % and four standard errors allow.\n\n"
        "| data sets | model | number | abc | maximum-likelihood | goal for inadequate | reached |\n|---|---|---|---|---|---|---|\n" +
        "\n".join(lines) + "\n", encoding="utf-8")
    sys.exit(0 if reached_all else 1)


if __name__ == "__main__":
    main()
