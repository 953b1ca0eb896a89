#!/usr/bin/env python3
"""Writes Nastran decks of three cantilevered families, for speed only. The same arguments give the same file.

    make_models.py shell 20000 5 OUT.bdf      cylindrical panel of CQUAD4, about 20,000 equations, 5 strips
    make_models.py solid 20000 10 OUT.bdf     block of CHEXA, length : width : height = 30 : 17 : 11, 5 x 2 patches
    make_models.py cube 100000 1 OUT.bdf      cube of CHEXA

Patch i has its own MAT1 and property, so that MAT1:i:E and MAT1:i:RHO are its parameters. Units: m, kg, N, s.
"""
import argparse
import math

PATCHES = {1: (1, 1), 5: (5, 1), 10: (5, 2), 18: (6, 3), 30: (6, 5)}  # along the span, across
PROPORTIONS = {"solid": (30, 17, 11), "cube": (1, 1, 1)}              # of elements and of edges alike
SHELL = {"length": 1.3, "radius": 1.0, "angle": math.radians(60.0), "thickness": 0.008}
LONGEST_EDGE = 1.0                                                    # of the solids
YOUNG, POISSON, DENSITY = 70.0e9, 0.33, 2700.0


def grid(number, x, y, z):
    return f"GRID*   {number:16d}{'':16}{x:16.8E}{y:16.8E}\n*       {z:16.8E}"


def element(card, number, patch, nodes):
    fields = [str(n) for n in (number, patch, *nodes)]
    return "\n".join(",".join(([card] if k == 0 else [""]) + fields[k:k + 8]) for k in range(0, len(fields), 8))


def patch_of(i, j, along, across, patches):
    """Number of the patch, from 1, of the element in row i along the span and j across it."""
    return 1 + i * patches[0] // along + patches[0] * (j * patches[1] // across)


def shell_elements(equations):
    return max(math.ceil((-1.0 + math.sqrt(1.0 + 4.0 * equations / 6.0)) / 2.0), 2)  # 6 n (n + 1) equations


def shell(equations, patches):
    n = shell_elements(equations)
    number = lambda i, j: 1 + i * (n + 1) + j  # noqa: E731
    for i in range(n + 1):
        for j in range(n + 1):
            angle = SHELL["angle"] * (j / n - 0.5)
            yield grid(number(i, j), SHELL["length"] * i / n, SHELL["radius"] * math.sin(angle),
                       SHELL["radius"] * math.cos(angle))
    for i in range(n):
        for j in range(n):
            corners = (number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1))
            yield element("CQUAD4", 1 + i * n + j, patch_of(i, j, n, n, patches), corners)
    for p in range(1, patches[0] * patches[1] + 1):
        yield f"PSHELL,{p},{p},{SHELL['thickness']},{p},,{p}"
    yield f"SPC1,1,123456,{number(0, 0)},THRU,{number(0, n)}"


def solid_elements(family, equations):
    """Elements along the edges: the whole numbers nearest to the proportions, 3 a (b + 1) (c + 1) equations."""
    proportions = PROPORTIONS[family]

    def counts(scale):
        return [max(round(scale * p / proportions[0]), 2) for p in proportions]

    def error(scale):
        a, b, c = counts(scale)
        return abs(3 * a * (b + 1) * (c + 1) - equations)
    return counts(min(range(2, 400), key=error))


def solid(family, equations, patches):
    a, b, c = solid_elements(family, equations)
    number = lambda i, j, k: 1 + (i * (b + 1) + j) * (c + 1) + k  # noqa: E731
    edges = [LONGEST_EDGE * p / PROPORTIONS[family][0] for p in PROPORTIONS[family]]
    for i in range(a + 1):
        for j in range(b + 1):
            for k in range(c + 1):
                yield grid(number(i, j, k), edges[0] * i / a, edges[1] * j / b, edges[2] * k / c)
    for i in range(a):
        for j in range(b):
            for k in range(c):
                nodes = [number(i + di, j + dj, k + dk)
                         for dk in (0, 1) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))]
                yield element("CHEXA", 1 + (i * b + j) * c + k, patch_of(i, j, a, b, patches), nodes)
    for p in range(1, patches[0] * patches[1] + 1):
        yield f"PSOLID,{p},{p}"
    yield f"SPC1,1,123,1,THRU,{number(0, b, c)}"


def write_model(family, equations, patch_count, file):
    patches = PATCHES[patch_count]
    cards = shell(equations, patches) if family == "shell" else solid(family, equations, patches)
    with open(file, "w", encoding="ascii") as deck:
        deck.write("SOL 103\nCEND\nSPC = 1\nBEGIN BULK\n")
        for card in cards:
            deck.write(card + "\n")
        for p in range(1, patch_count + 1):
            deck.write(f"MAT1,{p},{YOUNG:.1E},,{POISSON},{DENSITY}\n")
        deck.write("ENDDATA\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("family", choices=["shell", "solid", "cube"])
    parser.add_argument("equations", type=int, help="about so many free degrees of freedom")
    parser.add_argument("patches", type=int, choices=sorted(PATCHES))
    parser.add_argument("file")
    arguments = parser.parse_args()
    write_model(arguments.family, arguments.equations, arguments.patches, arguments.file)


if __name__ == "__main__":
    main()
