"""Structures whose modes NumPy computes: masses and springs, and a beam given as matrices or as a function behind HTTP.

A structure has files and a [model]; `modes` gives what is measured of specimens whose numbers differ by factors {target: [specimen]}.
"""
import dataclasses
import functools

import numpy as np

from functions import address_of


def match(reference, shapes):
    """Column of `shapes` [dof x mode] for each column of the reference, the best pairs of all first."""
    mac = (reference.T @ shapes) ** 2 / np.outer((reference ** 2).sum(axis=0), (shapes ** 2).sum(axis=0))
    found = np.zeros(reference.shape[1], int)
    for _ in found:
        i, j = np.unravel_index(np.argmax(mac), mac.shape)
        found[i] = j
        mac[i, :] = -1.0
        mac[:, j] = -1.0
    return found


class MatrixStructure:
    """Modes of K(x), M(x), mass-normalised, by rank or with the numbers and signs of the nominal structure's."""

    def matrices(self, factors):
        """K and M [degree of freedom x degree of freedom] with numbers changed by factors {target: factor}."""
        raise NotImplementedError

    def names(self):
        """Of the degrees of freedom."""
        raise NotImplementedError

    def all_modes(self, factors):
        """All frequencies in Hz, ascending, and mass-normalised shapes."""
        stiffness, mass = self.matrices(factors)
        lower = np.linalg.inv(np.linalg.cholesky(mass))
        values, vectors = np.linalg.eigh(lower @ stiffness @ lower.T)
        return np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi), lower.T @ vectors

    def modes(self, truth, count, numbers, dofs, is_by_rank, **_):
        """Frequencies [specimen x mode] and shapes [specimen x dof x mode]."""
        reference = self.all_modes({})[1]
        rows = [self.names().index(dof) for dof in dofs]
        wanted = np.array(numbers) - 1
        frequencies, shapes = [], []
        for k in range(count):
            values, vectors = self.all_modes({target: float(factor[k]) for target, factor in truth.items()})
            chosen = wanted if is_by_rank else match(reference[:, wanted], vectors)
            sign = np.sign((reference[:, wanted] * vectors[:, chosen]).sum(axis=0))
            frequencies.append(values[chosen])
            shapes.append((vectors[:, chosen] * sign)[rows])
        return np.array(frequencies), np.array(shapes)


@dataclasses.dataclass
class Springs(MatrixStructure):
    """Masses and springs {name: (end, end, stiffness)}, -1: ground; springs in `left_out` have no stiffness in the study."""
    masses: list
    springs: dict
    left_out: tuple = ()

    def matrices(self, factors):
        mass = np.diag([m * factors.get(f"mass:m{k}", 1.0) for k, m in enumerate(self.masses)])
        stiffness = np.zeros_like(mass)
        for name, (i, j, value) in self.springs.items():
            ends = np.array([float(k == i) - float(k == j) for k in range(len(self.masses))])
            stiffness += value * factors.get(f"spring:{name}", 1.0) * np.outer(ends, ends)
        return stiffness, mass

    def names(self):
        return [f"m{k}" for k in range(len(self.masses))]

    def files(self):
        return {}

    def toml(self):
        def end(k):
            return "ground" if k < 0 else f"m{k}"
        rows = [f'  {{ name = "{name}", between = ["{end(i)}", "{end(j)}"], stiffness = {0.0 if name in self.left_out else value!r} }},'
                for name, (i, j, value) in self.springs.items()]
        masses = ", ".join(f"m{k} = {m!r}" for k, m in enumerate(self.masses))
        return "\n".join(['[model]', 'kind = "mass-spring"', f"masses = {{ {masses} }}", "springs = [", *rows, "]"])


