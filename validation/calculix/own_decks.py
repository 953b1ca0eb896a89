#!/usr/bin/env python3
"""Frequencies inside Mottle against CalculiX's own on the decks that its authors test it with. See OWN-DECKS.md.

    python3 validation/calculix/own_decks.py build/release/mottle FOLDER [DECK...]

FOLDER holds the decks: examples/test of Debian's package calculix-ccx-test (apt-get download calculix-ccx-test; dpkg -x).
Standard library only; needs ccx on the PATH.
"""
import collections
import gzip
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
SECONDS = 60
AGREEMENT = 1e-4
FIRST_FIELD = {"ISO": "E", "ENG": "E1", "ORT": "D1111", "ANI": "D1111"}


def unpack(folder, target):
    for file in sorted(folder.glob("*.inp")):
        (target / file.name).write_bytes(file.read_bytes())
    for file in sorted(folder.glob("*.inp.gz")):
        (target / file.stem).write_bytes(gzip.decompress(file.read_bytes()))


def keywords(text):
    """(name, parameters) of each keyword line, in capitals."""
    for line in text.upper().splitlines():
        if not line.startswith("*") or line.startswith("**"):
            continue
        name, *parts = [part.replace(" ", "") for part in line[1:].split(",")]
        yield name, dict(part.partition("=")[::2] for part in parts)


def first_target(text):
    """A modulus, else a density, else a spring."""
    material, found = "", {}
    for name, parameters in keywords(text):
        if name == "MATERIAL":
            material = parameters.get("NAME", "")
        if name == "ELASTIC":
            field = FIRST_FIELD.get(parameters.get("TYPE", "ISO")[:3])
            if field:
                found.setdefault(name, f"*ELASTIC:{material}:{field}")
        if name == "DENSITY":
            found.setdefault(name, f"*DENSITY:{material}")
        if name == "SPRING" and "NONLINEAR" not in parameters:
            found.setdefault(name, f"*SPRING:{parameters.get('ELSET', '')}")
    return next((found[name] for name in ("ELASTIC", "DENSITY", "SPRING") if name in found), None)


def solver_frequencies(deck):
    """Of the first table of the solver's .dat, in cycles/time; below 0 where an eigenvalue is. None: it does not solve it."""
    try:
        subprocess.run(["ccx", deck.stem], cwd=deck.parent, env=ONE_THREAD, timeout=SECONDS, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        text = deck.with_suffix(".dat").read_text()
    except (subprocess.TimeoutExpired, OSError):
        return None
    table = text.partition("E I G E N V A L U E   O U T P U T")[2].partition("P A R T I C I P A T I O N")[0]
    rows = [[float(word) for word in line.split() if "." in word] for line in table.splitlines() if re.match(r" +\d", line)]
    return [-abs(row[-1]) / (2 * 3.141592653589793) if row[0] < 0 else row[-2] for row in rows] or None


def mottle_frequencies(program, deck, target):
    study = deck.with_suffix(".toml")
    study.write_text(f"""\
[model]
kind = "calculix"
file = "{deck.name}"
[[parameter]]
name = "x"
target = "{target}"
relative = true
distribution = {{ kind = "normal", mean = 1.0, std = 0.02 }}
[outputs]
frequencies = [1, 2, 3]
tracking = "order"
""")
    command = [program, "check", study, "--cache", deck.parent / "cache"]
    done = subprocess.run([*command, "--json"], text=True, capture_output=True)
    if done.returncode:
        return None, f"({done.returncode}) {done.stderr.strip()}"
    notes = " ".join(subprocess.run(command, text=True, capture_output=True).stdout.split())
    return json.loads(done.stdout)["frequencies"], notes


def difference(own, ours):
    """Largest relative difference of the first modes; of rigid-body modes none, where both have a thousandth of the highest."""
    pairs = [(max(a, 0.0), b) for a, b in zip(own[:3], ours)]
    rigid = 1e-3 * max(own)
    return max((abs(a - b) / max(a, rigid) for a, b in pairs if max(a, b) > rigid), default=0.0)


def judge(program, deck, text):
    """(result, what was said); no result where the solver has none."""
    own = solver_frequencies(deck)
    if own is None:
        return None, ""
    target = first_target(text)
    ours, said = mottle_frequencies(program, deck, target)
    if ours is None:
        return "refused", said
    error = difference(own, ours)
    return f"{'equal' if error <= AGREEMENT else 'WRONG'}: {error:.0e}", said


def short(said, deck):
    """A refusal without folders."""
    message = said.replace(str(deck.parent) + "/", "").partition("mottle: ")[2].partition("(run ")[0].strip()
    return re.split(r"; (?:give|they are|a stiff)|\n", message)[0]


def reason_of_runs(notes):
    return re.sub(r"( note:| Of the deck's| parameter acts on| \(run| [A-Z]\w+:).*", "", notes.partition("each sample is a run, since ")[2])


def main():
    if len(sys.argv) < 3 or not list(pathlib.Path(sys.argv[2]).glob("*.inp*")):
        print("skipped: no decks; give the folder examples/test of Debian's package calculix-ccx-test (see this file's head)")
        return
    program, folder, only = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]), sys.argv[3:]
    counts = collections.Counter()
    print("| deck | modes | how | message |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        unpack(folder, pathlib.Path(name))
        for deck in sorted(pathlib.Path(name).glob("*.inp")):
            text = deck.read_text(encoding="latin-1")
            if "FREQUENCY" not in dict(keywords(text)) or (only and deck.stem not in only):
                continue
            result, said = judge(program, deck, text)
            counts[result.partition(":")[0] if result else "not solved by CalculiX"] += 1
            if result is None:
                continue
            how = "" if result == "refused" else "runs" if "each sample is a run" in said else "matrices"
            why = short(said, deck) if result == "refused" else reason_of_runs(said)
            print(f"| {deck.stem} | {result} | {how} | {why} |", flush=True)
    print("\n" + ", ".join(f"{count} {name}" for name, count in sorted(counts.items())))
    if counts["WRONG"]:
        sys.exit("some modes are not CalculiX's")


if __name__ == "__main__":
    main()
