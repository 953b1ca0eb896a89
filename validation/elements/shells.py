#!/usr/bin/env python3
"""Natural frequencies of plates and curved panels of CQUAD4, CTRIA3, CQUAD8 and CTRIA6 against closed forms, tables and CalculiX.

    python3 validation/elements/shells.py MOTTLE [--ccx CCX] [--cells N] [--modes N] [--keep FOLDER]

MOTTLE is the command; it is called as `MOTTLE modes DECK --json`. Without it ("-") only the references are printed.
Simply supported: Mindlin's plate without rotary inertia, w^2 = (D k^4 / rho t) / (1 + D k^2 / (5/6 G t)). Cantilever
and free plate: [Leissa1969], nu = 0.3, thin. The curved and the twisted cantilever: CalculiX, 8-node S8R on twice the
cells; it is also printed beside the tables, whose Ritz values are up to 1 % high.
"""

import argparse
import math

from programs import run_calculix, run_in_folder, run_mottle

YOUNG, POISSON, DENSITY = 7.0e10, 0.3, 2700.0
SIDE = 1.0
CANTILEVER = (3.492, 8.525, 21.43, 27.33, 31.11)
FREE = (13.489, 19.789, 24.432, 35.024, 35.024)


def plate_stiffness(thickness):
    return YOUNG * thickness**3 / (12.0 * (1.0 - POISSON**2))


def simply_supported(thickness):
    shear = 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * thickness
    found = []
    for m in range(1, 9):
        for n in range(1, 9):
            k2 = (math.pi / SIDE) ** 2 * (m * m + n * n)
            rigid = plate_stiffness(thickness) * k2 * k2 / (DENSITY * thickness)
            found.append(math.sqrt(rigid / (1.0 + plate_stiffness(thickness) * k2 / shear)) / (2.0 * math.pi))
    return sorted(found)


def tabulated(values, thickness):
    scale = math.sqrt(plate_stiffness(thickness) / (DENSITY * thickness)) / (2.0 * math.pi * SIDE**2)
    return [value * scale for value in values]


def flat(u, v):
    return (SIDE * u, SIDE * v, 0.0)


def curved(u, v):
    """A panel of radius 2, clamped along a generator's end."""
    angle = 0.5 * (v - 0.5)
    return (SIDE * u, 2.0 * math.sin(angle), 2.0 * (math.cos(angle) - 1.0))


def twisted(u, v):
    """A blade of aspect 3 twisted by 30 degrees."""
    angle, width = math.radians(30.0) * u, SIDE / 3.0 * (v - 0.5)
    return (SIDE * u, width * math.cos(angle), width * math.sin(angle))


def cases():
    """Name, thickness, shape, constraints (claim on u and v, components), reference in Hz or None: CalculiX."""
    def everywhere(u, v):
        return True

    def root(u, v):
        return u == 0.0

    supported = ((everywhere, "126"), (lambda u, v: u in (0.0, 1.0), "34"), (lambda u, v: v in (0.0, 1.0), "35"))
    return (
        ("simply supported t/a 0.01", 0.01, flat, supported, simply_supported(0.01)),
        ("simply supported t/a 0.1", 0.1, flat, supported, simply_supported(0.1)),
        ("cantilever", 0.005, flat, ((everywhere, "126"), (root, "345")), tabulated(CANTILEVER, 0.005)),
        ("free", 0.005, flat, ((everywhere, "126"),), tabulated(FREE, 0.005)),
        ("curved cantilever", 0.01, curved, ((root, "123456"),), None),
        ("twisted cantilever", 0.01, twisted, ((root, "123456"),), None),
    )


def real(value):
    """A number in at most eight characters, with a point."""
    if value == 0.0:
        return "0."
    if abs(value) < 1e-3 or abs(value) >= 1e5:
        mantissa, exponent = f"{value:.3e}".split("e")
        return f"{mantissa.rstrip('0')}{int(exponent):+d}"
    text = f"{value:.7f}"
    if abs(value) < 1.0:
        text = text.replace("0.", ".", 1)
    return text[:8]


def places(cells, step, has_centres=False):
    """Grid lines (i, j) with their u, v; step 2: nodes in the middle of edges, of cells where these have a diagonal."""
    for j in range(step * cells + 1):
        for i in range(step * cells + 1):
            if step == 1 or has_centres or i % 2 == 0 or j % 2 == 0:
                yield i, j, i / (step * cells), j / (step * cells)