@dataclasses.dataclass
class Beam(MatrixStructure):
    """A steel cantilever of 1 m in parts of unequal stiffness, on a soft root, with a spring and a mass at its tip."""
    parts: int = 3
    elements: int = 12

    @functools.cached_property
    def terms(self):
        """Stiffness and mass matrices by name; displacement and rotation of each node but the root's displacement."""
        size = 2 * (self.elements + 1)
        found = {f"part{k}": [np.zeros((size, size)), np.zeros((size, size))] for k in range(self.parts)}
        length = 1.0 / self.elements
        bending = 2.1e11 * 0.04 * 0.008 ** 3 / 12 / length ** 3 * np.array(
            [[12, 6 * length, -12, 6 * length], [6 * length, 4 * length ** 2, -6 * length, 2 * length ** 2],
             [-12, -6 * length, 12, -6 * length], [6 * length, 2 * length ** 2, -6 * length, 4 * length ** 2]])
        inertia = 7850 * 0.04 * 0.008 * length / 420 * np.array(
            [[156, 22 * length, 54, -13 * length], [22 * length, 4 * length ** 2, 13 * length, -3 * length ** 2],
             [54, 13 * length, 156, -22 * length], [-13 * length, -3 * length ** 2, -22 * length, 4 * length ** 2]])
        for e in range(self.elements):
            part = found[f"part{e * self.parts // self.elements}"]
            part[0][2 * e:2 * e + 4, 2 * e:2 * e + 4] += bending
            part[1][2 * e:2 * e + 4, 2 * e:2 * e + 4] += inertia
        for name, row, stiffness, mass in (("root", 1, 2.0e3, 0.0), ("tip", size - 2, 2.0e3, 0.0), ("load", size - 2, 0.0, 0.4)):
            found[name] = [np.zeros((size, size)), np.zeros((size, size))]
            found[name][0][row, row], found[name][1][row, row] = stiffness, mass
        return {name: [matrix[1:, 1:] for matrix in pair] for name, pair in found.items()}

    def matrices(self, factors):
        stiffness, mass = 0.0, 0.0
        for name, (k, m) in self.terms.items():
            stiffness = stiffness + factors.get(f"K:{name}", 1.0) * k
            mass = mass + factors.get(f"M:{name}", 1.0) * m
        return stiffness, mass

    def names(self):
        return [f"{1 + row // 2}:+{'RY' if row % 2 else 'Z'}" for row in range(1, 2 * (self.elements + 1))]

    def files(self):
        texts = {"names.dof": "\n".join(self.names()) + "\n"}
        for name, pair in self.terms.items():
            for letter, matrix in zip("KM", pair):
                if matrix.any():
                    entries = [f"{i + 1} {j + 1} {matrix[i, j]!r}" for i, j in zip(*np.nonzero(np.tril(matrix)))]
                    texts[f"{letter}_{name}.mtx"] = "\n".join(["%%MatrixMarket matrix coordinate real symmetric",
                                                               f"{len(matrix)} {len(matrix)} {len(entries)}", *entries]) + "\n"
        return texts

    def toml(self):
        rows = []
        for name, (k, m) in self.terms.items():
            files = [f'{key} = "{letter}_{name}.mtx"' for key, letter, matrix in (("stiffness", "K", k), ("mass", "M", m)) if matrix.any()]
            rows.append(f'  {{ name = "{name}", {", ".join(files)}, nominal = 1.0 }},')
        return "\n".join(['[model]', 'kind = "matrices"', 'degrees_of_freedom = "names.dof"', "terms = [", *rows, "]"])


@dataclasses.dataclass
class Function(MatrixStructure):
    """A beam behind an UM-Bridge server: frequencies as a function of factors on its targets."""
    inputs: dict  # name: list of targets
    outputs: int
    unit: float = 1.0  # of what the server says, in Hz
    beam: Beam = dataclasses.field(default_factory=Beam)

    def matrices(self, factors):
        return self.beam.matrices(factors)

    def names(self):
        return self.beam.names()

    def files(self):
        return {}

    def value(self, numbers):
        """What the server answers."""
        factors = {target: number for targets, number in zip(self.inputs.values(), numbers) for target in targets}
        return list(self.beam.all_modes(factors)[0][:self.outputs] * self.unit)

    def toml(self):
        return "\n".join(['[model]', 'kind = "umbridge"', f'urls = ["{address_of(self)}"]'])
