#!/usr/bin/env python3
"""Writes specimens.csv and shapes-test.csv: what `mottle simulate` drew, as a test campaign would hand it over.

    mottle simulate truth.toml
    mottle simulate truth-shapes.toml
    python3 make_specimens.py

specimens.csv: numbers are rounded to what a modal analysis gives, and what was not found is left empty.
shapes-test.csv: all shapes of one specimen, a row a sensor, with noise and a scale and sign of the test's own.
Standard library only.
"""
import csv
import os
import random

HERE = os.path.dirname(os.path.abspath(__file__))

# Specimen (from 1) -> what is missing: a mode with its frequency and shape, or a sensor with all its components.
NOT_FOUND = {
    3: ["mode 16"],               # the tailplane's yaw was not excited
    4: ["mode 9"],                # the two wing torsions were taken for one
    7: ["mode 16"],
    11: ["mode 9"],
    15: ["mode 16", "mode 13"],
    18: ["sensor 303"],           # cable broken
}


def belongs(column, missing):
    kind, number = missing.split()
    if kind == "sensor":
        return f":{number}:" in column
    return column == f"f{number}" or column.startswith(f"phi{number}:")


def read(*path):
    with open(os.path.join(HERE, *path), newline="") as file:
        header, *rows = csv.reader(file)
    return header, rows


def write(name, rows):
    with open(os.path.join(HERE, name), "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def write_specimens():
    header, rows = read("truth.mottle", "specimens.csv")
    for specimen, row in enumerate(rows, 1):
        for k, column in enumerate(header):
            row[k] = f"{float(row[k]):.3f}" if column.startswith("f") else f"{float(row[k]):.4f}"
            if any(belongs(column, missing) for missing in NOT_FOUND.get(specimen, [])):
                row[k] = ""
    write("specimens.csv", [header, *rows])


def write_shapes():
    header, rows = read("truth-shapes.mottle", "specimens.csv")
    values = dict(zip(header, map(float, rows[0])))
    shapes = {}  # mode -> dof -> value
    for column, value in values.items():
        if column.startswith("phi"):
            mode, dof = column[3:].split(":", 1)
            shapes.setdefault(mode, {})[dof] = value
    noise = random.Random(1997)
    columns = []
    for mode in sorted(shapes, key=lambda number: values[f"f{number}"]):
        shape = shapes[mode]
        largest = max(map(abs, shape.values())) * noise.choice((-1.0, 1.0))
        columns.append((f"{values[f'f{mode}']:.2f} Hz", {dof: v / largest + noise.gauss(0.0, 0.02)
                                                        for dof, v in shape.items()}))
    dofs = list(next(iter(shapes.values())))
    write("shapes-test.csv", [["dof", *(name for name, _ in columns)],
                              *([dof, *(f"{shape[dof]:.3f}" for _, shape in columns)] for dof in dofs)])


if __name__ == "__main__":
    write_specimens()
    write_shapes()
