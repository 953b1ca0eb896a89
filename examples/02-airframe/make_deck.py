#!/usr/bin/env python3
"""Writes airframe.bdf: a Nastran model in the manner of the GARTEUR SM-AG19 test aeroplane.

Python's standard library only; the same file comes out every time. Everything that was chosen stands in the constants
below: published dimensions first, then what we had to choose (joints, fittings, suspension) to come near the published
frequencies.

    python3 make_deck.py [FILE]        default: airframe.bdf beside this script

Axes: x forward, y to port, z up; origin on the fuselage's centre line under the wing. Units: m, kg, N, s.
"""
import os
import sys

# --- published dimensions, m --------------------------------------------------------------------------------------
FUSELAGE = {"aft": -0.9, "nose": 0.6, "height": 0.150, "thickness": 0.050}
WING = {"half_span": 1.0, "chord": 0.100, "thickness": 0.010}
LAYER = {"half_span": 0.85, "chord": 0.0762, "thickness": 0.0011}  # constrains a viscoelastic tape on the wing's top
DRUM = {"length": 0.400, "width": 0.100, "thickness": 0.010, "y": 0.95}
FIN = {"x": -0.8, "chord": 0.100, "height": 0.300, "thickness": 0.010}
TAILPLANE = {"half_span": 0.2, "chord": 0.100, "thickness": 0.010}

# --- chosen -------------------------------------------------------------------------------------------------------
ALUMINIUM = {"E": 70.0e9, "nu": 0.33, "rho": 2700.0}
LAYER_MODULUS = 45.0e9   # N/m^2, effective: the soft tape lets the layer carry only a part of the bending
SPACER = 0.0005          # m, fuselage top to wing's underside, tape
TIP_MASS = 0.20          # kg at the front of each drum: as published, it brings the two wing torsions together
SENSOR_MASS = 0.010      # kg
WING_FITTING = 1.60      # kg, plates and screws between wing and fuselage
FIN_FITTING = 0.90       # kg
TAILPLANE_FITTING = 0.25  # kg
BUNGEE = 1200.0          # N/m, vertical, each of three
PENDULUM = 110.0         # N/m, sideways, fore and aft: weight over rope length

# Joints: K1 K2 K3 (N/m) and K4 K5 K6 (N m/rad) along and about x, y, z.
WING_JOINT = [2.0e8, 2.0e8, 2.0e8, 1.0e5, 2.0e5, 2.0e6]
FIN_JOINT = [1.0e8, 1.0e8, 1.0e8, 1.5e4, 1.0e5, 1.0e5]
TAILPLANE_JOINT = [1.0e8, 1.0e8, 1.0e8, 5.0e3, 5.0e3, 2.0e4]

MODES = 20


def real(value):
    """The value in at most eight characters, with a point, as short as it is exact."""
    if value == 0.0:
        return "0."
    best = None
    for digits in range(7, 0, -1):
        plain = f"{value:.{digits}g}"
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        if "." in mantissa:
            mantissa = mantissa.rstrip("0")
        mantissa = mantissa if "." in mantissa else mantissa + "."
        forms = [f"{mantissa}{int(exponent):+d}"]
        if "e" not in plain:
            plain = plain if "." in plain else plain + "."
            forms.insert(0, plain.replace("0.", ".", 1) if plain.lstrip("-").startswith("0.") else plain)
        fitting = [form for form in forms if len(form) <= 8]
        if fitting:
            best = fitting[0]
            break
    return best


