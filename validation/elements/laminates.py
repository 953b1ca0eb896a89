#!/usr/bin/env python3
"""Natural frequencies of laminated plates (PCOMP with MAT8) against a closed form and against CalculiX.

    python3 validation/elements/laminates.py MOTTLE [--ccx CCX] [--cells N] [--modes N] [--keep FOLDER]

Simply supported cross-ply plate, thin, D16 = D26 = 0, without rotary inertia:
w^2 = pi^4 / (rho t) (D11 (m/a)^4 + 2 (D12 + 2 D66) (m n / (a b))^2 + D22 (n/b)^4). The cantilevers, turned by 30 degrees and so
with every coupling: CalculiX, 8-node S8R with *SHELL SECTION, COMPOSITE, which it expands into solids, on half the cells.
"""

import argparse
import math

from programs import run_calculix, run_in_folder, run_mottle

E1, E2, NU12, G12, G1Z, G2Z, DENSITY = 140e9, 10e9, 0.3, 5e9, 5e9, 3e9, 1600.0
LENGTH, WIDTH, PLY = 0.3, 0.2, 0.25e-3
CANTILEVERS = {"[0/45/-45/90]": (0, 45, -45, 90), "[0/45/-45/90]s": (0, 45, -45, 90, 90, -45, 45, 0), "[30/30]": (30, 30),
               "[0/90]": (0, 90)}
CROSS_PLY = (0, 90, 90, 0)
TURNED = 30.0


def grid(cells):
    """Coordinates of (cells + 1)^2 points by index pair."""
    return {(i, j): (LENGTH * i / cells, WIDTH * j / cells) for j in range(cells + 1) for i in range(cells + 1)}


def nastran(plies, cells, modes, turned, is_fixed):
    """`is_fixed`: components that are held at the index pair of a grid point."""
    lines = ["SOL 103", "CEND", "METHOD = 1", "BEGIN BULK", f"EIGRL,1,,,{modes}",
             f"MAT8,1,{E1},{E2},{NU12},{G12},{G1Z},{G2Z},{DENSITY}", "PCOMP,1"]
    for first in range(0, len(plies), 2):
        lines.append("+" + "".join(f",1,{PLY},{ply}.," for ply in plies[first:first + 2]))
    for (i, j), (x, y) in grid(cells).items():
        lines.append(f"GRID,{1 + i + (cells + 1) * j},,{x:.12g},{y:.12g},0.,,{is_fixed(i, j)}")
    for j in range(cells):
        for i in range(cells):
            low, high = 1 + i + (cells + 1) * j, 1 + i + (cells + 1) * (j + 1)
            lines.append(f"CQUAD4,{1 + i + cells * j},1,{low},{low + 1},{high + 1},{high},{turned}")
    return "\n".join([*lines, "ENDDATA", ""])


def calculix(plies, cells, modes, turned):
    fine = {key: at for key, at in grid(2 * cells).items() if not (key[0] % 2 and key[1] % 2)}
    number = {key: k for k, key in enumerate(fine, 1)}
    lines = ["*NODE", *(f"{number[key]}, {x:.12g}, {y:.12g}, 0." for key, (x, y) in fine.items()),
             "*ELEMENT, TYPE=S8R, ELSET=PLATE"]
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    for j in range(cells):
        for i in range(cells):
            lines.append(f"{1 + i + cells * j}, " + ", ".join(str(number[2 * i + u, 2 * j + v]) for u, v in around))
    lines += ["*NSET, NSET=ROOT", *(str(number[0, j]) for j in range(2 * cells + 1)), "*BOUNDARY", "ROOT, 1, 6",
              "*MATERIAL, NAME=PLY", "*ELASTIC, TYPE=ENGINEERING CONSTANTS",
              f"{E1}, {E2}, {E2}, {NU12}, {NU12}, {NU12}, {G12}, {G1Z},", f"{G2Z}", "*DENSITY", f"{DENSITY}"]
    for k, ply in enumerate(plies):
        c, s = math.cos(math.radians(ply + turned)), math.sin(math.radians(ply + turned))
        lines += [f"*ORIENTATION, NAME=AXES{k}", f"{c:.12f}, {s:.12f}, 0., {-s:.12f}, {c:.12f}, 0."]
    lines += ["*SHELL SECTION, ELSET=PLATE, COMPOSITE", *(f"{PLY}, , PLY, AXES{k}" for k in range(len(plies))),
              "*STEP", "*FREQUENCY", str(modes), "*END STEP", ""]
    return "\n".join(lines)


def simply_supported(plies, modes):
    remainder = 1.0 - NU12**2 * E2 / E1
    along, across, shared = E1 / remainder, E2 / remainder, NU12 * E2 / remainder
    d11 = d22 = d12 = d66 = 0.0
    thickness = PLY * len(plies)
    for k, ply in enumerate(plies):
        top, bottom = (k + 1) * PLY - thickness / 2, k * PLY - thickness / 2
        third = (top**3 - bottom**3) / 3.0
        d11 += third * (along if ply == 0 else across)
        d22 += third * (across if ply == 0 else along)
        d12, d66 = d12 + third * shared, d66 + third * G12
    squares = [math.pi**4 / (DENSITY * thickness) * (d11 * (m / LENGTH)**4 + d22 * (n / WIDTH)**4
                                                     + 2 * (d12 + 2 * d66) * (m * n / (LENGTH * WIDTH))**2)
               for m in range(1, 9) for n in range(1, 9)]
    return sorted(math.sqrt(square) / (2 * math.pi) for square in squares)[:modes]


def rows(name, source, reference, found):
    for mode, (exact, ours) in enumerate(zip(reference, found), 1):
        print(f"| {name} | {source} | {mode} | {exact:.3f} | {ours:.3f} | {100 * (ours / exact - 1):+.3f} |")


def compare(folder, arguments):
    cells, modes = arguments.cells, arguments.modes
    print("| plate | reference | mode | reference Hz | Mottle Hz | difference % |\n|---|---|---:|---:|---:|---:|")

    def mottle(plies, turned, is_fixed):
        deck = folder / "plate.bdf"
        deck.write_text(nastran(plies, cells, modes, turned, is_fixed), encoding="ascii")
        return run_mottle(arguments.mottle, deck)

    edge = lambda i, j: ("12356" if j in (0, cells) else "12346") if i in (0, cells) or j in (0, cells) else "126"
    supported = lambda i, j: "123456" if i in (0, cells) and j in (0, cells) else edge(i, j)
    rows("simply supported [0/90]s", "closed form", simply_supported(CROSS_PLY, modes), mottle(CROSS_PLY, 0.0, supported))
    for k, (name, plies) in enumerate(CANTILEVERS.items()):
        (folder / f"plate{k}.inp").write_text(calculix(plies, cells // 2, modes, TURNED), encoding="ascii")
        reference = run_calculix(arguments.ccx, folder, f"plate{k}")[:modes]
        rows(f"cantilever {name}", "CalculiX", reference, mottle(plies, TURNED, lambda i, j: "123456" if i == 0 else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mottle", help="path of the mottle command")
    parser.add_argument("--ccx", default="ccx", help="path of CalculiX")
    parser.add_argument("--cells", type=int, default=32, help="cells along each side of Mottle's mesh")
    parser.add_argument("--modes", type=int, default=6, help="number of modes to compare")
    run_in_folder(parser, compare)


if __name__ == "__main__":
    main()
