"""What the laboratory hands over: tables with gaps, and universal files."""
import numpy as np


def table(columns, specimens):
    """A CSV with one row for each specimen [specimen x column]; nan: not measured."""
    rows = [",".join("" if np.isnan(value) else f"{value:.9g}" for value in row) for row in specimens]
    return "\n".join([",".join(columns), *rows]) + "\n"


def dataset(number, lines):
    return ["    -1", f"{number:6d}", *lines, "    -1"]


def integers(*numbers):
    return "".join(f"{number:10d}" for number in numbers)


def reals(*numbers):
    return "".join(f"{number:13.5e}" for number in numbers)


def universal_file(frequencies, shapes, dofs):
    """Normal modes of one specimen, ascending, of unit modal mass; shapes [dof x mode]; a mode without a frequency was not found."""
    lines = []
    order = [k for k in np.argsort(frequencies) if not np.isnan(frequencies[k])]
    for number, mode in enumerate(order, 1):
        vectors = {}
        for dof, value in zip(dofs, shapes[:, mode]):
            node, axis = dof.split(":")
            vectors.setdefault(int(node), [0.0, 0.0, 0.0])["XYZ".index(axis[1])] = value
        head = ["Normal modes", "NONE", "NONE", "NONE", "NONE", integers(1, 2, 2, 8, 2, 3), integers(2, 4, 0, number),
                reals(frequencies[mode], 1.0, 0.01, 0.0)]
        lines += dataset(55, head + [line for node, vector in sorted(vectors.items()) for line in (integers(node), reals(*vector))])
    return "\n".join(lines) + "\n"