class Deck:
    """Lines of a deck, and the grid points by place and part."""

    def __init__(self):
        self.lines = []
        self.points = {}   # (part, rounded place) -> id
        self.element = 0

    def say(self, *text):
        self.lines += ["$ " + line if line else "$" for line in text]

    def section(self, title, *text):
        self.lines.append("$ " + "-" * 70)
        self.say(title, *text)

    def card(self, name, *fields):
        """One card in small field format, continued as needed; None is blank."""
        cells = ["" if f is None else real(f) if isinstance(f, float) else str(f) for f in fields]
        while cells and not cells[-1]:
            cells.pop()
        for start in range(0, max(len(cells), 1), 8):
            row = cells[start:start + 8]
            head = name if start == 0 else ""
            self.lines.append((f"{head:<8}" + "".join(f"{c:<8}" for c in row)).rstrip())

    def grid(self, ident, x, y, z):
        self.card("GRID", ident, None, x, y, z)
        return ident

    def mesh(self, part, first, rows):
        """Grid points row by row; `rows` holds lists of places. Returns ids in the same order."""
        ids = []
        for row in rows:
            ids.append([])
            for place in row:
                ident = first
                first += 1
                self.grid(ident, *place)
                self.points[part, tuple(round(c, 6) for c in place)] = ident
                ids[-1].append(ident)
        return ids

    def quads(self, ids, prop, zoffs=None, keep=lambda i, j: True):
        """CQUAD4 between neighbouring rows."""
        for i in range(len(ids) - 1):
            for j in range(len(ids[i]) - 1):
                if not keep(i, j):
                    continue
                self.element += 1
                corners = (ids[i][j], ids[i][j + 1], ids[i + 1][j + 1], ids[i + 1][j])
                self.card("CQUAD4", self.element, prop, *corners, None, zoffs)

    def at(self, part, *place):
        return self.points[part, tuple(round(c, 6) for c in place)]


def steps(first, last, count):
    return [first + (last - first) * i / count for i in range(count + 1)]


def control(deck):
    deck.say("An aeroplane in the manner of the GARTEUR SM-AG19 testbed. Made by make_deck.py; change that, not this.",
             "x forward, y to port, z up; m, kg, N, s.")
    deck.lines += ["SOL 103", "CEND", "TITLE = Airframe, ground vibration test", "METHOD = 10",
                   "DISPLACEMENT(PLOT) = ALL", "BEGIN BULK"]
    deck.section("Analysis", "EIGRL: Lanczos, the lowest modes; the first six are the rigid body on its bungees.")
    deck.card("EIGRL", 10, None, None, MODES)
    deck.say("COUPMASS: consistent mass. AUTOSPC: holds what has no stiffness. K6ROT: drilling stiffness of the",
             "shells. GRDPNT: mass properties about the basic origin.")
    deck.card("PARAM", "COUPMASS", 1)
    deck.card("PARAM", "AUTOSPC", "YES")
    deck.card("PARAM", "K6ROT", 1.0)
    deck.card("PARAM", "GRDPNT", 0)


def materials(deck):
    deck.section("Materials and properties",
                 "MAT1 1: aluminium of the wing; an update moves its E. MAT1 2: aluminium of everything else.",
                 "MAT1 3: the wing's constraining layer with the modulus that is left over the soft tape.")
    e, nu, rho = ALUMINIUM["E"], ALUMINIUM["nu"], ALUMINIUM["rho"]
    deck.card("MAT1", 1, e, None, nu, rho)
    deck.card("MAT1", 2, e, None, nu, rho)
    deck.card("MAT1", 3, LAYER_MODULUS, None, nu, rho)
    deck.say("PSHELL: PID, membrane MID, T, bending MID, 12I/T3, shear MID.")
    for prop, mat, thickness in ((1, 1, WING["thickness"]), (2, 3, LAYER["thickness"]),
                                 (3, 2, FUSELAGE["thickness"]), (4, 2, FIN["thickness"]),
                                 (5, 2, TAILPLANE["thickness"])):
        deck.card("PSHELL", prop, mat, float(thickness), mat, None, mat)
    deck.say("PBEAML BAR: width along the element's y, height along its z.")
    deck.card("PBEAML", 6, 2, None, "BAR", None, None, None, None, DRUM["thickness"], DRUM["width"])


def wing(deck):
    z = FUSELAGE["height"] / 2 + SPACER + WING["thickness"] / 2
    half = WING["chord"] / 2
    edge = -half + LAYER["chord"]
    # The layer lies flush with the trailing edge: three columns of elements under it, one in front.
    chord = steps(-half, edge, 3) + [half]
    outboard = [0.025, 0.05] + [0.05 * k for k in range(2, 21)]
    span = [-y for y in reversed(outboard)] + [0.0] + outboard
    deck.section("Wing: a plate of CQUAD4 at 1001..., rows along the chord")
    ids = deck.mesh("wing", 1001, [[(x, y, z) for x in chord] for y in span])
    deck.quads(ids, 1)
    deck.say("Constraining layer: shells on the wing's grid points, shifted up along their normal by ZOFFS.")
    offset = (WING["thickness"] + LAYER["thickness"]) / 2
    inside = LAYER["half_span"] + 1e-6
    deck.quads(ids, 2, offset, lambda i, j: j < 3 and abs(span[i]) <= inside and abs(span[i + 1]) <= inside)
    return z, chord, span


