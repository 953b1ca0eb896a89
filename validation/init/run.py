#!/usr/bin/env python3
"""Does `mottle init` choose the numbers that were moved, and is its first update adequate?

Draws populations of four decks: two to four of a deck's numbers are moved by about their usual uncertainty and scatter,
0.1 % of noise on the frequencies. `mottle init --yes` and `mottle update` follow, as a user would type them. Writes
RESULTS.md beside this file, or the rows alone with --rows. AIRMOD is skipped where its deck is absent. Needs NumPy.

    /usr/bin/python3 validation/init/run.py [--program build/release/mottle] [--before OTHER] [--sets 20] [--rows]
"""
import argparse
import concurrent.futures
import dataclasses
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
AIRMOD = ROOT.parent / "shared/data/airmod"
SEED = 3811
ALIKE = 0.98  # cosine of two numbers' changes of the frequencies
VISIBLE = 0.003  # largest change of a frequency by a number's usual uncertainty, of a number that is moved


@dataclasses.dataclass
class Deck:
    """A model, its tested modes, and how it is tested."""
    name: str
    files: list
    kind: str
    units: str
    modes: list
    specimens: int
    sets: int = 0  # 0: as many as asked for
    shapes: str = ""

    def noise(self):
        """Of the tests, as a study states it."""
        return '{ "f*" = "0.1 %"' + (', "phi*" = 0.01 }' if self.shapes else " }")


def decks():
    wing = 'shapes = { modes = [8, 9, 11, 13], dofs = ["105:+Z", "111:+Z", "112:+Z", "303:+Z"] }'
    airmod = [AIRMOD / name for name in ("AIRMOD103.bdf", "AIRMOD_SOLID_MODEL_ONLY.BDF", "PARAM.DAT")]
    return [Deck("examples/02", [ROOT / "examples/02-airframe/airframe.bdf"], "nastran", "SI", list(range(7, 17)), 20, shapes=wing),
            Deck("bracket", [HERE / "bracket.bdf"], "nastran", "mm-t-s", list(range(1, 9)), 12),
            Deck("examples/03", [ROOT / "examples/03-plate-calculix/plate.inp"], "calculix", "SI", list(range(1, 11)), 15),
            Deck("AIRMOD", airmod, "nastran", "SI", [3, 4, 5, 6, 7, 8, 9, 10, 12, 13, 14, 16, 21, 22], 20, sets=5)]


def spread(target):
    """Usual uncertainty of a number, relative."""
    card, field = target.split(":")[0], target.split(":")[-1]
    if card in ("PELAS", "CELAS2", "PBUSH", "*SPRING"):
        return 0.3
    if field == "RHO" or card == "*DENSITY":
        return 0.03
    if field in ("E", "G", "M", "J", "A") or field.startswith("I"):
        return 0.1
    return 0.05


def command(program, place, *words):
    done = subprocess.run([program, *map(str, words)], cwd=place, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}: {done.stderr.strip()[-300:]}")
    return done.stdout


def changes_of(program, deck, place):
    """Changes of the tested frequencies by the usual uncertainty of each number of the deck."""
    answer = json.loads(command(program, place, "targets", deck.files[0].name, "--modes", max(deck.modes), "--json"))
    changes = {}
    for target in answer["targets"]:
        values = np.array([target["sensitivity"][mode - 1] or 0.0 for mode in deck.modes], dtype=float)
        changes[target["target"]] = np.nan_to_num(values) * spread(target["target"])
    return changes


def alike(one, other):
    size = np.linalg.norm(one) * np.linalg.norm(other)
    return bool(size > 0 and abs(one @ other) >= ALIKE * size)


def draw_truth(rng, changes):
    """Two to four visible numbers, no two alike, with the logarithm of their mean factor and their scatter."""
    visible = [name for name in changes if np.abs(changes[name]).max() >= VISIBLE]
    moved = []
    for name in rng.permutation(visible):
        if len(moved) == 0:
            count = int(rng.integers(2, 5))
        if not any(alike(changes[name], changes[other]) for other, _, _ in moved):
            size = spread(name) * rng.uniform(0.5, 1.5) * rng.choice([-1, 1])
            moved.append((str(name), size, spread(name) * rng.uniform(0.1, 0.3)))
        if len(moved) == count:
            break
    return moved


def truth_text(deck, moved, seed):
    rows = [f'title = "truth"\nunits = "{deck.units}"\nseed = {seed}', f'[model]\nkind = "{deck.kind}"\nfile = "{deck.files[0].name}"',
            f'[outputs]\nfrequencies = {deck.modes}\ntracking = "mac"', deck.shapes, f"[truth]\nspecimens = {deck.specimens}",
            f"noise = {deck.noise()}"]
    for index, (name, shift, scatter) in enumerate(moved):
        rows += ["[[truth.parameter]]", f'name = "t{index}"', f'target = "{name}"', "relative = true",
                 f'distribution = {{ kind = "lognormal", mean = {np.exp(shift):.6g}, std = {scatter:.6g} }}']
    return "\n".join(rows) + "\n"


