#!/usr/bin/env python3
"""Writes plate.inp: two aluminium sheets, bolted along a lap joint, on four brackets. Standard library only.

    python3 make_deck.py
"""
import os

HERE = os.path.dirname(os.path.abspath(__file__))

X = [0.0, 0.035, 0.07, 0.105, 0.145, 0.19, 0.21, 0.25, 0.29, 0.33, 0.365, 0.40]
Y = [0.0, 0.025, 0.055, 0.0855, 0.12, 0.153, 0.18]  # not symmetric: no two modes share a frequency
LAP = 5                                      # the column of elements between 0.19 and 0.21 m
MOUNTS = [(1, 1), (10, 1), (1, 5), (10, 5)]   # corners of elements


def coordinate(grid, half):
    left = grid[half // 2]
    return left if half % 2 == 0 else 0.5 * (left + grid[half // 2 + 1])


def node(i, j):
    """Number of the node at half steps i, j of the grid: 1001 is at the origin, 100 nodes a column at most."""
    return 1001 + 100 * i + j


def main():
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    used, sets = set(), {"SHEETS": [], "JOINT": []}
    for a in range(len(X) - 1):
        for b in range(len(Y) - 1):
            nodes = [(2 * a + i, 2 * b + j) for i, j in corners]
            used.update(nodes)
            sets["JOINT" if a == LAP else "SHEETS"].append([node(i, j) for i, j in nodes])
    lines = ["** Two aluminium sheets, bolted along a lap joint, on four brackets. Written by make_deck.py.", "*NODE"]
    for i, j in sorted(used):
        lines.append(f"{node(i, j)}, {coordinate(X, i):.6g}, {coordinate(Y, j):.6g}, 0")
    element = 0
    for name, elements in sets.items():
        lines.append(f"*ELEMENT, TYPE=S8R, ELSET={name}")
        for nodes in elements:
            element += 1
            lines.append(", ".join(map(str, [element, *nodes])))
    for direction in (1, 2, 3):
        lines.append(f"*ELEMENT, TYPE=SPRING1, ELSET=MOUNTS{direction}")
        for i, j in MOUNTS:
            element += 1
            lines.append(f"{element}, {node(2 * i, 2 * j)}")
    lines += ["*MATERIAL, NAME=ALUMINIUM", "*ELASTIC", "70e9, 0.33", "*DENSITY", "2700",
              "*MATERIAL, NAME=LAP", "*ELASTIC", "25e9, 0.33", "*DENSITY", "2700",
              "*SHELL SECTION, ELSET=SHEETS, MATERIAL=ALUMINIUM", "0.006",
              "*SHELL SECTION, ELSET=JOINT, MATERIAL=LAP", "0.006"]
    for direction, stiffness in ((1, 2e6), (2, 1.5e6), (3, 8e5)):
        lines += [f"*SPRING, ELSET=MOUNTS{direction}", f"{direction}", f"{stiffness:.1f}"]  # a real has its point, or CalculiX takes it for a direction
    lines += ["*STEP", "*FREQUENCY", "16", "*NODE FILE, OUTPUT=2D", "U", "*END STEP", ""]
    with open(os.path.join(HERE, "plate.inp"), "w") as file:
        file.write("\n".join(lines))


if __name__ == "__main__":
    main()
