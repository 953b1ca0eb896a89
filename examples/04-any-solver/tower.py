#!/usr/bin/env python3
"""Modes of a shear tower, as any solver would give them: reads a text file, prints a table, writes a file of shapes.

    python3 tower.py tower.inp        ->  tower.out, shapes.csv

Plain Python without packages: Jacobi's rotations on M^-1/2 K M^-1/2.
"""

import math
import sys


def read_input(file):
    """Masses from the ground up, stiffnesses of the storeys below them, how many modes."""
    data = {}
    with open(file, encoding="utf-8") as lines:
        for line in lines:
            words = line.split("#")[0].split()
            if words:
                data[words[0]] = [float(word) for word in words[1:]]
    return data["masses"], data["storeys"], int(data["modes"][0])


def scaled_stiffness(masses, storeys):
    """M^-1/2 K M^-1/2 of masses in a row."""
    n = len(masses)
    a = [[0.0] * n for _ in range(n)]
    for i in range(n):
        above = storeys[i + 1] if i + 1 < n else 0.0
        a[i][i] = (storeys[i] + above) / masses[i]
        if i + 1 < n:
            a[i][i + 1] = a[i + 1][i] = -above / math.sqrt(masses[i] * masses[i + 1])
    return a


def eigen(a):
    """Eigenvalues, ascending, and eigenvectors of a symmetric matrix."""
    n = len(a)
    v = [[float(i == j) for j in range(n)] for i in range(n)]
    for _ in range(50):
        for p in range(n):
            for q in range(p + 1, n):
                if a[p][q] == 0.0:
                    continue
                theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q])
                t = math.copysign(1.0, theta) / (abs(theta) + math.hypot(theta, 1.0))
                c = 1.0 / math.hypot(t, 1.0)
                s = t * c
                for row in a:
                    row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
                a[p], a[q] = ([c * x - s * y for x, y in zip(a[p], a[q])], [s * x + c * y for x, y in zip(a[p], a[q])])
                for row in v:
                    row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
    order = sorted(range(n), key=lambda i: a[i][i])
    return [a[i][i] for i in order], [[v[k][i] for k in range(n)] for i in order]


def main():
    masses, storeys, count = read_input(sys.argv[1])
    values, vectors = eigen(scaled_stiffness(masses, storeys))
    with open("tower.out", "w", encoding="utf-8") as out:
        out.write("TOWER: NATURAL FREQUENCIES\n\n  MODE        RAD/S           HZ\n")
        for i in range(count):
            omega = math.sqrt(values[i])
            out.write(f"{i + 1:6d} {omega:15.8e} {omega / (2.0 * math.pi):15.8e}\n")
    with open("shapes.csv", "w", encoding="utf-8") as out:
        out.write("floor," + ",".join(f"mode{i + 1}" for i in range(count)) + "\n")
        for floor, mass in enumerate(masses):
            row = (f"{vectors[i][floor] / math.sqrt(mass):.9e}" for i in range(count))
            out.write(f"{floor + 1}:+X," + ",".join(row) + "\n")


if __name__ == "__main__":
    main()
