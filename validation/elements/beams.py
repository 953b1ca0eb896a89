#!/usr/bin/env python3
"""Natural frequencies of bars, beams and rods against closed forms.

    python3 validation/elements/beams.py MOTTLE [--elements N] [--modes N] [--keep FOLDER]

MOTTLE is the command; it is called as `MOTTLE modes DECK --json`. Without it ("-") only the references are printed.
Roots x of the frequency equations: clamped and free cos x cosh x = -1, free and free cos x cosh x = 1, clamped and
pinned tan x = tanh x; [Blevins1979], table 8-1. Shear flexibility: a simply supported Timoshenko beam without rotary
inertia, w^2 = (E I k^4 / rho A) / (1 + E I k^2 / (K A G)), k = n pi / L.
"""

import argparse
import math

from programs import run_in_folder, run_mottle

YOUNG, POISSON, DENSITY = 7.0e10, 0.3, 2700.0
SHEAR = YOUNG / (2.0 * (1.0 + POISSON))
LENGTH, WIDTH, HEIGHT = 1.0, 0.02, 0.03
AREA, INERTIA_1, INERTIA_2 = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0, HEIGHT * WIDTH**3 / 12.0
RADIUS = 0.01


def root(function, low, high):
    """Where a function that changes its sign between two numbers is zero."""
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(low) * function(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)


def clamped_free(mode):
    return root(lambda x: math.cos(x) + 1.0 / math.cosh(x), (mode - 1) * math.pi + 1e-9, mode * math.pi)


def free_free(mode):
    return root(lambda x: math.cos(x) - 1.0 / math.cosh(x), mode * math.pi, (mode + 1) * math.pi)


def clamped_pinned(mode):
    return root(lambda x: math.sin(x) - math.tanh(x) * math.cos(x), mode * math.pi, (mode + 0.5) * math.pi)


def bending(roots, inertias, area, modes):
    """Hz, both planes in one ascending list."""
    found = []
    for inertia in inertias:
        speed = math.sqrt(YOUNG * inertia / (DENSITY * area)) / LENGTH**2
        found += [roots(mode) ** 2 * speed / (2.0 * math.pi) for mode in range(1, modes + 1)]
    return sorted(found)[:modes]


def soft_in_shear(factor, modes):
    found = []
    for mode in range(1, modes + 1):
        k = mode * math.pi / LENGTH
        rigid = YOUNG * INERTIA_1 * k**4 / (DENSITY * AREA)
        found.append(math.sqrt(rigid / (1.0 + YOUNG * INERTIA_1 * k**2 / (factor * AREA * SHEAR))) / (2.0 * math.pi))
    return found


def along_a_rod(modes):
    return [(2 * mode - 1) * math.sqrt(YOUNG / DENSITY) / (4.0 * LENGTH) for mode in range(1, modes + 1)]


def cases(modes):
    """Name, reference in Hz, property card, element cards' end, constraints (node or 'all' or 'last', components)."""
    plain = f"PBAR,1,1,{real(AREA)},{real(INERTIA_1)},{real(INERTIA_2)},1.-7"
    shear = plain + "\n,,,,,,,,\n,.8,0."
    round_bar = f"PBARL,1,1,,ROD\n,{real(RADIUS)}"
    round_inertia, round_area = math.pi * RADIUS**4 / 4.0, math.pi * RADIUS**2
    both = (INERTIA_1, INERTIA_2)
    return (
        ("cantilever", bending(clamped_free, both, AREA, modes), plain, "", ((1, "123456"), ("all", "14"))),
        ("free beam", bending(free_free, both, AREA, modes), plain, "", (("all", "14"),)),
        ("hinge by pins", bending(clamped_pinned, (INERTIA_1,), AREA, modes), plain, "56",
         ((1, "123456"), ("all", "1345"), ("last", "1234"))),
        ("PBARL ROD", bending(clamped_free, (round_inertia,) * 2, round_area, modes), round_bar, "",
         ((1, "123456"), ("all", "14"))),
        ("soft in shear", soft_in_shear(0.8, modes), shear, "", ((1, "12"), ("last", "2"), ("all", "1345"))),
        ("rod", along_a_rod(modes), f"PROD,1,1,{real(AREA)}", None, ((1, "1"), ("all", "23456"))),
    )


def real(value):
    """A number in at most eight characters, with a point."""
    if value == 0.0:
        return "0."
    for digits in range(7, 0, -1):
        mantissa, exponent = f"{value:.{digits}e}".split("e")
        text = f"{mantissa.rstrip('0')}{int(exponent):+d}"
        if len(text) <= 8:
            return text
    raise ValueError(value)


def write_deck(path, card, pins, constraints, elements, modes, is_coupled):
    last = elements + 1
    with open(path, "w", encoding="ascii") as out:
        out.write(f"SOL 103\nCEND\nMETHOD = 1\nSPC = 1\nBEGIN BULK\nEIGRL,1,,,{modes + 6}\n")
        out.write(f"PARAM,COUPMASS,{1 if is_coupled else -1}\n")
        out.write(f"MAT1,1,{real(YOUNG)},,{POISSON},{real(DENSITY)}\n{card}\n")
        for node in range(1, last + 1):
            out.write(f"GRID,{node},,{real(LENGTH * (node - 1) / elements)},0.,0.\n")
        for element in range(1, elements + 1):
            if pins is None:
                out.write(f"CROD,{element},1,{element},{element + 1}\n")
            else:
                # Orientation along y, so that I1 bends in x-y; pins at end B of the last element.
                out.write(f"CBAR,{element},1,{element},{element + 1},0.,1.,0.\n")
                if pins and element == elements:
                    out.write(f",,{pins}\n")
        for node, components in constraints:
            place = {"all": f"1,THRU,{last}", "last": f"{last}"}.get(node, f"{node}")
            out.write(f"SPC1,1,{components},{place}\n")
        out.write("ENDDATA\n")


def compare(folder, arguments):
    print("| case | mass | mode | reference Hz | Mottle Hz | difference % |\n|---|---|---:|---:|---:|---:|")
    for name, reference, card, pins, constraints in cases(arguments.modes):
        for is_coupled in (True, False):
            kind = "consistent" if is_coupled else "lumped"
            deck = folder / f"{name.replace(' ', '_')}_{kind}.bdf"
            write_deck(deck, card, pins, constraints, arguments.elements, arguments.modes, is_coupled)
            if arguments.mottle == "-":
                found = [math.nan] * len(reference)
            else:
                lowest = 1e-3 * reference[0]  # below: rigid motions
                found = [value for value in run_mottle(arguments.mottle, deck) if value > lowest]
            for mode, (exact, ours) in enumerate(zip(reference, found), 1):
                print(f"| {name} | {kind} | {mode} | {exact:.3f} | {ours:.3f} | {100.0 * (ours / exact - 1.0):+.3f} |",
                      flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mottle", help="path of the mottle command, - for none")
    parser.add_argument("--elements", type=int, default=20, help="number of elements along the beam")
    parser.add_argument("--modes", type=int, default=5, help="number of modes to compare")
    run_in_folder(parser, compare)


if __name__ == "__main__":
    main()