def drums(deck, z, chord):
    deck.section("Wing tip drums: CBEAM at 2001... with offsets up from the wing's mid-plane to the drum's axis;",
                 "RBE2 ties the middle to the wing's tip.")
    up = (WING["thickness"] + DRUM["thickness"]) / 2
    middles = []
    for side, first in ((1.0, 2001), (-1.0, 2101)):
        row = deck.mesh("drum", first, [[(x, side * DRUM["y"], z) for x in steps(-0.2, 0.2, 8)]])[0]
        for a, b in zip(row, row[1:]):
            deck.element += 1
            deck.card("CBEAM", deck.element, 6, a, b, 0.0, 0.0, 1.0, None, None, None, 0.0, 0.0, up, 0.0, 0.0, up)
        deck.element += 1
        deck.card("RBE2", deck.element, row[4], 123456, *[deck.at("wing", x, side * DRUM["y"], z) for x in chord])
        middles.append(row)
    return middles, up


def fuselage(deck):
    half = FUSELAGE["height"] / 2
    deck.section("Fuselage: CQUAD4 in the plane of symmetry at 3001..., 50 mm thick")
    ids = deck.mesh("fuselage", 3001,
                    [[(x, 0.0, z) for z in steps(-half, half, 3)]
                     for x in steps(FUSELAGE["aft"], FUSELAGE["nose"], 30)])
    deck.quads(ids, 3)


def empennage(deck):
    base = FUSELAGE["height"] / 2
    top = base + FIN["height"]
    chord = steps(FIN["x"] - FIN["chord"] / 2, FIN["x"] + FIN["chord"] / 2, 4)
    deck.section("Fin: CQUAD4 at 4001...; tailplane: CQUAD4 at 5001...")
    deck.quads(deck.mesh("fin", 4001, [[(x, 0.0, z) for x in chord] for z in steps(base, top, 6)]), 4)
    z = top + TAILPLANE["thickness"] / 2
    half = TAILPLANE["half_span"]
    deck.quads(deck.mesh("tailplane", 5001, [[(x, y, z) for x in chord] for y in steps(-half, half, 8)]), 5)
    return chord, base, top, z


def joint(deck, number, title, place, below, above, stiffness, mass):
    """Two grid points at one place, RBE2 to either side, CBUSH between them, the fitting's mass on the lower."""
    deck.section(title)
    lower, upper = deck.grid(9000 + 10 * number + 1, *place), deck.grid(9000 + 10 * number + 2, *place)
    deck.element += 1
    deck.card("RBE2", deck.element, lower, 123456, *below)
    deck.element += 1
    deck.card("RBE2", deck.element, upper, 123456, *above)
    deck.card("PBUSH", 100 + number, "K", *stiffness)
    deck.card("CBUSH", 9000 + number, 100 + number, lower, upper, None, None, None, 0)
    deck.card("CONM2", 9100 + number, lower, 0, mass)


def joints(deck, wing_z, wing_chord, tail):
    chord, base, top, tail_z = tail
    deck.section("Joints: CBUSH in basic axes, K1 K2 K3 in N/m, K4 K5 K6 in N m/rad about x, y, z. CONM2: fittings.")
    joint(deck, 1, "Wing to fuselage", (0.0, 0.0, base),
          [deck.at("fuselage", x, 0.0, base) for x in (-0.05, 0.0, 0.05)],
          [deck.at("wing", x, y, wing_z) for y in (-0.025, 0.0, 0.025) for x in wing_chord], WING_JOINT, WING_FITTING)
    joint(deck, 2, "Fin to fuselage", (FIN["x"], 0.0, base),
          [deck.at("fuselage", x, 0.0, base) for x in (-0.85, -0.8, -0.75)],
          [deck.at("fin", x, 0.0, base) for x in chord], FIN_JOINT, FIN_FITTING)
    joint(deck, 3, "Tailplane to fin", (FIN["x"], 0.0, top),
          [deck.at("fin", x, 0.0, top) for x in chord],
          [deck.at("tailplane", x, 0.0, tail_z) for x in chord], TAILPLANE_JOINT, TAILPLANE_FITTING)


