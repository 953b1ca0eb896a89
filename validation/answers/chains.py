"""Chains of masses and springs in parts that look alike: what a study says of them, and their frequencies by NumPy."""
import dataclasses

import numpy as np


@dataclasses.dataclass
class Chain:
    """Springs of 1 N/m in parts, one parameter each (their common factor); weaker springs that no parameter moves."""
    masses: list
    parts: list  # of lists of (end, end), -1: ground
    fixed: list  # of (end, end, stiffness)

    def matrix(self, factors):
        """Stiffness matrix [mass x mass]."""
        k = np.zeros((len(self.masses), len(self.masses)))
        springs = list(self.fixed)
        for factor, part in zip(factors, self.parts):
            springs += [(i, j, factor) for i, j in part]
        for i, j, stiffness in springs:
            for end in (i, j):
                if end >= 0:
                    k[end, end] += stiffness
            if i >= 0 and j >= 0:
                k[i, j] -= stiffness
                k[j, i] -= stiffness
        return k

    def modes(self, factors):
        """Frequencies in Hz, and shapes of unit length [mass x mode]."""
        root = 1.0 / np.sqrt(np.asarray(self.masses, float))
        values, vectors = np.linalg.eigh(root[:, None] * self.matrix(factors) * root)
        shapes = root[:, None] * vectors
        return np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi), shapes / np.linalg.norm(shapes, axis=0)

    def toml(self):
        """The study's [model]."""
        def end(i):
            return "ground" if i < 0 else f"m{i}"
        springs = [(f"c{k}", i, j, s) for k, (i, j, s) in enumerate(self.fixed)]
        springs += [(f"p{a}_{b}", i, j, 1.0) for a, part in enumerate(self.parts) for b, (i, j) in enumerate(part)]
        rows = [f'  {{ name = "{name}", between = ["{end(i)}", "{end(j)}"], stiffness = {s!r} }},' for name, i, j, s in springs]
        masses = ", ".join(f"m{i} = {m!r}" for i, m in enumerate(self.masses))
        return "\n".join(['[model]', 'kind = "mass-spring"', f"masses = {{ {masses} }}", "springs = [", *rows, "]"])

    def targets(self, part):
        """What the parameter of a part sets."""
        names = ", ".join(f'"spring:p{part}_{b}"' for b in range(len(self.parts[part])))
        return f"[{names}]"


def parts_in_a_row(parts=4, length=3, weak=0.2):
    """Equal parts, each held to the ground by itself, tied by a weaker chain: their frequencies lie in groups."""
    count = parts * length
    own = [[(-1 if b == 0 else a * length + b - 1, a * length + b) for b in range(length)] for a in range(parts)]
    return Chain([1.0] * count, own, [(i - 1, i, weak) for i in range(count)])


def between_walls(parts=4, length=3):
    """One uniform chain between two walls: its mirror image has the same frequencies."""
    count = parts * length - 1
    springs = [(i - 1, i if i < count else -1) for i in range(count + 1)]
    return Chain([1.0] * count, [springs[a * length:(a + 1) * length] for a in range(parts)], [])


def storeys(count=4):
    """A frame of storeys, one parameter each."""
    return Chain([1.0] * count, [[(i - 1, i)] for i in range(count)], [])


def two_that_cross():
    """A mode that no parameter moves lies between two that one parameter moves; the lower one crosses it at a factor of 1.3."""
    return Chain([1.0, 1.0, 0.25], [[(-1, 0), (-1, 2)]], [(-1, 1, 1.3), (0, 1, 0.001)])


def two_of_seven():
    """Five masses; two of seven springs are parameters."""
    return Chain([1.0, 1.2, 0.8, 1.0, 1.5], [[(-1, 0)], [(1, 2)]],
                 [(0, 1, 1.5), (2, 3, 2.0), (3, 4, 1.0), (4, -1, 0.7), (1, 4, 0.5)])