def draw_tests(program, deck, place, changes, rng):
    """Writes tests.csv; without shapes modes are known by rank, so populations whose modes cross are drawn again."""
    for attempt in range(200):
        moved = draw_truth(rng, changes)
        (place / "truth.toml").write_text(truth_text(deck, moved, int(rng.integers(1, 10**6))), encoding="utf-8")
        command(program, place, "simulate", "truth.toml", "--quiet", "--threads", 1, "--out", f"truth{attempt}")
        file = place / f"truth{attempt}/specimens.csv"
        frequencies = np.genfromtxt(file, delimiter=",", skip_header=1)[:, :len(deck.modes)]
        if deck.shapes or (np.diff(frequencies, axis=1) > 0).all():
            shutil.copy(file, place / "tests.csv")
            return moved
    raise RuntimeError("no population whose modes keep their order")


def chosen_numbers(study):
    """Targets of each parameter of a study."""
    lines = [line for line in study.read_text(encoding="utf-8").splitlines() if line.startswith("target =")]
    return [[part for part in line.split("#")[0].split('"') if ":" in part] for line in lines]


def verdict_of(program, place, *options):
    try:
        command(program, place, "update", "s.toml", "--out", "out", "--quiet", "--threads", 1, *options)
        return json.loads((place / "out/result.json").read_text(encoding="utf-8"))["verdict"]["conclusion"]
    except RuntimeError as error:
        return f"failed: {error}"
    finally:
        shutil.rmtree(place / "out", ignore_errors=True)


def answer_of(program, deck, place, changes, moved, options=()):
    """Verdicts without and with the noise stated, and which of the moved numbers, or one that is alike, is no parameter."""
    (place / "s.toml").unlink(missing_ok=True)
    command(program, place, "init", deck.files[0].name, "tests.csv", "--yes", "--out", "s.toml", *options)
    chosen = chosen_numbers(place / "s.toml")
    named = {name: any(name in group or any(alike(changes[name], changes[other]) for other in group) for group in chosen) for name, _, _ in moved}
    return {"verdicts": [verdict_of(program, place), verdict_of(program, place, "--set", f"test.repeatability={deck.noise()}")],
            "chosen": chosen, "missed": [name for name, is_named in named.items() if not is_named]}


def one_set(programs, deck, number):
    """Answers to one population: of each program's proposal, and of the moved numbers themselves."""
    rng = np.random.default_rng([SEED, sum(map(ord, deck.name)), number])
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        for file in deck.files:
            shutil.copy(file, place / file.name)
        changes = changes_of(programs[0], deck, place)
        moved = draw_tests(programs[0], deck, place, changes, rng)
        answers = [answer_of(program, deck, place, changes, moved) for program in programs]
        answers.append(answer_of(programs[0], deck, place, changes, moved, ("--targets", ",".join(name for name, _, _ in moved))))
    for label, answer in zip([*LABELS[:len(programs)], LABELS[-1]], answers):
        print(deck.name, number, [f"{name} {100 * shift:+.1f} +- {100 * scatter:.1f} %" for name, shift, scatter in moved],
              label, answer, file=sys.stderr, flush=True)
    return answers


def row(label, deck, answers):
    kinds = ("adequate", "inadequate", "undecided")
    counts = []
    for index in range(2):
        verdicts = [answer["verdicts"][index] for answer in answers]
        count = [sum(verdict == kind for verdict in verdicts) for kind in kinds]
        counts.append(" / ".join(map(str, [*count, len(answers) - sum(count)])))
    complete = sum(not answer["missed"] for answer in answers)
    size = np.mean([len(answer["chosen"]) for answer in answers])
    return f"| {deck.name} | {label} | {len(answers)} | {complete} | {size:.1f} | {counts[0]} | {counts[1]} |"


LABELS = ["init now", "init before", "the moved numbers"]
HEAD = ("| deck | parameters | populations | all moved numbers among the parameters | parameters, mean | noise unknown: adequate / inadequate / "
        "undecided / failed | noise stated: the same |\n|---|---|---|---|---|---|---|")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/mottle")
    parser.add_argument("--before", type=pathlib.Path, help="an earlier command, for comparison")
    parser.add_argument("--sets", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--decks", nargs="*", help="names of decks; all without it")
    parser.add_argument("--rows", action="store_true", help="print the rows, write nothing")
    options = parser.parse_args()
    programs = [options.program.resolve()] + ([options.before.resolve()] if options.before else [])
    rows = [HEAD]
    for deck in decks():
        if options.decks and deck.name not in options.decks:
            continue
        if not all(file.exists() for file in deck.files):
            print(f"{deck.name} is skipped: {deck.files[0]} is absent", file=sys.stderr)
            continue
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            answers = list(pool.map(lambda number, deck=deck: one_set(programs, deck, number), range(deck.sets or options.sets)))
        for index, label in enumerate([*LABELS[:len(programs)], LABELS[-1]]):
            rows.append(row(label, deck, [answer[index] for answer in answers]))
            print(rows[-1], flush=True)
    if not options.rows:
        text = (HERE / "RESULTS.md").read_text(encoding="utf-8") if (HERE / "RESULTS.md").exists() else "<!-- table -->"
        start = text.split("<!-- table -->")[0]
        (HERE / "RESULTS.md").write_text(start + "<!-- table -->\n" + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
