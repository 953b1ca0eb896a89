"""Every reader with files that it reads, and how the command is made to read one: what is mutated, and what it then means."""

import pathlib
from typing import NamedTuple

from attack import support

FORMATS = support.SOURCE / "tests" / "formats"
EXAMPLES = support.SOURCE / "examples"
MATRICES = FORMATS / "matrices"
AIRFRAME = EXAMPLES / "02-airframe"
UNIVERSAL = EXAMPLES / "05-uff-population"


class Seed(NamedTuple):
    """A file that the command reads."""

    reader: str
    name: str         # in the folder of the attack
    content: bytes
    study: str        # study.toml; empty: none, or the file itself
    arguments: tuple
    beside: tuple = ()   # further (name, content)
    code: int = 0        # that the command ends with where the file is not mutated


MATRIX_STUDY = """\
[model]
kind = "matrices"
mass = "{0}"
terms = [{{ name = "k", stiffness = "{0}", nominal = 2.0 }}]
[[parameter]]
name = "k"
target = "K:k"
distribution = {{ kind = "normal", mean = 2.0, std = 0.1 }}
[outputs]
frequencies = [1]
[update]
samples = 10
"""
OUTPUT_STUDY = """\
[model]
kind = "command"
command = ["sh", "-c", "cat given", "{{a}}"]
files = ["given"]
retries = 0
timeout = "5 s"
RULES
[[parameter]]
name = "a"
distribution = { kind = "normal", mean = 4.0, std = 0.2 }
[outputs]
frequencies = [1, 2]
[test]
file = "tests.csv"
"""
OUTPUT_TESTS = "f1,f2\n1.5,2.5\n1.6,2.6\n1.4,2.4\n"
F06 = """\
                                              R E A L   E I G E N V A L U E S
   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES            GENERALIZED         GENERALIZED
    NO.       ORDER                                                                       MASS              STIFFNESS
        1         1        3.947842E+01        6.283185E+00        1.000000E+00        1.000000E+00        3.947842E+01
        2         2        1.579137E+02        1.256637E+01        2.000000E+00        1.000000E+00        1.579137E+02
"""
OUTPUTS = {
    "column": ('format = "column"\nafter = "FREQ"\ncolumn = 2', "FREQ\n1 1.5\n2 2.5\n\nEND\n"),
    "regex": ('format = "regex"\npattern = "f *= *([-+0-9.eE]+)"', "mode 1 f = 1.5\nmode 2 f = 2.5\n"),
    "csv": ('format = "csv"\ncolumn = "f"', "mode,f\n1,1.5\n2,2.5\n"),
    "json": ('format = "json"\ncolumn = "m.f"', '{"m": {"f": [1.5, 2.5], "title": "a \\u00e9"}, "n": [true, null]}\n'),
    "f06": ('format = "f06"', F06),
    "calculix": ('format = "calculix"', (MATRICES / "bar.dat").read_text(encoding="utf-8")),
}
NAMED = {"punch.pch": "#KAAX", "big_endian.op4": "#KAA", "octave.h5": "#A/value"}
POINTS = "k1,k2\n2.0,1.5\n1.9,2.1e0\n"


def studies():
    beside = (("tests.csv", support.TESTS),)
    yield Seed("study", "study.toml", support.STUDY.encode(), "", ("check", "study.toml"), beside)
    for name in ("case1", "shapes"):
        file = EXAMPLES / "01-three-masses" / f"{name}.toml"
        table = EXAMPLES / "01-three-masses" / f"specimens-{name}.csv"
        yield Seed("study", "study.toml", file.read_bytes(), "", ("check", "study.toml"), ((table.name, table.read_bytes()),))
    for name in ("study", "study-shapes"):
        file = AIRFRAME / f"{name}.toml"
        beside = tuple((path.name, path.read_bytes()) for path in AIRFRAME.iterdir() if path.suffix in (".csv", ".bdf"))
        yield Seed("study", "study.toml", file.read_bytes(), "", ("check", "study.toml"), beside)


def tables():
    yield Seed("csv", "tests.csv", support.TESTS.encode(), support.STUDY, ("check", "study.toml"))
    yield Seed("csv", "points.csv", POINTS.encode(), support.STUDY, ("propagate", "study.toml", "--points", "points.csv", "--out", "out"),
               (("tests.csv", support.TESTS),))
    study = (AIRFRAME / "study-shapes.toml").read_text(encoding="utf-8")
    yield Seed("csv", "shapes-test.csv", (AIRFRAME / "shapes-test.csv").read_bytes(), study, ("check", "study.toml"),
               tuple((name, (AIRFRAME / name).read_bytes()) for name in ("airframe.bdf", "specimens.csv")))


