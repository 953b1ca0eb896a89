"""The families of whole studies: half with a right model, half with one error that matters."""
from decks import airframe, frame, plate
from errors import LooseSpecimen, SwappedColumns, TwoBatches, WrongNumber, WrongUnit
from structures import Beam, Function, Springs
from studies import Family, Parameter

FLOORS = [f"m{k}" for k in range(4)]
FRAME_DOFS = ["101:+X", "102:+X", "103:+X", "114:+X", "112:+X", "203:+X", "214:+X", "302:+Z", "303:+Z", "312:+Z", "313:+Z"]
PLATE_DOFS = [f"{node}:+Z" for node in (1, 5, 9, 301, 305, 309, 601, 605, 609)]
FEW = "samples = 200"  # of a cloud, where each is solved in full
DIAGNOSED = f"{FEW}\n[diagnose]\nscreened = 4"  # fewer fits in the model itself
AIRFRAME_MODES = list(range(7, 17))


def normal(prior, *targets):
    return Parameter(list(targets), prior)


def lognormal(prior, *targets):
    return Parameter(list(targets), prior, "lognormal")


def six_masses(left_out=()):
    """A row of six masses to ground at both ends, with ties over one mass."""
    springs = {f"k{k}": (k - 1, k if k < 6 else -1, 1000.0 + 150.0 * k) for k in range(7)}
    springs |= {"tie": (0, 3, 500.0), "stay": (2, -1, 600.0), "brace": (1, 5, 700.0)}
    return Springs([1.0, 1.3, 0.8, 1.0, 1.6, 0.9], springs, left_out)


def twelve_masses():
    """A row of twelve masses, eight of whose springs are alike."""
    return Springs([1.0 + 0.1 * (k % 3) for k in range(12)], {f"k{k}": (k - 1, k, 3000.0) for k in range(12)} | {"end": (11, -1, 900.0)})


def storeys():
    return Springs([1.0] * 4, {f"k{k}": (k - 1, k, 9000.0) for k in range(4)})


def two_arms():
    """Two arms alike on a body that stands on a spring."""
    return Springs([4.0, 1.0, 0.5, 1.0, 0.5], {"base": (-1, 0, 3000.0), "left": (0, 1, 1000.0), "left_tip": (1, 2, 800.0),
                                               "right": (0, 3, 1100.0), "right_tip": (3, 4, 800.0)})


def crossing():
    """A mode that no parameter moves, which another crosses at a factor of 1.3."""
    return Springs([1.0, 1.0, 0.25], {"a": (-1, 0, 1.0), "b": (-1, 2, 1.0), "own": (-1, 1, 1.3), "weak": (0, 1, 0.001)})


def spring_families():
    """Masses and springs."""
    three = [lognormal(0.2, "spring:k1"), lognormal(0.2, "spring:k4"), lognormal(0.2, "spring:tie")]
    eight = [normal(0.05, f"spring:k{k}") for k in range(8)]
    rank = {"frequencies": [1, 2, 3, 4, 5, 6]}
    shapes = {"form": "shapes", "shape_modes": [1, 2, 3]}
    return [
        Family("six masses, by rank", six_masses(), three, **rank),
        Family("twelve masses, eight parameters, 30 specimens, shapes", twelve_masses(), eight, list(range(1, 11)), specimens=(30, 30),
               dofs=[f"m{k}" for k in range(12)], **shapes),
        Family("four storeys, prior 40 %, shapes, noise unknown", storeys(), [lognormal(0.4, f"spring:k{k}") for k in range(4)], [1, 2, 3, 4],
               dofs=FLOORS, is_stated=False, **shapes),
        Family("two arms alike, 3 to 5 specimens", two_arms(), [normal(0.1, "spring:left"), normal(0.1, "spring:right")], [1, 2, 3, 4, 5],
               specimens=(3, 5)),
        Family("modes that cross, followed by shapes, noise unknown", crossing(), [normal(0.1, "spring:a"), normal(0.1, "spring:b")], [1, 2, 3],
               scatter=0.15, is_stated=False, form="shapes", shape_modes=[1, 2, 3], dofs=["m0", "m1", "m2"]),
        Family("six masses, two batches by `mixture`", six_masses(), three, error=None, specimens=(30, 30), scatter=0.02, batches=("spring:k4", 1.25),
               method="mixture", **rank),
        Family("six masses, a fixed spring 40 % too soft", six_masses(), three, error=WrongNumber("spring:k2", 1.67), **rank),
        Family("six masses, a spring left out", six_masses(("brace",)), three, error=WrongNumber("spring:brace", 1.0), **rank),
        Family("six masses, columns f2 and f3 swapped", six_masses(), three, error=SwappedColumns("f2", "f3"), form="named", **rank),
        Family("six masses, two batches taken for one population", six_masses(), three, error=TwoBatches("spring:k4", 1.25), specimens=(30, 30),
               scatter=0.02, **rank),
        Family("six masses, tests in rad/s", six_masses(), three, error=WrongUnit(r"f\d+", 6.283185307), **rank),
        Family("four storeys, two sensors swapped, noise unknown", storeys(), [lognormal(0.2, f"spring:k{k}") for k in range(4)], [1, 2, 3, 4],
               error=SwappedColumns("m1", "m2"), dofs=FLOORS, is_stated=False, **shapes),
    ]


