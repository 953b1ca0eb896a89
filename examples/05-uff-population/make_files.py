#!/usr/bin/env python3
"""Writes specimens/*.uff from what `mottle simulate` drew, as ten test campaigns would hand them over.

    mottle simulate truth.toml
    python3 make_files.py

Every campaign has habits of its own; HABITS says which. Standard library only.
"""
import cmath
import csv
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
DECK = os.path.join(HERE, "..", "02-airframe", "airframe.bdf")

# Specimen -> what is special about its file.
HABITS = {
    3: {"not_found": 9},                          # the two wing torsions were taken for one
    4: {"complex": True},                         # poles and complex shapes, as most analysers write them
    5: {"order": "by_excitation", "flip": True},  # other order, upside down
    6: {"no_mass": True},                         # shapes of unit size, modal mass unknown
    7: {"millimetres": True, "mounted": True},    # t, mm, s; two accelerometers mounted askew
    8: {"dataset": 2414},
    9: {"crlf": True, "exponent": "D"},
}
# Node -> its own system: turned about the y axis by so many degrees.
MOUNTED = {11: 30.0, 111: 180.0}


def read_specimens():
    with open(os.path.join(HERE, "truth.mottle", "specimens.csv"), newline="", encoding="utf-8") as file:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


def positions(nodes):
    found = {}
    with open(DECK, encoding="ascii") as deck:
        for line in deck:
            if line.startswith("GRID") and int(line[8:16]) in nodes:
                found[int(line[8:16])] = [float(line[k:k + 8]) for k in (24, 32, 40)]
    return found


def shape_of(values, mode):
    """Node -> [x, y, z]; what was not measured is 0."""
    shape = {}
    for name, value in values.items():
        if name.startswith(f"phi{mode}:"):
            _, node, axis = name.split(":")
            shape.setdefault(int(node), [0.0, 0.0, 0.0])["XYZ".index(axis[1])] = value
    return shape


def as_mounted(node, vector):
    turn = math.radians(MOUNTED.get(node, 0.0))
    x, y, z = vector
    return [x * math.cos(turn) - z * math.sin(turn), y, x * math.sin(turn) + z * math.cos(turn)]


def dataset(number, lines):
    return ["    -1", f"{number:6d}", *lines, "    -1"]


def integers(*numbers):
    return "".join(f"{number:10d}" for number in numbers)


def reals(*numbers):
    return "".join(f"{number:13.5e}" for number in numbers)


def doubles(*numbers):
    return "".join(f"{number:25.16e}" for number in numbers).replace("e", "D")


def units(length):
    return dataset(164, [f"{5:10d}{'mm (milli-newton)':<20}{2:10d}" if length != 1.0 else f"{1:10d}{'SI: Metre (newton)':<20}{2:10d}",
                         doubles(length, 1.0, 1.0), doubles(273.15)])


def geometry(nodes, length, mounted):
    lines = []
    if mounted:
        systems = [integers(1), "airframe"]
        for label, degrees in MOUNTED.items():
            turn = math.radians(degrees)
            systems += [integers(label, 0, 8), f"accelerometer {label}",
                        doubles(math.cos(turn), 0.0, -math.sin(turn)), doubles(0.0, 1.0, 0.0),
                        doubles(math.sin(turn), 0.0, math.cos(turn)), doubles(0.0, 0.0, 0.0)]
        lines += dataset(2420, systems)
    places = []
    for node, place in sorted(positions(nodes).items()):
        places += [integers(node, 0, node if mounted and node in MOUNTED else 0, 11),
                   doubles(*(length * coordinate for coordinate in place))]
    return lines + dataset(2411, places)


def mode_lines(number, frequency, shape, habits, mass):
    titles = ["Airframe ground vibration test", "", "", "", f"mode {number}"]
    is_complex = habits.get("complex", False)
    if is_complex:
        zeta, phase = 0.008, 0.4
        speed = 2 * math.pi * frequency
        pole = speed * complex(-zeta, math.sqrt(1 - zeta * zeta))
        # The shape turns by a common phase and each node by a little of its own.
        shape = {node: [v * cmath.exp(1j * (phase + 0.03 * math.sin(node))) for v in vector] for node, vector in shape.items()}
        modal_a = 2j * pole.imag * mass * cmath.exp(2j * phase)
    if habits.get("dataset") == 2414:
        head = [integers(number), f"mode {number}", integers(1), *titles, integers(1, 2, 2, 8, 2, 3),
                integers(0, 0, 0, 0, 0, number, 0, 0), integers(0, 0), reals(0.0, frequency, 0.0, mass, 0.01, 0.0),
                reals(*[0.0] * 6)]
    elif is_complex:
        head = [*titles, integers(1, 3, 2, 8, 5, 3), integers(2, 6, 0, number),
                reals(pole.real, pole.imag, modal_a.real, modal_a.imag, 0.0, 0.0)]
    else:
        head = [*titles, integers(1, 2, 2, 8, 2, 3), integers(2, 4, 0, number), reals(frequency, mass, 0.01, 0.0)]
    lines = head
    for node, vector in sorted(shape.items()):
        numbers = [part for v in vector for part in ((v.real, v.imag) if is_complex else (v,))]
        lines += [integers(node), reals(*numbers)]
    return dataset(2414 if habits.get("dataset") == 2414 else 55, lines)


def write_specimen(specimen, values):
    habits = HABITS.get(specimen, {})
    length = 1000.0 if habits.get("millimetres") else 1.0
    mounted = habits.get("mounted", False)
    modes = [int(name[1:]) for name in values if name.startswith("f")]
    modes = [mode for mode in sorted(modes, key=lambda mode: values[f"f{mode}"]) if mode != habits.get("not_found")]
    if habits.get("order"):
        modes = modes[1::2] + modes[::2]
    nodes = set(shape_of(values, modes[0]))
    lines = dataset(151, ["airframe", "Ground vibration test", "make_files.py", "", "", "make_files.py", ""])
    lines += units(length) + geometry(nodes, length, mounted)
    for number, mode in enumerate(modes, 1):
        shape = shape_of(values, mode)
        # As analysers do: the largest component is 1, and the modal mass says how large the mode is.
        largest = max(abs(v) for vector in shape.values() for v in vector) * (-1.0 if habits.get("flip") else 1.0)
        shape = {node: [v / largest for v in vector] for node, vector in shape.items()}
        if mounted:
            shape = {node: as_mounted(node, vector) for node, vector in shape.items()}
        # A mass is force s^2 / length: in t where lengths are in mm.
        mass = 0.0 if habits.get("no_mass") else 1.0 / largest ** 2 / length
        lines += mode_lines(number, values[f"f{mode}"], shape, habits, mass)
    text = "\n".join(lines) + "\n"
    if habits.get("exponent"):
        text = text.replace("e+", "D+").replace("e-", "D-")
    name = os.path.join(HERE, "specimens", f"aeroplane-{specimen:02d}.uff")
    with open(name, "w", encoding="ascii", newline="\r\n" if habits.get("crlf") else "\n") as file:
        file.write(text)


def main():
    os.makedirs(os.path.join(HERE, "specimens"), exist_ok=True)
    for specimen, values in enumerate(read_specimens(), 1):
        write_specimen(specimen, values)


if __name__ == "__main__":
    main()