# Nodes of the elements of a cell, on the grid lines from its corner.
PARTS = {
    "CQUAD4": (((0, 0), (1, 0), (1, 1), (0, 1)),),
    "CTRIA3": (((0, 0), (1, 0), (1, 1)), ((0, 0), (1, 1), (0, 1))),
    "CQUAD8": (((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)),),
    "CTRIA6": (((0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (1, 1)), ((0, 0), (2, 2), (0, 2), (1, 1), (1, 2), (0, 1))),
}


def held(constraints, u, v):
    return "".join(sorted({c for claim, components in constraints if claim(u, v) for c in components}))


def write_nastran(path, case, card, cells, modes):
    _, thickness, shape, constraints, _ = case
    step = 2 if card in ("CQUAD8", "CTRIA6") else 1
    nodes = list(places(cells, step, card == "CTRIA6"))
    number = {(i, j): count + 1 for count, (i, j, _, _) in enumerate(nodes)}
    with open(path, "w", encoding="ascii") as out:
        out.write(f"SOL 103\nCEND\nMETHOD = 1\nSPC = 1\nBEGIN BULK\nEIGRL,1,,,{modes + 6}\nPARAM,COUPMASS,1\n")
        out.write(f"MAT1,1,{real(YOUNG)},,{POISSON},{real(DENSITY)}\nPSHELL,1,1,{real(thickness)},1,,1\n")
        for i, j, u, v in nodes:
            out.write(f"GRID,{number[i, j]},," + ",".join(map(real, shape(u, v))) + "\n")
            if held(constraints, u, v):
                out.write(f"SPC1,1,{held(constraints, u, v)},{number[i, j]}\n")
        element = 0
        for j in range(cells):
            for i in range(cells):
                for part in PARTS[card]:
                    element += 1
                    fields = [str(number[step * i + a, step * j + b]) for a, b in part]
                    out.write(f"{card},{element},1," + ",".join(fields[:6]))
                    out.write((",+\n+," + ",".join(fields[6:]) if len(fields) > 6 else "") + "\n")
        out.write("ENDDATA\n")


def write_calculix(path, case, cells, modes):
    _, thickness, shape, constraints, _ = case
    number = {(i, j): count + 1 for count, (i, j, _, _) in enumerate(places(cells, 2))}
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    with open(path, "w", encoding="ascii") as out:
        out.write("*NODE, NSET=ALL\n")
        for i, j, u, v in places(cells, 2):
            out.write(f"{number[i, j]}, " + ", ".join(f"{x:.9f}" for x in shape(u, v)) + "\n")
        out.write("*ELEMENT, TYPE=S8R, ELSET=PLATE\n")
        for j in range(cells):
            for i in range(cells):
                nodes = ", ".join(str(number[2 * i + a, 2 * j + b]) for a, b in around)
                out.write(f"{j * cells + i + 1}, {nodes}\n")
        out.write(f"*MATERIAL, NAME=METAL\n*ELASTIC\n{YOUNG}, {POISSON}\n*DENSITY\n{DENSITY}\n")
        out.write(f"*SHELL SECTION, ELSET=PLATE, MATERIAL=METAL\n{thickness}\n*BOUNDARY\n")
        for i, j, u, v in places(cells, 2):
            for component in held(constraints, u, v):
                # A flat plate's in-plane motions are not held: CalculiX makes solids of shells and would clamp them.
                if shape is not flat or component not in "126" or u == 0.0:
                    out.write(f"{number[i, j]}, {component}\n")
        out.write(f"*STEP\n*FREQUENCY\n{modes + 6}\n*END STEP\n")


def compare(folder, arguments):
    print("| case | element | mode | reference Hz | CalculiX Hz | Mottle Hz | difference % |")
    print("|---|---|---:|---:|---:|---:|---:|")
    for case in cases():
        name, _, _, _, reference = case
        stem = name.replace(" ", "_").replace("/", "")
        calculix = [math.nan] * arguments.modes
        if name.endswith("cantilever"):
            write_calculix(folder / f"{stem}.inp", case, 2 * arguments.cells, arguments.modes)
            calculix = run_calculix(arguments.ccx, folder, stem)
        reference = reference or calculix
        lowest = 1e-2 * reference[0]  # below: rigid motions
        for card in PARTS:
            deck = folder / f"{stem}_{card}.bdf"
            is_quadratic = card in ("CQUAD8", "CTRIA6")  # the same grid points, half the cells
            write_nastran(deck, case, card, arguments.cells // 2 if is_quadratic else arguments.cells, arguments.modes)
            found = [math.nan] * arguments.modes
            if arguments.mottle != "-":
                found = [value for value in run_mottle(arguments.mottle, deck) if value > lowest]
            rows = list(zip(reference, calculix, found))[:arguments.modes]
            for mode, (exact, theirs, ours) in enumerate(rows, 1):
                print(f"| {name} | {card} | {mode} | {exact:.3f} | {theirs:.3f} | {ours:.3f} "
                      f"| {100.0 * (ours / exact - 1.0):+.2f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mottle", help="path of the mottle command, - for none")
    parser.add_argument("--ccx", default="ccx", help="path of CalculiX")
    parser.add_argument("--cells", type=int, default=16, help="cells along each side")
    parser.add_argument("--modes", type=int, default=5, help="number of modes to compare")
    run_in_folder(parser, compare)


if __name__ == "__main__":
    main()
