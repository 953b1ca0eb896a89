#!/usr/bin/env python3
"""Writes the reference files of matrix_file_test: one 6 x 6 matrix in every format, and what CalculiX makes of a bar.

    /usr/bin/python3 make_references.py          # needs SciPy, Octave and ccx

By other programs: *.mtx and scipy.rua (SciPy), octave.h5 (Octave), bar.sti, bar.mas, bar.dof, bar.dat, bar.frd (CalculiX).
From the published layout, by this script: Abaqus (Abaqus 2016 documentation, "Generating structural matrices"), DMIG and
OUTPUT4 (MSC Nastran 2014 Quick Reference Guide; DMAP guide, OUTPUT4), Harwell-Boeing RSA (Duff, Grimes, Lewis 1992).
"""
import os
import struct
import subprocess

import numpy as np
import scipy.io
import scipy.sparse

os.chdir(os.path.dirname(os.path.abspath(__file__)))
N = 6
NAMES = [(node, component) for node in (101, 102, 103) for component in (1, 3)]


def entry(i, j):
    """1-based; two diagonals beside the main one."""
    return 10.0 + i if i == j else np.cos(i * j + 1.0) if abs(i - j) <= 2 else 0.0


A = np.array([[entry(i + 1, j + 1) for j in range(N)] for i in range(N)])
LOWER = [(i, j) for j in range(N) for i in range(j, N) if A[i, j] != 0.0]


def in_lines(texts, count):
    return ["".join(texts[a:a + count]) for a in range(0, len(texts), count)]


def write_lines(name, lines):
    with open(name, "w") as file:
        file.write("\n".join(lines) + "\n")


def scipy_files():
    scipy.io.mmwrite("symmetric.mtx", scipy.sparse.csc_matrix(A), symmetry="symmetric", precision=17)
    scipy.io.mmwrite("general.mtx", scipy.sparse.csc_matrix(A), symmetry="general", precision=17)
    scipy.io.mmwrite("array.mtx", A, symmetry="symmetric", precision=17)
    scipy.io.hb_write("scipy.rua", scipy.sparse.csc_matrix(A))


def harwell_boeing():
    pointers, count = [1], 0
    for j in range(N):
        count += sum(1 for _, column in LOWER if column == j)
        pointers.append(count + 1)
    lines = [f"{'stiffness':<72}{'KEY':<8}", "".join(f"{k:14d}" for k in (9, 1, 2, 6, 0)),
             f"{'RSA':<14}" + "".join(f"{k:14d}" for k in (N, N, count, 0)),
             f"{'(10I8)':<16}{'(10I8)':<16}{'(3D25.16)':<20}{'':<20}"]
    for row in (pointers, [i + 1 for i, _ in LOWER]):
        lines += in_lines([f"{k:8d}" for k in row], 10)
    lines += in_lines([f"{A[i, j]:25.16E}".replace("E", "D") for i, j in LOWER], 3)
    write_lines("layout.rsa", lines)
    write_lines("layout.mapping", ["   Matrix Eqn        Node         DOF"] + [
        f"{k:12d} {node:12d}          U{'XYZ'[component - 1]}" for k, (node, component) in enumerate(NAMES, 1)])


def abaqus():
    write_lines("input_STIF1.mtx", ["**", "** node, degree of freedom, node, degree of freedom, value", "**"] + [
        "%d,%d, %d,%d, %21.15e" % (*NAMES[i], *NAMES[j], A[i, j]) for i, j in LOWER])
    entries = [(i, j, A[i, j]) for i in range(N) for j in range(N) if A[i, j] != 0.0]
    write_lines("coordinate_STIF1.mtx", [
        f"{i + 1:6d} {j + 1:6d} {value:24.15e}" for i, j, value in entries + [(N, N, 1e36)]])  # a fixed one


def dmig():
    lines = ["$TITLE = BAR", "DMIG    KAAX           0       6       2       0"]
    for j in range(N):
        lines.append(f"DMIG*   {'KAAX':<16}{NAMES[j][0]:16d}{NAMES[j][1]:16d}")
        lines += [f"*       {NAMES[i][0]:16d}{NAMES[i][1]:16d}{A[i, j]:16.9E}".replace("E", "D")
                  for i in range(j, N) if A[i, j] != 0.0]
    lines.append("DMIG    MAAX           0       1       1       0")
    lines += [f"DMIG    {'MAAX':<8}{NAMES[j][0]:8d}{NAMES[j][1]:8d}{'':8}{NAMES[i][0]:8d}{NAMES[i][1]:8d}{A[i, j]:8.5f}"
              for j in range(N) for i in range(N) if A[i, j] != 0.0]
    write_lines("punch.pch", lines)


