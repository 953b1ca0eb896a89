#!/usr/bin/env python3
"""Universal files that Mottle writes, read by Gmsh (`apt-get install gmsh`).

    python3 validation/uff/run.py MOTTLE

Gmsh keeps the nodes that elements use, so a dataset 2412 of lines from each grid point to the next is put behind
modes.uff, byte for byte as written. What Gmsh saves is compared with the deck's grid points and, read from the columns of
the published layout, dataset 55 with modes.csv.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

DECK = pathlib.Path(__file__).resolve().parents[2] / "examples" / "02-airframe" / "airframe.bdf"


def datasets(text):
    """Number and lines of each dataset."""
    lines = text.splitlines()
    marks = [k for k, line in enumerate(lines) if line == "    -1"]
    for opening, closing in zip(marks[::2], marks[1::2]):
        yield int(lines[opening + 1]), lines[opening + 2:closing]


def deck_positions():
    found = {}
    for line in DECK.read_text(encoding="ascii").splitlines():
        if line.startswith("GRID"):
            found[int(line[8:16])] = tuple(float(line[k:k + 8] or 0) for k in (24, 32, 40))
    return found


def gmsh_positions(folder, text, ids):
    elements = [f"{k:10d}{21:10d}{1:10d}{1:10d}{7:10d}{2:10d}\n{0:10d}{0:10d}{0:10d}\n{a:10d}{b:10d}"
                for k, (a, b) in enumerate(zip(ids, ids[1:]), 1)]
    (folder / "nodes.unv").write_text(text + "\n".join(["    -1", "  2412", *elements, "    -1\n"]), encoding="ascii")
    subprocess.run(["gmsh", "nodes.unv", "-0", "-save_all", "-format", "msh2", "-o", "nodes.msh"], cwd=folder, check=True,
                   capture_output=True)
    lines = iter((folder / "nodes.msh").read_text(encoding="ascii").splitlines())
    for line in lines:
        if line == "$Nodes":
            count = int(next(lines))
            rows = [next(lines).split() for _ in range(count)]
            # Gmsh numbers anew, in the order of the labels.
            return {label: tuple(map(float, row[1:])) for label, row in zip(ids, rows)}
    return {}


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([sys.argv[1], "modes", DECK, "--uff", "--out", folder, "--quiet"], check=True)
        text = (folder / "modes.uff").read_text(encoding="ascii")
        deck = deck_positions()
        read = gmsh_positions(folder, text, sorted(deck))
        print(f"grid points: {len(deck)} in the deck, {len(read)} read by Gmsh, "
              f"largest difference {max(abs(a - b) for node in read for a, b in zip(read[node], deck[node])):.1e} m")
        with open(folder / "modes.csv", newline="", encoding="ascii") as file:
            solved = [float(row["frequency"]) for row in csv.DictReader(file)]
        modes = [lines for number, lines in datasets(text) if number == 55]
        worst = max(abs(float(lines[7][:13]) / frequency - 1) for lines, frequency in zip(modes, solved))
        values = [float(lines[k][13 * c:13 * c + 13]) for lines in modes for k in range(9, len(lines), 2) for c in range(3)]
        print(f"modes: {len(solved)} solved, {len(modes)} written, frequencies within {worst:.1e}; "
              f"{len(values)} components in columns of 13, largest {max(map(abs, values)):.3f}")


if __name__ == "__main__":
    main()
