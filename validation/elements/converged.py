#!/usr/bin/env python3
"""Each continuum element on three meshes, one finer than the other: observed order and converged frequencies.

    python3 validation/elements/converged.py MOTTLE

Solids: a box between smooth rigid walls (no displacement along the normal, no force along the wall). Every mode is a plane
wave, w = c k with k = pi (l/a, m/b, n/c), c of pressure waves (one mode for each l, m, n) or of shear waves (two modes, one
where one of l, m, n is zero, none where two are) [closed form, vector Helmholtz equation]. Shells: the simply supported
plate of shells.py, t/a = 0.01. Consistent mass. The converged value is Richardson's from the three meshes. Ends with 1 where
one is off by more than 0.1 %.
"""

import argparse
import math
import pathlib
import tempfile

import shells
import solids
from programs import run_mottle

SIZE = (1.0, 0.8, 0.6)
MODES = 6
BOX_MODES = 4  # the fifth to seventh lie within 1.2 % and change places on coarse meshes
ALLOWED = 0.1


def box_frequencies(count):
    young, nu, rho = solids.YOUNG, solids.POISSON, solids.DENSITY
    shear = math.sqrt(young / (2.0 * (1.0 + nu)) / rho)
    pressure = math.sqrt(young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / rho)
    found = []
    for l in range(6):
        for m in range(6):
            for n in range(6):
                k = math.pi * math.hypot(l / SIZE[0], m / SIZE[1], n / SIZE[2])
                waves = sum(number > 0 for number in (l, m, n))
                found += [pressure * k / (2.0 * math.pi)] * (waves > 0) + [shear * k / (2.0 * math.pi)] * max(0, waves - 1)
    return sorted(found)[:count]


def write_box(path, kind, cells):
    nodes, elements = solids.make_mesh(kind, (cells,) * 3, SIZE, 0.0)
    solids.write_nastran(path, kind, nodes, elements, BOX_MODES)
    lines = [line for line in path.read_text(encoding="ascii").splitlines() if not line.startswith(("SPC1,", "ENDDATA"))]
    for number, place in enumerate(nodes, 1):
        walls = "".join(str(axis + 1) for axis in range(3) if place[axis] in (0.0, SIZE[axis]))
        if walls:
            lines.append(f"SPC1,1,{walls},{number}")
    path.write_text("\n".join(lines) + "\nENDDATA\n", encoding="ascii")


def richardson(coarse, middle, fine):
    order = math.log2((coarse - middle) / (middle - fine)) if (coarse - middle) * (middle - fine) > 0 else float("nan")
    return order, fine + (fine - middle) / (2.0**order - 1.0) if order == order else fine


def report(element, exact, meshes, found):
    worst = 0.0
    for mode, reference in enumerate(exact):
        values = [frequencies[mode] for frequencies in found]
        order, converged = richardson(*values)
        difference = 100.0 * (converged / reference - 1.0)
        worst = max(worst, abs(difference))
        print(f"| {element} | {mode + 1} | {reference:.3f} | " + " | ".join(f"{value:.3f}" for value in values)
              + f" | {order:.2f} | {converged:.3f} | {difference:+.4f} |")
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mottle")
    command = parser.parse_args().mottle
    worst = 0.0
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        print("| element | mode | exact Hz | coarse | middle | fine | order | converged Hz | difference % |")
        print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
        for kind, meshes in (("C3D8I", (4, 8, 16)), ("C3D6", (4, 8, 16)), ("C3D4", (6, 12, 24)), ("C3D10", (2, 4, 8)),
                             ("C3D20", (2, 4, 8)), ("C3D15", (2, 4, 8)), ("PYRAMID13", (2, 4, 8))):
            found = []
            for cells in meshes:
                deck = folder / f"{kind}_{cells}.bdf"
                write_box(deck, kind, cells)
                found.append(run_mottle(command, deck))
            nodes = {"C3D10": 10, "C3D20": 20, "C3D15": 15, "PYRAMID13": 13}.get(kind, "")
            name = f"{solids.CARD[kind]}{nodes} {' / '.join(map(str, meshes))}"
            worst = max(worst, report(name, box_frequencies(BOX_MODES), meshes, found))
        case = shells.cases()[0]
        for card in shells.PARTS:
            found, meshes = [], (8, 16, 32) if card in ("CQUAD8", "CTRIA6") else (12, 24, 48)
            for cells in meshes:
                deck = folder / f"{card}_{cells}.bdf"
                shells.write_nastran(deck, case, card, cells, 8)
                found.append(run_mottle(command, deck))
            worst = max(worst, report(f"{card} {' / '.join(map(str, meshes))}", case[4][:MODES], meshes, found))
    print(f"largest difference of a converged frequency: {worst:.4f} %")
    return 0 if worst <= ALLOWED else 1


if __name__ == "__main__":
    raise SystemExit(main())
