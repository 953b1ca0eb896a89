"""Nastran decks of a frame and of a plate, and the airframe of examples/02; their modes by `mottle propagate` on the full model."""
import csv
import dataclasses
import pathlib
import tempfile

import numpy as np

import commands

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"


class DrawFailed(Exception):
    """A specimen's modes could not be followed: draw another set."""


def card(*fields):
    """One bulk data card in free format, continued as needed."""
    cells = ["" if field is None else repr(field) if isinstance(field, float) else str(field) for field in fields]
    rows = [cells[1:][k:k + 8] for k in range(0, len(cells) - 1, 8)]
    return "\n".join([",".join([cells[0], *rows[0]]), *(",".join(["", *row]) for row in rows[1:])])


def deck(title, modes, cards):
    """A deck of normal modes."""
    return "\n".join(["SOL 103", "CEND", f"TITLE = {title}", "METHOD = 1", "BEGIN BULK", f"EIGRL,1,,,{modes}", "PARAM,COUPMASS,1",
                      "PARAM,K6ROT,1.", *cards, "ENDDATA"]) + "\n"


def members(first, cards, ends, pid, start=None):
    """Four CBAR between two places with grid points of their own, all but a given start; their numbers."""
    points = [first + k if k or start is None else start for k in range(5)]
    for k, point in enumerate(points):
        if point == start:
            continue
        x, z = (ends[0][axis] + (ends[1][axis] - ends[0][axis]) * k / 4 for axis in (0, 1))
        cards.append(card("GRID", point, None, float(x), 0.0, float(z), None, 246))
    cards += [card("CBAR", first + k, pid, a, b, 0.0, 1.0, 0.0) for k, (a, b) in enumerate(zip(points, points[1:]))]
    return points


def frame():
    """A steel frame of two storeys in its plane: columns on soft bases, beams on soft joints, equipment of 40 and 90 kg."""
    cards = [card("MAT1", 1, 2.1e11, None, 0.3, 7850.0), card("MAT1", 2, 2.1e11, None, 0.3, 7850.0),
             card("PBAR", 1, 1, 3.0e-3, 4.0e-6, 4.0e-6, 1.0e-6), card("PBAR", 2, 2, 2.5e-3, 5.0e-6, 5.0e-6, 1.0e-6)]
    columns = {}
    for side, x in enumerate((0.0, 4.0)):
        for storey in (0, 1):
            first = 100 * (side + 1) + 10 * storey
            columns[side, storey] = members(first, cards, ((x, 3.0 * storey), (x, 3.0 * storey + 3.0)), 1, columns[side, 0][4] if storey else None)
        base = card("GRID", 90 + side, None, x, 0.0, 0.0, None, 123456)
        cards += [base, card("PBUSH", 11 + side, "K", 1e9, 1e9, 1e9, 1e7, 1.5e6, 1e7),
                  card("CBUSH", 911 + side, 11 + side, 90 + side, columns[side, 0][0], None, None, None, 0)]
    for storey in (0, 1):
        beam = members(300 + 10 * storey, cards, ((0.0, 3.0 * storey + 3.0), (4.0, 3.0 * storey + 3.0)), 2)
        cards.append(card("PBUSH", 21 + storey, "K", 1e9, 1e9, 1e9, 1e7, 1.0e6, 1e7))
        cards += [card("CBUSH", 921 + 2 * storey + side, 21 + storey, columns[side, storey][4], beam[-side], None, None, None, 0) for side in (0, 1)]
        cards.append(card("CONM2", 801 + storey, beam[2 - storey], 0, (40.0, 90.0)[storey]))
    return Deck("frame.bdf", deck("Frame of two storeys", 12, cards))


def plate():
    """An aluminium plate of 0.6 by 0.4 m, 3 mm, with a strip of 5 mm, on four springs, with an instrument of 0.3 kg."""
    cards = [card("MAT1", 1, 7.0e10, None, 0.33, 2700.0), card("MAT1", 2, 7.0e10, None, 0.33, 2700.0),
             card("PSHELL", 1, 1, 0.003, 1, None, 1), card("PSHELL", 2, 2, 0.005, 2, None, 2)]
    for j in range(7):
        cards += [card("GRID", 100 * j + i + 1, None, 0.075 * i, 0.4 * j / 6, 0.0, None, 126) for i in range(9)]
    for j in range(6):
        for i in range(8):
            corners = [100 * b + a + 1 for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
            cards.append(card("CQUAD4", 1000 + 100 * j + i, 2 if j == 2 else 1, *corners))
    for k, point in enumerate((2, 8, 602, 608)):
        cards += [card("PELAS", 11 + k, 4.0e4), card("CELAS1", 9001 + k, 11 + k, point, 3)]
    cards.append(card("CONM2", 9101, 406, 0, 0.3))
    return Deck("plate.bdf", deck("Plate on four springs", 14, cards))


def airframe():
    """The deck of examples/02."""
    return Deck("airframe.bdf", (EXAMPLES / "02-airframe/airframe.bdf").read_text(encoding="ascii"))


@dataclasses.dataclass
class Deck:
    """A deck under its file's name."""
    name: str
    text: str

    def files(self):
        return {self.name: self.text}

    def toml(self):
        return f'[model]\nkind = "nastran"\nfile = "{self.name}"'

    def points_study(self, truth, numbers, dofs, is_by_rank):
        """A study whose parameters are all numbers that are not the deck's."""
        rows = [self.toml(), 'reduction = "off"', "[outputs]", f"frequencies = {list(numbers)}", 'minimum_mac = 0.3',
                f'tracking = "{"order" if is_by_rank else "mac"}"']
        if dofs:
            rows.append(f"shapes = {{ modes = {list(numbers)}, dofs = {list(dofs)} }}".replace("'", '"'))
        for k, target in enumerate(truth):
            rows += ["[[parameter]]", f'name = "t{k}"', f'target = "{target}"', "relative = true",
                     'distribution = { kind = "normal", mean = 1.0, std = 0.1 }']
        return "\n".join(rows) + "\n"

    def modes(self, truth, count, numbers, dofs, is_by_rank, program):
        """Frequencies [specimen x mode] and shapes [specimen x dof x mode], mass-normalised."""
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            (place / self.name).write_text(self.text, encoding="ascii")
            (place / "study.toml").write_text(self.points_study(truth, numbers, dofs, is_by_rank), encoding="utf-8")
            np.savetxt(place / "points.csv", np.array(list(truth.values())).T, delimiter=",", fmt="%.17g",
                       header=",".join(f"t{k}" for k in range(len(truth))), comments="")
            answer = commands.call(program, "propagate", "study.toml", "--points", "points.csv", "--out", "out", folder=folder)
            if answer.code != 0:
                raise DrawFailed(answer.errors)
            with open(place / "out/cloud.csv", newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
        if len(rows) != count or any(not row["status"].startswith("ok") for row in rows):
            raise DrawFailed([row["status"] for row in rows])
        frequencies = np.array([[float(row[f"f{k}"]) for k in numbers] for row in rows])
        shapes = [float(row[f"phi{k}:{dof}"]) for row in rows for dof in dofs for k in numbers]
        return frequencies, np.reshape(shapes, (count, len(dofs), len(numbers)))