def sensors(deck, wing_z, wing_chord, drum_rows, up, tail):
    """Accelerometers on grid points of their own; numbers below 100 to starboard, from 100 to port."""
    chord, base, top, tail_z = tail
    deck.section("Accelerometers at 1..., each a CONM2 on a grid point that RBE2 ties to the structure:",
                 "11, 111 front and 12, 112 rear of the drums; 1, 101 wing tip; 5, 105 and 8, 108 along the wing;",
                 "201 nose, 202 tail of the fuselage; 205 fin's tip; 301, 303 tailplane's tips, 302 its middle.",
                 "Tip masses: CONM2 7001, 7002 at the front of the drums.")
    surface = wing_z + WING["thickness"] / 2
    port, starboard = drum_rows
    drum_top = wing_z + up + DRUM["thickness"] / 2
    places = {}
    for shift, side, row in ((0, -1.0, starboard), (100, 1.0, port)):
        y = side * DRUM["y"]
        places[1 + shift] = (row[4], (0.0, y, drum_top))
        places[11 + shift] = (row[8], (0.2, y, drum_top))
        places[12 + shift] = (row[0], (-0.2, y, drum_top))
        for number, span in ((5, 0.7), (8, 0.35)):
            x = wing_chord[4]
            places[number + shift] = (deck.at("wing", x, side * span, wing_z), (x, side * span, surface))
    places[201] = (deck.at("fuselage", 0.6, 0.0, 0.025), (0.6, 0.025, 0.025))
    places[202] = (deck.at("fuselage", -0.9, 0.0, 0.025), (-0.9, 0.025, 0.025))
    middle = deck.at("fin", FIN["x"], 0.0, 0.325)
    places[205] = (middle, (FIN["x"], FIN["thickness"] / 2, 0.325))
    for number, y in ((301, -0.2), (303, 0.2)):
        node = deck.at("tailplane", chord[4], y, tail_z)
        places[number] = (node, (chord[4], y, tail_z + TAILPLANE["thickness"] / 2))
    node = deck.at("tailplane", chord[4], 0.05, tail_z)
    places[302] = (node, (chord[4], 0.05, tail_z + TAILPLANE["thickness"] / 2))
    for number in sorted(places):
        node, place = places[number]
        deck.grid(number, *place)
        deck.element += 1
        deck.card("RBE2", deck.element, node, 123456, number)
        deck.card("CONM2", 8000 + number, number, 0, SENSOR_MASS)
    deck.card("CONM2", 7001, starboard[8], 0, TIP_MASS, 0.0, 0.0, up)
    deck.card("CONM2", 7002, port[8], 0, TIP_MASS, 0.0, 0.0, up)


def suspension(deck, wing_z, wing_chord):
    deck.section("Suspension: two bungees at the wing's root, one on the rear fuselage. PELAS/CELAS1 to ground:",
                 "vertical, and the weak sideways stiffness of a pendulum.")
    deck.card("PELAS", 201, BUNGEE)
    deck.card("PELAS", 202, PENDULUM)
    number = 9500
    for node in (deck.at("wing", wing_chord[2], 0.1, wing_z), deck.at("wing", wing_chord[2], -0.1, wing_z),
                 deck.at("fuselage", -0.5, 0.0, FUSELAGE["height"] / 2)):
        for prop, component in ((201, 3), (202, 1), (202, 2)):
            number += 1
            deck.card("CELAS1", number, prop, node, component)


def write_deck():
    deck = Deck()
    control(deck)
    materials(deck)
    wing_z, wing_chord, _ = wing(deck)
    drum_rows, up = drums(deck, wing_z, wing_chord)
    fuselage(deck)
    tail = empennage(deck)
    joints(deck, wing_z, wing_chord, tail)
    sensors(deck, wing_z, wing_chord, drum_rows, up, tail)
    suspension(deck, wing_z, wing_chord)
    deck.lines.append("ENDDATA")
    return "\n".join(deck.lines) + "\n"


if __name__ == "__main__":
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), "airframe.bdf")
    target = sys.argv[1] if len(sys.argv) > 1 else beside
    with open(target, "w", encoding="ascii", newline="\n") as file:
        file.write(write_deck())