def universal_files():
    study = (UNIVERSAL / "study.toml").read_text(encoding="utf-8").replace('"../02-airframe/', '"').replace(
        'file = "specimens"', 'file = "given.uff"')
    beside = (("airframe.bdf", (AIRFRAME / "airframe.bdf").read_bytes()),)
    alone = ("check", "study.toml", "--set", 'update.method="deterministic"')  # which one specimen suffices for
    for number in (1, 4, 7, 8):
        file = UNIVERSAL / "specimens" / f"aeroplane-{number:02}.uff"
        yield Seed("uff", "given.uff", file.read_bytes(), study, alone, beside)
    yield Seed("uff", "given.uff", (FORMATS / "uff" / "gmsh.unv").read_bytes(), study, alone, beside, 2)


def bulk_data():
    includes = tuple((path.name, path.read_bytes()) for path in (FORMATS / "nastran").glob("include_*.dat"))
    for file in (AIRFRAME / "airframe.bdf", *(FORMATS / "nastran" / f"{name}.bdf" for name in
                                             ("shells", "solids", "springs", "include_main"))):
        yield Seed("bulk data", file.name, file.read_bytes(), "", ("modes", file.name, "--out", "out", "--quiet"), includes, -1)


def calculix_decks():
    folder = EXAMPLES / "03-plate-calculix"
    beside = (("specimens.csv", (folder / "specimens.csv").read_bytes()),)
    # A solver that does nothing: the deck is read and written, and that no matrices came is the end.
    yield Seed("CalculiX deck", "plate.inp", (folder / "plate.inp").read_bytes(), (folder / "study.toml").read_text(encoding="utf-8"),
               ("check", "study.toml", "--set", 'model.program="/bin/true"', "--cache", "off"), beside, 3)


def meshes():
    study = """[model]
kind = "mesh"
file = "given.msh"
materials = [ { name = "steel", young = 2.1e11, poisson = 0.3, density = 7850 } ]
sections = [ { group = "plate", material = "steel", thickness = 0.002 } ]
supports = [ { group = "edges" } ]
[[parameter]]
name = "E"
target = "material:steel:young"
distribution = { kind = "normal", mean = 2.1e11, std = 1e10 }
[outputs]
frequencies = [1, 2]
"""
    for name in ("plate41.msh", "plate22.msh"):
        yield Seed("mesh", "given.msh", (FORMATS / "gmsh" / name).read_bytes(), study, ("check", "study.toml"))


def matrices():
    for file in sorted(MATRICES.iterdir()):
        if file.suffix in (".py", ".dat", ".frd"):
            continue
        read = {".dof": "bar.sti", ".mapping": "layout.rsa"}.get(file.suffix, file.name)
        beside = tuple((other.name, other.read_bytes()) for other in MATRICES.glob(pathlib.Path(read).stem + ".*") if other != file
                       and other.suffix in (".dof", ".mapping", ".sti", ".rsa"))
        yield Seed("HDF5" if file.suffix == ".h5" else "matrices", file.name, file.read_bytes(),
                   MATRIX_STUDY.format(read + NAMED.get(file.name, "")), ("check", "study.toml"), beside, -1)


def matlab_files():
    """Two modes of three rows, which the study does not have: what is read is refused at the end."""
    study = support.edited(support.STUDY, ("tests.csv", "given.mat"))
    for file in sorted((FORMATS / "mat").glob("*.mat")):
        yield Seed(".mat", "given.mat", file.read_bytes(), study, ("check", "study.toml"), (), -1)


def solver_outputs():
    for format_name, (rules, content) in OUTPUTS.items():
        study = OUTPUT_STUDY.replace("RULES", f'[model.frequencies]\nfile = "stdout.txt"\n{rules}')
        yield Seed("solver's output", "given", content.encode(), study, ("check", "study.toml"),
                   (("tests.csv", OUTPUT_TESTS),))
        if format_name == "calculix":
            study = study.replace("[[parameter]]", '[model.shapes]\nfile = "bar.frd"\nformat = "calculix"\n[[parameter]]', 1)
            study = study.replace('"given"]', '"given", "bar.frd"]')
            yield Seed("solver's output", "bar.frd", (MATRICES / "bar.frd").read_bytes(), study, ("check", "study.toml"),
                       (("tests.csv", OUTPUT_TESTS), ("given", content)))


def results(bench):
    """Files that `report` reads, of an update and of a propagation."""
    bench.write("study.toml", support.STUDY)
    bench.write("tests.csv", support.TESTS)
    for verb in ("update", "propagate"):
        bench.succeed(verb, "study.toml", "--out", verb, "--quiet", "--set", "update.samples=30", "--set", "update.iterations=3")
        files = {path.name: path.read_bytes() for path in (bench.folder / verb).iterdir()
                 if path.is_file() and path.suffix in (".json", ".csv", ".toml")}
        for name, content in sorted(files.items()):
            beside = tuple(("out/" + other, text) for other, text in files.items() if other != name)
            yield Seed("results", "out/" + name, content, "", ("report", "out"), beside)


def seeds(bench):
    """By reader."""
    made = {}
    for group in (studies(), tables(), universal_files(), bulk_data(), calculix_decks(), meshes(), matrices(), matlab_files(),
                  solver_outputs(), results(bench)):
        for seed in group:
            made.setdefault(seed.reader, []).append(seed)
    return made