def frame_families():
    """A deck of beams."""
    joints = [lognormal(0.4, "PBUSH:21:K5"), lognormal(0.4, "PBUSH:22:K5"), lognormal(0.3, "PBUSH:11:K5", "PBUSH:12:K5"), normal(0.1, "CONM2:801:M")]
    sides = [lognormal(0.3, "PBUSH:11:K5"), lognormal(0.3, "PBUSH:12:K5"), lognormal(0.3, "PBUSH:21:K5"), lognormal(0.3, "PBUSH:22:K5"),
             normal(0.05, "MAT1:2:E")]
    named = {"frequencies": list(range(1, 9)), "form": "named", "update": FEW}
    files = {"frequencies": list(range(1, 9)), "form": "uff", "dofs": FRAME_DOFS, "update": FEW}
    return [
        Family("frame, named, noise unknown and unequal", frame(), joints, is_stated=False, ratio=3.0, **named),
        Family("frame, universal files, sides alike, 6 specimens", frame(), sides, specimens=(6, 6), **files),
        Family("frame, `init`, noise unknown", frame(), joints[:3], specimens=(12, 12), scatter=0.08, is_stated=False, is_proposed=True, **files),
        Family("frame, equipment 40 % heavier than in the deck", frame(), joints, error=WrongNumber("CONM2:802:M", 1.4), **named | {"update": DIAGNOSED}),
        Family("frame, universal files, a loose joint in one specimen", frame(), sides, error=LooseSpecimen(("PBUSH:21:K5",), 0.15),
               specimens=(10, 14), **files),
        Family("frame, `init`, a loose base in one specimen", frame(), joints[:3], error=LooseSpecimen(("PBUSH:11:K5",), 0.1), specimens=(12, 12),
               scatter=0.08, is_proposed=True, **files),
    ]


def plate_families():
    """A deck of shells."""
    free = [lognormal(0.3, "PELAS:11:K", "PELAS:12:K"), lognormal(0.3, "PELAS:13:K", "PELAS:14:K"), normal(0.05, "PSHELL:1:T")]
    named = {"frequencies": list(range(1, 9)), "form": "named", "update": FEW}
    return [
        Family("plate, named, gaps of 5 %, 15 specimens", plate(), free, specimens=(15, 15), gaps=0.05, **named),
        Family("plate, shapes, four springs alike", plate(), [lognormal(0.2, f"PELAS:{k}:K") for k in (11, 12, 13, 14)], list(range(1, 9)),
               form="shapes", shape_modes=[1, 2, 3], dofs=PLATE_DOFS, update=FEW),
        Family("plate, a strip 10 % thicker than in the deck, noise unknown", plate(), free, error=WrongNumber("PSHELL:2:T", 1.1, ("MAT1:2:E",)),
               is_stated=False, **named | {"update": DIAGNOSED}),
        Family("plate, one frequency in kHz in one column", plate(), free, error=WrongUnit("f4", 0.001), **named),
    ]


def airframe_families():
    """The aeroplane of examples/02."""
    eight = [normal(0.05, "MAT1:1:E"), normal(0.05, "PSHELL:1:T"), normal(0.2, "MAT1:3:E"), lognormal(0.3, "PBUSH:101:K4"),
             lognormal(0.3, "PBUSH:101:K6"), lognormal(0.3, "PBUSH:102:K4"), lognormal(0.3, "PBUSH:103:K6"), normal(0.05, "CONM2:7001:M", "CONM2:7002:M")]
    named = {"frequencies": AIRFRAME_MODES, "form": "named", "specimens": (20, 20)}
    return [
        Family("airframe, eight parameters, gaps of 3 %", airframe(), eight, gaps=0.03, **named),
        Family("airframe, a loose tailplane in one specimen", airframe(), eight, error=LooseSpecimen(("PBUSH:103:K6",), 0.3), **named),
    ]


def beam_families():
    """A beam as matrices, and as a function behind a server."""
    parts = [lognormal(0.15, "K:part0"), lognormal(0.15, "K:part1"), normal(0.2, "K:root"), normal(0.1, "M:load")]
    inputs = {"x0": ["K:part0", "K:part1"], "x1": ["K:root"]}
    two = [normal(0.1, *inputs["x0"]), lognormal(0.3, *inputs["x1"])]
    rank = {"frequencies": list(range(1, 7))}
    return [
        Family("beam, matrices, by rank", Beam(), parts, **rank),
        Family("beam, function behind a server, 15 specimens", Function(inputs, 6), two, specimens=(15, 15), update=FEW, **rank),
        Family("beam, matrices, a spring at the tip twice as stiff", Beam(), parts, error=WrongNumber("K:tip", 2.0), **rank),
        Family("beam, function in rad/s", Function(inputs, 6, 6.283185307), two, error=WrongUnit("none", 1.0), update=FEW, **rank),
    ]


def families():
    """All, right models first."""
    found = spring_families() + frame_families() + plate_families() + airframe_families() + beam_families()
    return sorted(found, key=lambda family: family.error is not None)
