#!/usr/bin/env python3
"""Natural frequencies of clamped blocks of solid elements, by CalculiX and by Mottle, mesh by mesh.

    python3 validation/elements/solids.py MOTTLE [--ccx CCX] [--modes N] [--keep FOLDER]

MOTTLE is the command; it is called as `MOTTLE modes DECK --json`. Each mesh is written twice, as a CalculiX input and
as a Nastran deck. The reference of a case is a fine mesh of CalculiX's 20-node bricks of the same body.
"""

import argparse

from programs import run_calculix, run_in_folder, run_mottle

YOUNG, POISSON, DENSITY = 2.1e11, 0.3, 7850.0
TETRAHEDRON_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
BRICK_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
SPLIT = {
    "C3D8I": ((0, 1, 2, 3, 4, 5, 6, 7),),
    "C3D20R": ((0, 1, 2, 3, 4, 5, 6, 7),),
    "C3D6": ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)),
    "C3D4": ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)),
}
SPLIT["C3D10"] = SPLIT["C3D4"]
SPLIT["C3D20"] = SPLIT["C3D20R"]
SPLIT["C3D15"] = SPLIT["C3D6"]
# Of no CalculiX element; corner 8 is the middle of the cell.
SPLIT["PYRAMID13"] = ((0, 1, 2, 3, 8), (4, 7, 6, 5, 8), (0, 4, 5, 1, 8), (1, 5, 6, 2, 8), (2, 6, 7, 3, 8), (3, 7, 4, 0, 8))
WEDGE_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
PYRAMID_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4))
MID_EDGES = {"C3D20R": BRICK_EDGES, "C3D20": BRICK_EDGES, "C3D15": WEDGE_EDGES, "C3D10": TETRAHEDRON_EDGES,
             "PYRAMID13": PYRAMID_EDGES}
CARD = {"C3D8I": "CHEXA", "C3D6": "CPENTA", "C3D4": "CTETRA", "C3D10": "CTETRA", "C3D20": "CHEXA", "C3D15": "CPENTA",
        "PYRAMID13": "CPYRAM"}
# Where Nastran's nodes stand among CalculiX's: the upright edges come before those of the top.
NASTRAN_ORDER = {"C3D20": (*range(12), *range(16, 20), *range(12, 16)), "C3D15": (*range(9), 12, 13, 14, 9, 10, 11)}

# name, size in m, distortion (share of a cell by which inner nodes move), meshes (type, cells), cells of the reference
CASES = (
    ("plate", (0.3, 0.12, 0.006), 0.0,
     (("C3D8I", (15, 6, 1)), ("C3D8I", (30, 12, 2)), ("C3D6", (30, 12, 2)), ("C3D10", (15, 6, 1)), ("C3D20", (15, 6, 1)),
      ("C3D15", (15, 6, 1))), (30, 12, 2)),
    ("block", (0.3, 0.06, 0.04), 0.0,
     (("C3D8I", (15, 3, 2)), ("C3D8I", (30, 6, 4)), ("C3D6", (30, 6, 4)), ("C3D4", (30, 6, 4)), ("C3D10", (15, 3, 2)),
      ("C3D20", (15, 3, 2)), ("C3D15", (15, 3, 2))), (30, 6, 4)),
    ("distorted block", (0.3, 0.06, 0.04), 0.25,
     (("C3D8I", (15, 3, 2)), ("C3D6", (15, 3, 2)), ("C3D4", (15, 3, 2)), ("C3D10", (15, 3, 2)),
      ("C3D20", (15, 3, 2)), ("C3D15", (15, 3, 2))), (30, 6, 4)),
)


def wave(i, j, k, axis):
    """A repeatable number in (-1, 1) for a node and a direction."""
    return ((7919 * (i + 1) + 104729 * (j + 1) + 1299709 * (k + 1) + 15485863 * (axis + 1)) % 1009) / 504.5 - 1.0