def strings(j):
    """The run of entries of a column: (first row from 1, values)."""
    rows = [i for i in range(N) if A[i, j] != 0.0]
    return rows[0] + 1, [A[i, j] for i in rows]


def output4_text(name, kind):
    def values_in_lines(values):
        return in_lines([f"{v:23.16E}" for v in values], 3)

    lines = [f"{N:8d}{-N if kind == 'big' else N:8d}{6:8d}{2:8d}{'KAA':<8}1P,3E23.16"]
    for j in range(N):
        row, values = strings(j)
        words = 2 * len(values) + 1
        if kind == "dense":
            lines += [f"{j + 1:8d}{1:8d}{N:8d}", *values_in_lines(list(A[:, j]))]
        elif kind == "big":
            lines += [f"{j + 1:8d}{0:8d}{words + 1:8d}", f"{words:8d}{row:8d}", *values_in_lines(values)]
        else:
            lines += [f"{j + 1:8d}{0:8d}{words:8d}", f"{row + 65536 * words:8d}", *values_in_lines(values)]
    write_lines(name, lines + [f"{N + 1:8d}{1:8d}{1:8d}", f"{1.0:23.16E}"])


def output4_binary(name, kind, order, matrices=("KAA",)):
    def record(body):
        return struct.pack(order + "i", len(body)) + body + struct.pack(order + "i", len(body))

    with open(name, "wb") as file:
        for scale, matrix in enumerate(matrices, 1):
            size = -N if kind == "big" else N
            file.write(record(struct.pack(order + "4i8s", N, size, 6, 2, matrix.ljust(8).encode())))
            for j in range(N):
                row, values = strings(j)
                words = 2 * len(values) + 1
                head = struct.pack(order + "2i", words, row) if kind == "big" else struct.pack(
                    order + "i", row + 65536 * words)
                body = head + struct.pack(f"{order}{len(values)}d", *(scale * v for v in values))
                if kind == "dense":
                    file.write(record(struct.pack(f"{order}3i{N}d", j + 1, 1, 2 * N, *(scale * A[:, j]))))
                else:
                    file.write(record(struct.pack(order + "3i", j + 1, 0, len(body) // 4) + body))
            file.write(record(struct.pack(order + "3id", N + 1, 1, 2, 1.0)))


def hdf5():
    np.savetxt("a.txt", A, fmt="%.17g")
    subprocess.run(["octave", "--quiet", "--no-gui", "--eval", "A = load('a.txt'); save('-hdf5', 'octave.h5', 'A');"],
                   check=True)
    os.remove("a.txt")


NODES = [(x, y, z) for x in range(4) for y in (0.0, 0.1) for z in (0.0, 0.15)]
BAR = "\n".join(["*NODE", *(f"{k}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(NODES, 1)),
                 "*ELEMENT, TYPE=C3D8, ELSET=BAR",
                 *(f"{a + 1}, " + ", ".join(str(4 * a + k) for k in (1, 5, 7, 3, 2, 6, 8, 4)) for a in range(3)),
                 "*MATERIAL, NAME=STEEL", "*ELASTIC", "2.1e11, 0.3", "*DENSITY", "7800.",
                 "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL",
                 "*BOUNDARY", *(f"{node}, 1, 3" for node in range(1, 5)),
                 "*STEP", "*FREQUENCY%s", "*NODE FILE", "U", "*END STEP"])


def calculix():
    for option in (", SOLVER=MATRIXSTORAGE", "\n5"):
        write_lines("bar.inp", [BAR % option])
        subprocess.run(["ccx", "bar"], check=True, stdout=subprocess.DEVNULL)
    for name in ("bar.12d", "bar.cvg", "bar.sta", "bar.inp", "ResultsForLastIterations.frd", "spooles.out"):
        if os.path.exists(name):
            os.remove(name)


scipy_files()
harwell_boeing()
abaqus()
dmig()
for shape in ("dense", "strings", "big"):
    output4_text(f"text_{shape}.op4", shape)
    output4_binary(f"little_{shape}.op4", shape, "<")
output4_binary("big_endian.op4", "strings", ">", ("KAA", "MAA"))
hdf5()
calculix()