def make_mesh(kind, cells, size, distortion):
    """Node positions (rounded to the digits that a deck's field holds) and elements, both counted from 0."""
    def index(i, j, k):
        return i + (cells[0] + 1) * (j + (cells[1] + 1) * k)

    nodes = []
    for k in range(cells[2] + 1):
        for j in range(cells[1] + 1):
            for i in range(cells[0] + 1):
                place = []
                for axis, at in enumerate((i, j, k)):
                    move = distortion * wave(i, j, k, axis) if 0 < at < cells[axis] else 0.0
                    place.append(round((at + move) / cells[axis] * size[axis], 6))
                nodes.append(tuple(place))
    elements, middle = [], {}
    for k in range(cells[2]):
        for j in range(cells[1]):
            for i in range(cells[0]):
                cell = [index(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                if kind == "PYRAMID13":
                    cell.append(len(nodes))
                    nodes.append(tuple(round(sum(nodes[n][axis] for n in cell[:8]) / 8, 6) for axis in range(3)))
                for part in SPLIT[kind]:
                    element = [cell[corner] for corner in part]
                    for a, b in MID_EDGES.get(kind, ()):
                        edge = tuple(sorted((element[a], element[b])))
                        if edge not in middle:
                            middle[edge] = len(nodes)
                            nodes.append(tuple(round(0.5 * (p + q), 6) for p, q in zip(nodes[edge[0]], nodes[edge[1]])))
                        element.append(middle[edge])
                    elements.append(element)
    return nodes, elements


def clamped(nodes):
    return [number + 1 for number, place in enumerate(nodes) if place[0] == 0.0]


def write_calculix(path, kind, nodes, elements, modes):
    with open(path, "w", encoding="ascii") as out:
        out.write("*NODE, NSET=ALL\n")
        for number, place in enumerate(nodes):
            out.write(f"{number + 1}, {place[0]:.6f}, {place[1]:.6f}, {place[2]:.6f}\n")
        out.write(f"*ELEMENT, TYPE={kind}, ELSET=BODY\n")
        for number, element in enumerate(elements):
            fields = [str(number + 1)] + [str(node + 1) for node in element]
            out.write(", ".join(fields[:11]) + (",\n" + ", ".join(fields[11:]) if len(fields) > 11 else "") + "\n")
        out.write(f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{YOUNG}, {POISSON}\n*DENSITY\n{DENSITY}\n")
        out.write("*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n*BOUNDARY\n")
        for node in clamped(nodes):
            out.write(f"{node}, 1, 3\n")
        out.write(f"*STEP\n*FREQUENCY\n{modes}\n*END STEP\n")


def real(value):
    """A number in at most eight characters, with a point."""
    return f"{value:.6f}".lstrip("0") if 0.0 < value < 1.0 else f"{value:.5f}"


def write_nastran(path, kind, nodes, elements, modes):
    with open(path, "w", encoding="ascii") as out:
        out.write("SOL 103\nCEND\nMETHOD = 1\nSPC = 1\nBEGIN BULK\n")
        out.write(f"PARAM,COUPMASS,1\nPARAM,AUTOSPC,YES\nEIGRL,1,,,{modes}\n")
        out.write(f"MAT1,1,2.1+11,,{POISSON},{DENSITY}\nPSOLID,1,1\n")
        for number, place in enumerate(nodes):
            out.write(f"GRID,{number + 1},,{real(place[0])},{real(place[1])},{real(place[2])}\n")
        for number, element in enumerate(elements):
            fields = [str(element[k] + 1) for k in NASTRAN_ORDER.get(kind, range(len(element)))]
            lines = [fields[:6]] + [fields[k:k + 8] for k in range(6, len(fields), 8)]
            out.write(f"{CARD[kind]},{number + 1},1," + ",+\n+,".join(",".join(line) for line in lines) + "\n")
        for node in clamped(nodes):
            out.write(f"SPC1,1,123,{node}\n")
        out.write("ENDDATA\n")


def compare(folder, arguments):
    print("| case | CalculiX element | cells | mode | reference Hz | CalculiX Hz | Mottle Hz | Mottle - CalculiX % "
          "| CalculiX - reference % | Mottle - reference % |")
    print("|---|---|---|---:|---:|---:|---:|---:|---:|---:|")
    for case, size, distortion, meshes, reference_cells in CASES:
        stem = case.replace(" ", "_")
        nodes, elements = make_mesh("C3D20R", reference_cells, size, 0.0)
        write_calculix(folder / f"{stem}_reference.inp", "C3D20R", nodes, elements, arguments.modes)
        reference = run_calculix(arguments.ccx, folder, f"{stem}_reference")
        for kind, cells in meshes:
            name = "_".join((stem, kind, *map(str, cells)))
            nodes, elements = make_mesh(kind, cells, size, distortion)
            write_calculix(folder / f"{name}.inp", kind, nodes, elements, arguments.modes)
            write_nastran(folder / f"{name}.bdf", kind, nodes, elements, arguments.modes)
            calculix = run_calculix(arguments.ccx, folder, name)
            mottle = run_mottle(arguments.mottle, folder / f"{name}.bdf")
            for mode, (exact, theirs, ours) in enumerate(zip(reference, calculix, mottle), 1):
                print(f"| {case} | {kind} | {' x '.join(map(str, cells))} | {mode} | {exact:.2f} | {theirs:.2f} "
                      f"| {ours:.2f} | {100 * (ours / theirs - 1):+.3f} | {100 * (theirs / exact - 1):+.2f} "
                      f"| {100 * (ours / exact - 1):+.2f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mottle", help="path of the mottle command")
    parser.add_argument("--ccx", default="ccx", help="path of CalculiX")
    parser.add_argument("--modes", type=int, default=8, help="number of modes to compare")
    run_in_folder(parser, compare)


if __name__ == "__main__":
    main()
