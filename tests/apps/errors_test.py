"""Every wrong input gives one message that says where, what was found and what is allowed; exit code 2; no files. What
update refuses, check refuses with the same words.

    python3 errors_test.py PATH_TO_MOTTLE          MOTTLE_SHOW=1 prints each message
"""

import os
import re
import time
import unittest

import support
from support import STUDY, TESTS, edited, line_of

CASES = []
K2_LINE = "study.toml:{}: ".format(STUDY[:STUDY.index('"k2"\ntarget')].count("\n"))  # its [[parameter]]


class Case:
    """One wrong input and what its message must hold."""

    def __init__(self, name, expect, *, study=STUDY, tests=TESTS, files=None, arguments=None, at=None, tests_at=None,
                 is_usage=False, code=2, prepare=None, is_checked=True):
        self.name = name
        self.expect = list(expect)
        self.study = study
        self.tests = tests
        self.files = files or {}
        self.arguments = arguments or ["update", "study.toml", "--out", "out"]
        self.is_usage = is_usage
        self.code = code
        self.prepare = prepare
        self.is_checked = is_checked  # whether `check` can know it
        if at is not None:
            self.expect.append(f"study.toml:{line_of(study, at)}: ")
        if tests_at is not None:
            self.expect.append(f"tests.csv:{tests_at}: ")


def case(name, expect, **how):
    CASES.append(Case(name, expect, **how))


def study_case(name, changes, expect, at=None, **how):
    """The good study with `changes` [(old, new), ...]; `at` is text on the line that the message must name."""
    case(name, ["study.toml", *expect], study=edited(STUDY, *changes), at=at, **how)


def tests_case(name, tests, expect, tests_at=None, **how):
    case(name, ["tests.csv", *expect], tests=tests, tests_at=tests_at, **how)


def set_case(name, assignment, expect, **how):
    case(name, expect, arguments=["update", "study.toml", "--out", "out", "--set", assignment], **how)


K1 = '{ kind = "normal", mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]'
K2 = '{ kind = "normal", mean = 2.0, std = 0.3 }\n\n[outputs]'


def k1_distribution(name, distribution, expect):
    study_case(name, [(K1, distribution)], ["parameter.1.distribution", *expect], at="distribution = " + distribution)


def truth(*lines):
    return edited(STUDY, ('[outputs]', "\n".join(["[truth]", *lines, "", "[outputs]"])))


# --- keys that nobody knows, at every level -------------------------------------------------------------------------
study_case("unknown key at the top", [('units = "SI"', 'unit = "SI"')],
           ["unit: is not known here", "did you mean 'units'", "Known:"], at="unit = ")
study_case("unknown table at the top", [("[outputs]", "[output]")], ["output", "did you mean 'outputs'"],
           at="[output]")
study_case("unknown key in the model", [("springs = [", "sprigns = [")],
           ["model.sprigns", "did you mean 'springs'"], at="sprigns")
study_case("unknown key in a spring", [('"m1"], stiffness = 1.0', '"m1"], stifness = 1.0')],
           ["model.springs.1.stifness", "did you mean 'stiffness'"], at="stifness")
study_case("unknown key in a parameter", [("bounds = [0.5, 3.0]", "bound = [0.5, 3.0]")],
           ["parameter.1.bound", "did you mean 'bounds'"], at="bound = ")
study_case("unknown key in a distribution", [(K1, '{ kind = "normal", mean = 2.0, std = 0.3, sdt = 1.0 }')],
           ["parameter.1.distribution.sdt", "did you mean 'std'"], at="sdt")
study_case("unknown key in the outputs", [("frequencies = [1, 2, 3]", "frequencies = [1]\nfrequences = [1, 2, 3]")],
           ["outputs.frequences", "did you mean 'frequencies'"], at="frequences")
study_case("unknown key in the shapes", [("frequencies = [1, 2, 3]", 'shapes = { modes = [1], dofs = ["m1"], x = 1 }')],
           ["outputs.shapes.x", "Known: dofs, modes"], at="shapes = ")
study_case("unknown key in the test", [('file = "tests.csv"', 'file = "tests.csv"\nrepeatibility = { f1 = 0.1 }')],
           ["test.repeatibility", "did you mean 'repeatability'"], at="repeatibility")
study_case("unknown key in the update", [("iterations = 30", "iteration = 30")],
           ["update.iteration", "did you mean 'iterations'"], at="iteration = ")
study_case("unknown option of the method", [("weighting =", "weigthing =")],
           ["update.mares", "'weigthing'", "did you mean 'weighting'"], at="weigthing")
study_case("unknown option of a method that is not chosen",
           [("[update.mares]", "[update.deterministic]\nspecimens = 2\n[update.mares]")],
           ["update.deterministic", "'specimens'", "did you mean 'specimen'"], at="specimens = 2")
study_case("unknown key in the correlation", [("[outputs]", "[correlation]\nmatrx = [[1, 0], [0, 1]]\n[outputs]")],
           ["correlation.matrx", "did you mean 'matrix'"], at="matrx")
case("unknown key in the truth", ["truth.specimen", "did you mean 'specimens'"], study=truth("specimen = 10"),
     at="specimen = 10", arguments=["simulate", "study.toml", "--out", "out"])

# --- wrong types ----------------------------------------------------------------------------------------------------
study_case("a text for a number", [("samples = 200", 'samples = "many"')],
           ["update.samples", "many", "whole number", '"auto"'], at='samples = "many"')
study_case("a fraction for a whole number", [("iterations = 30", "iterations = 2.5")],
           ["update.iterations", "2.5", "whole number"], at="iterations = 2.5")
study_case("a number for a text", [('title = "A study for tests"', "title = 3")], ["title", "found 3", "text"],
           at="title = 3")
study_case("a number for a table", [('[test]\nfile = "tests.csv"', ""), ("[model]", "test = 3\n[model]")],
           ["test", "found 3", "table"], at="test = 3")
study_case("a text for a list of modes", [("frequencies = [1, 2, 3]", 'frequencies = "all"')],
           ["outputs.frequencies", "all", "[1, 2, 3]"], at='frequencies = "all"')
study_case("a table for a list of tables", [("[outputs]", "[outputs]"), ("springs = [", "dampers = { c1 = 1.0 }\nsprings = [")],
           ["model.dampers", "list of tables"], at="dampers")
study_case("a list for an option", [('weighting = "mahalanobis"', "model_error = [1]")],
           ["update.mares.model_error", "found [1]"], at="model_error = [1]")
study_case("true for a stiffness", [('name = "k1", between = ["ground", "m1"], stiffness = 1.0',
                                    'name = "k1", between = ["ground", "m1"], stiffness = true')],
           ["model.springs.1.stiffness", "found true", "number >= 0"], at="stiffness = true")

# --- the model ------------------------------------------------------------------------------------------------------
study_case("a negative mass", [("m1 = 1.0", "m1 = -1.0")], ["model.masses.m1", "-1", "> 0"], at="m1 = -1.0")
study_case("a zero mass", [("m1 = 1.0", "m1 = 0.0")], ["model.masses.m1", "found 0", "> 0"], at="m1 = 0.0")
study_case("a mass that is not a number", [("m1 = 1.0", "m1 = nan")], ["model.masses.m1", "nan"], at="m1 = nan")
study_case("an infinite mass", [("m1 = 1.0", "m1 = inf")], ["model.masses.m1", "inf"], at="m1 = inf")
study_case("no masses", [("masses = { m1 = 1.0, m2 = 1.0, m3 = 1.0 }", "masses = {}")],
           ["model.masses", "missing or empty"], at="masses = {}")
study_case("a mass called ground", [("m1 = 1.0,", "ground = 1.0, m1 = 1.0,")], ["model.masses", "'ground'", "choose another"],
           at="masses = ")
study_case("a negative stiffness", [('name = "k6", between = ["m1", "m3"], stiffness = 3.0',
                                    'name = "k6", between = ["m1", "m3"], stiffness = -3.0')],
           ["model.springs.6.stiffness", "-3", ">= 0"], at="stiffness = -3.0")
study_case("a spring to a point that is not there", [('["m1", "m3"]', '["m1", "m4"]')],
           ["model.springs.6.between", "'m4'", "did you mean", "ground, m1, m2, m3"], at='"m4"')
study_case("a spring with both ends on one point", [('["m1", "m3"]', '["m1", "m1"]')],
           ["model.springs.6.between", "'m1'", "acts on nothing"], at='["m1", "m1"]')
study_case("a spring with three ends", [('["m1", "m3"]', '["m1", "m2", "m3"]')],
           ["model.springs.6.between", "two points"], at='["m1", "m2", "m3"]')
study_case("a spring without a name", [('{ name = "k6", ', "{ ")], ["model.springs.6.name", "missing"],
           at='{ between = ["m1", "m3"]')
study_case("two springs of one name", [('name = "k6"', 'name = "k5"')], ["model.springs.6.name", "'k5'", "twice"],
           at='["m1", "m3"]')
study_case("an unknown kind of model", [('"mass-spring"', '"nastrann"')], ["model.kind", "nastrann", "mass-spring"],
           at="nastrann")
study_case("an unknown system of units", [('units = "SI"', 'units = "imperial"')],
           ["units", "imperial", "in-lbf-s", "mm-t-s"], at="imperial")
study_case("no model", [('[model]\nkind = "mass-spring"', "[modell]\nkind = \"mass-spring\"")],
           ["modell", "did you mean 'model'"], at="[modell]")
study_case("a model that is unstable", [("[outputs]", "[outputs]"),
                                        ('target = "spring:k2"\ndistribution = ' + K2,
                                         'target = "spring:k2"\ndistribution = '
                                         '{ kind = "normal", mean = -9.0, std = 0.3 }\n\n[outputs]')],
           [K2_LINE, "'k2'", "-9", "must be > 0"])

# --- parameters -----------------------------------------------------------------------------------------------------
study_case("a parameter that acts on nothing", [('target = "spring:k2"', 'target = "spring:k9"')],
           [K2_LINE, "parameter 'k2'", "acts on nothing", "'spring:k9'", "did you mean 'spring:k"])
study_case("a parameter on an element of the wrong kind", [('target = "spring:k2"', 'target = "damper:k2"')],
           [K2_LINE, "parameter 'k2'", "acts on nothing", "'damper:k2'"])
study_case("a target without a kind", [('target = "spring:k2"', 'target = "k2"')],
           [K2_LINE, "parameter 'k2'", "target 'k2'", "spring:k2"])
study_case("a damper's parameter where no output sees damping",
           [("springs = [", 'dampers = [{ name = "c1", between = ["ground", "m1"], damping = 0.1 }]\nsprings = ['),
            ('target = "spring:k2"', 'target = "damper:c1"')],
           ["parameter 'k2'", "acts on nothing", "damping"])
study_case("two parameters on one element", [('target = "spring:k2"', 'target = "spring:k1"')],
           [K2_LINE, "parameter 'k2'", "'spring:k1'", "already", "'k1'"])
study_case("a factor on a value of zero",
           [('name = "k1", between = ["ground", "m1"], stiffness = 1.0',
             'name = "k1", between = ["ground", "m1"], stiffness = 0.0'),
            ('target = "spring:k1"', 'target = "spring:k1"\nrelative = true')],
           ["parameter 'k1'", "nominal value is 0", "acts on nothing"])
study_case("two parameters of one name", [('name = "k2"\ntarget', 'name = "k1"\ntarget')],
           ["parameter.2.name", "'k1'", "twice"])
study_case("a parameter called status", [('name = "k2"\ntarget', 'name = "status"\ntarget')],
           ["parameter.2.name", "status", "allowed"], at='name = "status"')
study_case("a parameter called like an output", [('name = "k2"\ntarget', 'name = "f2"\ntarget')],
           [K2_LINE, "parameter 'f2'", "output", "choose another"])
study_case("a parameter without a name", [('name = "k2"\ntarget', "target")], ["parameter.2.name", "missing"],
           at=None)
study_case("a parameter without a target", [('target = "spring:k2"\n', "")], ["parameter.2.target", "missing"])
study_case("an empty list of targets", [('target = "spring:k2"', "target = []")], ["parameter.2.target", "text"],
           at="target = []")
study_case("a parameter without a distribution", [('distribution = ' + K2, "\n[outputs]")],
           ["parameter.2.distribution", "missing"])
case("no parameter", ["study.toml", "parameter", "[[parameter]]"],
     study=STUDY[:STUDY.index("[[parameter]]")] + STUDY[STUDY.index("[outputs]"):])
study_case("bounds crossed", [("bounds = [0.5, 3.0]", "bounds = [3.0, 0.5]")],
           ["parameter.1.bounds", "[3.0, 0.5]", "lower first"], at="bounds = [3.0, 0.5]")
study_case("bounds of three numbers", [("bounds = [0.5, 3.0]", "bounds = [0.5, 1, 3.0]")],
           ["parameter.1.bounds", "two numbers"], at="bounds")
study_case("bounds that are no numbers", [("bounds = [0.5, 3.0]", 'bounds = [0.5, "three"]')],
           ["parameter.1.bounds", "three", "numbers"], at="bounds")
study_case("bounds that are nan", [("bounds = [0.5, 3.0]", "bounds = [0.5, nan]")],
           ["parameter.1.bounds", "nan", "numbers"], at="bounds")
study_case("the mean outside the bounds", [("bounds = [0.5, 3.0]", "bounds = [0.5, 1.5]")],
           ["parameter 'k1'", "mean 2", "[0.5, 1.5]"])
study_case("a factor that is no flag", [('target = "spring:k1"', 'target = "spring:k1"\nrelative = "yes"')],
           ["parameter.1.relative", "yes", "true or false"], at="relative")

# --- distributions --------------------------------------------------------------------------------------------------
k1_distribution("an unknown distribution", '{ kind = "gaussian", mean = 2.0, std = 0.3 }',
                ["gaussian", "normal", "truncated-normal"])
k1_distribution("a nearly right distribution", '{ kind = "log-normal", mean = 2.0, std = 0.3 }',
                ["log-normal", 'did you mean "lognormal"'])
k1_distribution("a distribution without kind", "{ mean = 2.0, std = 0.3 }", ["kind", "missing"])
k1_distribution("a distribution without std", '{ kind = "normal", mean = 2.0 }', ["std", "missing"])
k1_distribution("a negative deviation", '{ kind = "normal", mean = 2.0, std = -0.3 }', ["std", "-0.3", "positive"])
k1_distribution("a deviation of zero", '{ kind = "normal", mean = 2.0, std = 0.0 }', ["std", "0", "positive"])
k1_distribution("a mean that is not a number", '{ kind = "normal", mean = nan, std = 0.3 }', ["mean", "nan"])
k1_distribution("an infinite deviation", '{ kind = "normal", mean = 2.0, std = inf }', ["std", "inf", "finite"])
k1_distribution("a value that the distribution does not take", '{ kind = "uniform", lower = 1, upper = 3, mean = 2 }',
                ["mean", "not known here"])
k1_distribution("lognormal with mean 0", '{ kind = "lognormal", mean = 0.0, std = 0.3 }', ["mean", "0", "positive"])
k1_distribution("uniform turned round", '{ kind = "uniform", lower = 3.0, upper = 1.0 }', ["lower", "3", "below", "1"])
k1_distribution("truncated where nothing is left",
                '{ kind = "truncated-normal", mean = 2.0, std = 0.1, lower = 90.0, upper = 91.0 }', ["lower", "[90, 91]"])
k1_distribution("beta with its mean outside", '{ kind = "beta", mean = 4.0, std = 0.1, lower = 1.0, upper = 3.0 }',
                ["mean", "4", "(1, 3)"])
k1_distribution("beta too wide", '{ kind = "beta", mean = 2.0, std = 5.0, lower = 1.0, upper = 3.0 }',
                ["std", "5", "too large", "below 1"])
k1_distribution("gamma with a negative mean", '{ kind = "gamma", mean = -2.0, std = 0.3 }', ["mean", "-2", "positive"])
study_case("a distribution that is almost wholly impossible",
           [(K1, '{ kind = "normal", mean = 1e-9, std = 1.0 }'),
            (K2, '{ kind = "normal", mean = 1e-9, std = 1.0 }\n\n[correlation]\n'
                 'pairs = [{ between = ["k1", "k2"], value = -0.999999999 }]\n\n[outputs]')],
           ["impossible", "<= 0", "mean"])
study_case("a parameter called iteration", [('name = "k2"\ntarget', 'name = "iteration"\ntarget')],
           ["parameter.2.name", "'iteration'"], at='name = "iteration"')

# --- correlation ----------------------------------------------------------------------------------------------------
def correlation_case(name, lines, expect, **how):
    study_case(name, [("[outputs]", "[correlation]\n" + lines + "\n\n[outputs]")], ["correlation", *expect], **how)


correlation_case("a correlation that is not positive definite", "matrix = [[1.0, 1.0], [1.0, 1.0]]",
                 ["not positive definite"], at="[correlation]")
correlation_case("a correlation that is not symmetric", "matrix = [[1.0, 0.5], [0.4, 1.0]]",
                 ["not symmetric", "0.5", "0.4"], at="[correlation]")
correlation_case("a correlation above 1", 'pairs = [{ between = ["k1", "k2"], value = 1.5 }]',
                 ["correlation.pairs.1.value", "1.5", "<= 1"], at="1.5")
correlation_case("a correlation of an unknown parameter", 'pairs = [{ between = ["k1", "k5"], value = 0.5 }]',
                 ["'k5'", "Known: k1, k2"], at="pairs = ")
correlation_case("a correlation matrix of the wrong size", "matrix = [[1.0]]", ["2 rows of 2 numbers"], at="matrix")
correlation_case("a correlation matrix with a text", 'matrix = [[1.0, "a"], [0.4, 1.0]]', ["2 rows of 2 numbers"],
                 at="matrix")
correlation_case("a correlation both ways", 'matrix = [[1, 0], [0, 1]]\npairs = []', ["matrix", "pairs"])
correlation_case("a pair given twice",
                 'pairs = [{ between = ["k1", "k2"], value = 0.5 },\n  { between = ["k2", "k1"], value = 0.1 }]',
                 ["correlation.pairs.2", "twice"], at='["k2", "k1"]')

# --- outputs --------------------------------------------------------------------------------------------------------
study_case("an output that the model does not have", [("[1, 2, 3]", "[1, 2, 4]")],
           ["outputs.frequencies", "mode 4", "1 to 3"], at="frequencies")
study_case("mode number zero", [("[1, 2, 3]", "[0, 1, 2]")], ["outputs.frequencies", ">= 1"], at="[0, 1, 2]")
study_case("a mode number that is a fraction", [("[1, 2, 3]", "[1.5]")], ["outputs.frequencies", "1.5", ">= 1"],
           at="[1.5]")
study_case("a repeated output", [("[1, 2, 3]", "[1, 2, 2]")], ["outputs.frequencies", "mode 2", "twice"],
           at="frequencies")
study_case("no output", [("frequencies = [1, 2, 3]", "frequencies = []")], ["outputs", "frequencies = [1, 2]"],
           at="[outputs]")
study_case("a shape at a point that is not there",
           [("[1, 2, 3]", '[1, 2, 3]\nshapes = { modes = [1], dofs = ["m9"] }')],
           ["outputs.shapes.dofs", "'m9'", "m1, m2, m3"], at="shapes")
study_case("a shape at one point twice",
           [("[1, 2, 3]", '[1, 2, 3]\nshapes = { modes = [1], dofs = ["m1", "m1"] }')],
           ["outputs.shapes.dofs", "'m1'", "twice"], at="shapes")
study_case("shapes without points", [("[1, 2, 3]", "[1, 2, 3]\nshapes = { modes = [1] }")],
           ["outputs.shapes.dofs", "missing"], at="shapes")
study_case("damping of a model without dampers", [("[1, 2, 3]", "[1, 2, 3]\ndamping = [1]")],
           ["outputs.damping", "no damper"], at="damping")
study_case("an unknown way of tracking", [("[1, 2, 3]", '[1, 2, 3]\ntracking = "macc"')],
           ["outputs.tracking", "macc", '"order" | "mac"', 'did you mean "mac"'], at="tracking")
study_case("a MAC above 1", [("[1, 2, 3]", "[1, 2, 3]\nminimum_mac = 1.5")], ["outputs.minimum_mac", "1.5", "<= 1"],
           at="minimum_mac")

# --- the test file --------------------------------------------------------------------------------------------------
tests_case("a wrong header", TESTS.replace("f1,f2,f3", "freq1,f2,f3"), ["'freq1'", "Known: f1, f2, f3"], tests_at=1)
tests_case("no header", TESTS.split("\n", 1)[1], ["has no line with the names of the columns", 'pairing = "frequency"'],
           tests_at=1)
tests_case("no column for an output", "\n".join(line.rsplit(",", 1)[0] for line in TESTS.splitlines()),
           ["'f3'", "no column"], tests_at=1)
tests_case("a column twice", TESTS.replace("f1,f2,f3", "f1,f1,f3"), ["'f1'", "twice"], tests_at=1)
tests_case("a column without a name", TESTS.replace("f1,f2,f3", "f1,,f3"), ["column 2", "name"], tests_at=1)
tests_case("no rows", "f1,f2,f3\n", ["no specimen"])
tests_case("only empty rows", "f1,f2,f3\n,,\nnan,nan,nan\n", ["no specimen"])
tests_case("an empty file", "", ["is empty", "header"])
tests_case("a text where a number should be", edited(TESTS, ("0.3080098662667982", "abc")),
           ["column 'f2'", "'abc'", "not a finite number"], tests_at=3)
tests_case("a decimal comma", edited(TESTS, ("0.3080098662667982", "0,3080098662667982")), ["4 cells", "3 columns"],
           tests_at=3)
tests_case("a number with a unit", edited(TESTS, ("0.3080098662667982", "0.308 Hz")), ["column 'f2'", "'0.308 Hz'"],
           tests_at=3)
for value in ("0", "-0.3080098662667982"):
    tests_case(f"a frequency of {value}", edited(TESTS, ("0.3080098662667982", value)), ["column 'f2'", "greater than 0"],
               tests_at=3)
tests_case("an infinite value", edited(TESTS, ("0.3080098662667982", "inf")), ["column 'f2'", "'inf'"], tests_at=3)
tests_case("a number too large for a computer", edited(TESTS, ("0.3080098662667982", "1e999")),
           ["column 'f2'", "'1e999'"], tests_at=3)
tests_case("a ragged row", edited(TESTS, ("0.3080098662667982,", "")), ["2 cells", "3 columns"], tests_at=3)
tests_case("a quote that is not closed", edited(TESTS, ("0.3080098662667982", '"0.308')), ["quoted", "not closed"],
           tests_at=3)
tests_case("a frequency that is too large to be squared", edited(TESTS, ("0.3080098662667982", "1e308")),
           ["column 'f2'", "1e+308", "other units"], tests_at=3)
tests_case("binary junk", bytes(range(255, 0, -1)) * 8, ["0xFF", "UTF-8"], tests_at=1)
tests_case("binary zeros", b"\0" * 4096, ["0x00", "plain text"], tests_at=1)
tests_case("a test file in UTF-16", TESTS.encode("utf-16"), ["0xFF", "UTF-8"], tests_at=1)
tests_case("a test file that is not UTF-8", edited(TESTS, ("0.3080098662667982", "gemäß")).encode("latin-1"),
           ["0xE4", "UTF-8"], tests_at=3)
tests_case("an output never measured", "\n".join(line.rsplit(",", 1)[0] + ("," if i else ",f3")
                                               for i, line in enumerate(TESTS.splitlines())),
           ["'f3'", "never measured", "[outputs]"])
case("an output measured once", ["study.toml:31: test: ", "'f3'", "measured once"],
     tests="\n".join(line if i < 2 else line.rsplit(",", 1)[0] + "," for i, line in enumerate(TESTS.splitlines())))


def in_unit(factor):
    """The good tests with their frequencies times a factor."""
    header, *rows = TESTS.splitlines()
    return "\n".join([header] + [",".join(f"{float(value) * factor!r}" for value in row.split(",")) for row in rows])


for verb in ("check", "update", "diagnose"):
    tests_case(f"frequencies in rad/s: {verb}", in_unit(6.283185307179586),
               ["times the model's", "2 pi", "rad/s", "f1 1.0", "against 0.2"], arguments=[verb, "study.toml"]
               + ([] if verb == "check" else ["--out", "out"]))
tests_case("frequencies divided by 2 pi", in_unit(0.15915494309189535), ["1/(2 pi)", "divided by 2 pi twice"])
tests_case("frequencies in mHz", in_unit(1000.0), ["near 1000", "mHz"])
tests_case("frequencies in kHz", in_unit(0.001), ["near 1/1000", "kHz"])
tests_case("frequencies in rad/s with gaps", "\n".join(
    line if i % 2 else line.rsplit(",", 1)[0] + "," for i, line in enumerate(in_unit(6.283185307179586).splitlines())
    ).replace("f1,f2,", "f1,f2,f3"), ["2 pi"])
study_case("one specimen for mares", [], ["1 specimen", "at least 2", "deterministic"], at="method = ",
           tests="\n".join(TESTS.splitlines()[:2]))
study_case("fewer specimens than outputs", [], ["covariance", "3 outputs", "3 specimens", "singular", "more specimens"],
           at="[test]", tests="\n".join(TESTS.splitlines()[:4]))
study_case("a test covariance that is singular", [], ["covariance", "singular", "leave outputs out"], at="[test]",
           tests="f1,f2,f3\n" + "".join(f"{v},{2 * v},0.4{i}\n" for i, v in
                                        enumerate((0.1, 0.2, 0.3, 0.4, 0.5, 0.6))))
study_case("specimens that are all the same", [], ["covariance", "singular"], at="[test]",
           tests="f1,f2,f3\n" + "0.1,0.2,0.3\n" * 6)
study_case("no scatter for the Euclidean weight", [('"mahalanobis"', '"euclidean"')], ["singular"],
           at="[test]", tests="f1,f2,f3\n" + "0.125,0.25,0.5\n" * 6)
study_case("one output without scatter", [], ["singular"], at="[test]",
           tests="\n".join(line if i == 0 else "0.125," + line.split(",", 1)[1]
                           for i, line in enumerate(TESTS.splitlines())))
study_case("no scatter but for rounding", [('"mahalanobis"', '"euclidean"')], ["singular"],
           at="[test]", tests="f1,f2,f3\n" + "0.1,0.2,0.3\n" * 6)
study_case("more unknowns than data", [("[1, 2, 3]", "[1]")], ["2 parameters", "more unknowns", "1 measured output"],
           at="method = ")
study_case("too few samples for the regression", [("samples = 200", "samples = 3")],
           ["update.samples", "3", "at least 4"], at="samples = 3")
study_case("a control character in a parameter's name", [('name = "k1"\ntarget', 'name = "k1\\u001b[31m"\ntarget')],
           ["parameter.1.name", "control characters"], at="u001b")
study_case("a control character in a mass's name", [("m1 = 1.0", '"m\\n1" = 1.0')], ["model.masses", "control characters"])
study_case("no test file", [('"tests.csv"', '"missing.csv"')], ["test.file", "missing.csv", "no such file"],
           at="missing.csv")
study_case("a folder in place of the test file", [('"tests.csv"', '"."')], ["test.file", "folder"], at='file = "."')
study_case("a key of 60,000 parts", [('[test]', "[" + ".".join("a" * 60000) + "]\n[test]")], ["key of more than 1000 parts"])
study_case("the model's error to be estimated from as many outputs as parameters",
           [('method = "mares"', 'method = "maximum-likelihood"'), ('[test]\n', '[test]\nmodel_error = "estimated"\n'),
            ("[1, 2, 3]", "[1, 2]")],
           ["test.model_error", "cannot be estimated"], at="model_error")
study_case("no test", [('[test]\nfile = "tests.csv"', "")], ["test: is missing", "[test]"], is_checked=False)
study_case("a logarithm of a parameter that is not positive",
           [(K2, '{ kind = "normal", mean = -2.0, std = 0.3 }\nscale = "log"\n\n[outputs]')],
           ["parameter.2.scale", '"log"', "mean is -2", "identity"], at='scale = "log"')
study_case("a logit without bounds", [(K2, '{ kind = "normal", mean = 2.0, std = 0.3 }\nscale = "logit"\n\n[outputs]')],
           ["parameter.2.scale", '"logit"', "bounds", "missing"], at='scale = "logit"')
study_case("a scale that nobody knows", [("bounds = [0.5, 3.0]", 'bounds = [0.5, 3.0]\nscale = "lg"')],
           ["parameter.1.scale", "lg", '"identity" | "log" | "logit"'], at='scale = "lg"')
study_case("a covariance that is none", [("samples = 200", 'samples = 200\ncovariance = "diag"')],
           ["update.covariance", "diag", '"diagonal"', '[["k1", "k2"], ["k5"]]'], at='covariance = "diag"')
study_case("covariance groups of unknown parameters", [("samples = 200", 'samples = 200\ncovariance = [["k1", "k9"]]')],
           ["update.covariance", "'k9'", "k1, k2"], at="covariance = ")
study_case("a parameter in two covariance groups", [("samples = 200", 'samples = 200\ncovariance = [["k1"], ["k1", "k2"]]')],
           ["update.covariance", "'k1' is given twice"], at="covariance = ")
study_case("repeatability by a pattern that fits nothing", [('"tests.csv"', '"tests.csv"\nrepeatability = { "g*" = 0.001 }')],
           ["test.repeatability", "'g*' fits no output", "f1, f2, f3"], at="repeatability")
study_case("repeatability in something other than per cent",
           [('"tests.csv"', '"tests.csv"\nrepeatability = { f1 = "1 Hz" }')],
           ["test.repeatability.f1", "1 Hz", '"1 %"'], at="repeatability")
study_case("repeatability from a file that is not there", [('"tests.csv"', '"tests.csv"\nrepeatability = "repeats.csv"')],
           ["test.repeatability", "repeats.csv"], at="repeatability")
case("repeats of nothing", ["repeats.csv", "'f1'", "measured twice on no specimen"],
     study=edited(STUDY, ('"tests.csv"', '"tests.csv"\nrepeatability = "repeats.csv"')),
     files={"repeats.csv": "specimen,f1,f2,f3\na,0.1,0.2,0.3\nb,0.1,0.2,0.3\n"})
case("noise of the truth by a pattern that fits nothing", ["truth.noise", "'g*' fits no output"],
     study=truth('noise = { "g*" = 0.001 }'), arguments=["simulate", "study.toml", "--out", "out"])
study_case("repeatability of an unknown output", [('"tests.csv"', '"tests.csv"\nrepeatability = { f9 = 0.001 }')],
           ["test.repeatability", "'f9'", "f1, f2, f3"], at="repeatability")
study_case("a negative repeatability", [('"tests.csv"', '"tests.csv"\nrepeatability = { f1 = -0.001 }')],
           ["test.repeatability.f1", "-0.001", ">= 0"], at="repeatability")
case("a test file below a regular file", ["study.toml/x.csv"], study=edited(STUDY, ('"tests.csv"', '"study.toml/x.csv"')))

# --- the update -----------------------------------------------------------------------------------------------------
study_case("an unknown method", [('method = "mares"', 'method = "marres"')],
           ["update.method", "marres", "mares", "deterministic", 'did you mean "mares"'], at="marres")
study_case("an unknown value of an option", [('"mahalanobis"', '"mahalonobis"')],
           ["update.mares", "weighting", "mahalonobis", '"mahalanobis" | "euclidean"'], at="mahalonobis")
study_case("an option out of range", [('weighting = "mahalanobis"', "model_error = -0.1")],
           ["update.mares", "model_error", "-0.1", ">= 0"], at="model_error")
study_case("one sample", [("samples = 200", "samples = 1")], ["update.samples", "found 1", ">= 2"], at="samples = 1")
study_case("a huge number of samples", [("samples = 200", "samples = 1000000000000")],
           ["update.samples", "1000000000000", "<= "], at="samples = ")
study_case("no iterations", [("iterations = 30", "iterations = 0")], ["update.iterations", "found 0", ">= 1"],
           at="iterations = 0")
study_case("a number beyond 64 bits", [("samples = 200", "samples = 99999999999999999999")], ["TOML"], at="samples = ")
study_case("an unknown sampling", [("samples = 200", 'samples = 200\nsampling = "lhs"')],
           ["update.sampling", "lhs", "latin-hypercube"], at="sampling = ")
study_case("a level above a half", [("samples = 200", "samples = 200\nlevel = 0.9")],
           ["update.level", "0.9", "<= 0.5"], at="level")
study_case("a tolerance of zero", [("samples = 200", "samples = 200\ntolerance = 0")],
           ["update.tolerance", "found 0", "> 0"], at="tolerance")
study_case("a negative seed", [("seed = 7", "seed = -7")], ["seed", "-7", ">= 0"], at="seed = -7")
study_case("a specimen that is not there",
           [('method = "mares"', 'method = "deterministic"'),
            ("[update.mares]", "[update.deterministic]\nspecimen = 7\n[update.mares]")],
           ["update.deterministic.specimen", "7", "1 to 6"], at="specimen = 7")
study_case("more unknowns than data without regularisation",
           [('method = "mares"', 'method = "deterministic"'), ("[1, 2, 3]", "[1]"),
            ("[update.mares]", '[update.deterministic]\nregularisation = "none"\n[update.mares]')],
           ["2 parameters", "more unknowns", "bayesian"])

# --- the study file as a file ---------------------------------------------------------------------------------------
study_case("not TOML", [("[outputs]", "[outputs")], ["not valid TOML"], at="[outputs")
study_case("a key twice", [("seed = 7", "seed = 7\nseed = 8")], ["not valid TOML", "seed"], at="seed = 8")
case("an empty study", ["study.toml", "model", "missing"], study="")
case("a study that is not UTF-8", ["study.toml:1: ", "0xE9", "UTF-8"], study=b'title = "caf\xe9"\n' +
     STUDY.split("\n", 1)[1].encode())
case("a study of binary junk", ["study.toml:1: ", "0x00", "plain text"], study=bytes(range(256)) * 16)
case("a study that is deeply nested", ["study.toml:1: ", "not valid TOML", "nest"], study="a = " + "[" * 100000)
case("a study with deeply nested tables", ["study.toml:1: ", "TOML"], study="a = " + "{b=" * 100000)
case("a study with a deeply dotted key", ["study.toml"], study="a" + ".a" * 20000 + " = 1\n" + STUDY)
case("no such study", ["nothing.toml", "no such file"], arguments=["update", "nothing.toml", "--out", "out"])
case("a folder in place of the study", ["folder", "file is needed"], arguments=["update", ".", "--out", "out"])
case("a study below a regular file", ["tests.csv/study.toml", "no such file"],
     arguments=["update", "tests.csv/study.toml", "--out", "out"])
case("a study that cannot be read", ["/proc/self/mem", "reading failed"], code=3,
     arguments=["update", "/proc/self/mem", "--out", "out"])
case("a study that never ends", ["/dev/zero", "regular file"], arguments=["update", "/dev/zero", "--out", "out"])


def pattern_case(name, pattern, expect):
    study = support.command_study(["true"]).replace('format = "column"', f'format = "regex"\npattern = {pattern}')
    case(name, ["study.toml", "pattern", *expect], study=study, at="pattern = ")


pattern_case("a pattern that is none", '"f = (+"', ["no regular expression", "+"])
pattern_case("a pattern with a back reference", "'(a)\\1'", ["no regular expression", "\\1"])
pattern_case("a pattern that looks ahead", "'(?=a)(b)'", ["no regular expression", "(?="])
pattern_case("a pattern without a group", '"f = .*"', ["no group", "parentheses"])
pattern_case("a pattern without end", "'" + "(a{1000}){1000}" * 2000 + "'", ["no regular expression"])
case("the test file in place of the study", ["tests.csv:1: ", "not valid TOML"],
     arguments=["update", "tests.csv", "--out", "out"])

# --- the command line -----------------------------------------------------------------------------------------------
set_case("--set without =", "seed", ["--set seed", "dotted.key=value"])
set_case("--set without a key", "=3", ["--set =3", "dotted.key=value"])
set_case("--set with an empty step", "update..samples=3", ["--set update..samples=3", "empty step"])
set_case("--set without a value", "seed=", ["--set seed=", "TOML value"])
set_case("--set with a value that is not TOML", "title=[1", ["--set title=[1", "not a TOML value"])
set_case("--set on an entry that is not there", "parameter.k9.bounds=[1, 2]", ["'parameter'", "no entry", "'k9'", "k1, k2"])
set_case("--set into a value", "seed.x=3", ["--set seed.x=3", "not a table"])
set_case("--set of an unknown key", "update.sampels=3", ["update.sampels", "did you mean 'samples'", "--set"])
set_case("--set of a wrong type", "update.samples=many", ["update.samples", "many", "whole number", "--set"])
set_case("--set of a second value", "seed=3\nunits='SI'", ["--set seed=3", "one TOML value"])
case("--threads 0", ["--threads", "0"], arguments=["update", "study.toml", "--threads", "0"], is_usage=True)
case("--threads that is no number", ["--threads", "all"], arguments=["update", "study.toml", "--threads", "all"],
     is_usage=True)
case("a seed below zero", ["--seed", "-1"], arguments=["update", "study.toml", "--seed", "-1"], is_usage=True)
case("an unknown verb", ["updaet"], arguments=["updaet", "study.toml"], is_usage=True)
case("an unknown option", ["--ouput"], arguments=["update", "study.toml", "--ouput", "out"], is_usage=True)
case("no verb", ["ubcommand"], arguments=["--"], is_usage=True)
case("no study", ["STUDY"], arguments=["update"], is_usage=True)
case("two studies", ["study.toml"], arguments=["update", "study.toml", "study.toml"], is_usage=True)
case("results below a regular file", ["tests.csv/out", "cannot be made"],
     arguments=["update", "study.toml", "--out", "tests.csv/out"])
case("results in place of a regular file", ["tests.csv", "cannot be made"],
     arguments=["update", "study.toml", "--out", "tests.csv"])
case("results in /proc", ["/proc/mottle", "cannot be made"],
     arguments=["update", "study.toml", "--out", "/proc/mottle"])
case("results in /sys", ["/sys", "--out"], arguments=["update", "study.toml", "--out", "/sys"])
case("results below /sys", ["/sys/mottle/out", "cannot be made"],
     arguments=["update", "study.toml", "--out", "/sys/mottle/out"])
case("results below a device", ["/dev/full/out", "cannot be made"],
     arguments=["update", "study.toml", "--out", "/dev/full/out"])
case("results below a name that is too long", ["xxx", "cannot be made"],
     arguments=["update", "study.toml", "--out", 300 * "x"])
case("propagate into /proc", ["/proc/mottle", "cannot be made"],
     arguments=["propagate", "study.toml", "--out", "/proc/mottle"])
case("simulate into /proc", ["/proc/mottle", "cannot be made"], study=truth("specimens = 3"),
     arguments=["simulate", "study.toml", "--out", "/proc/mottle"])

# --- simulate, propagate, check, report -----------------------------------------------------------------------------
case("simulate without a truth", ["study.toml", "truth", "missing", "[truth]"],
     arguments=["simulate", "study.toml", "--out", "out"])
case("simulate no specimen", ["truth.specimens", "found 0", ">= 1"], study=truth("specimens = 0"),
     at="specimens = 0", arguments=["simulate", "study.toml", "--out", "out"])
case("noise of an unknown output", ["truth.noise", "'f9'", "f1, f2, f3"], study=truth("noise = { f9 = 0.1 }"),
     arguments=["simulate", "study.toml", "--out", "out"])
case("negative noise", ["truth.noise.f1", "-0.1", ">= 0"], study=truth("noise = { f1 = -0.1 }"), at="noise",
     arguments=["simulate", "study.toml", "--out", "out"])
case("a truth that acts on nothing", ["parameter 'k9'", "spring:k9"], arguments=["simulate", "study.toml", "--out", "out"],
     study=STUDY + '[truth]\n[[truth.parameter]]\nname = "k9"\ntarget = "spring:k9"\n'
                   'distribution = { kind = "normal", mean = 1.0, std = 0.2 }\n')


def points_case(name, points, expect, at=None):
    place = ["points.csv" + (f":{at}: " if at else "")]
    case(name, place + expect, files={"points.csv": points},
         arguments=["propagate", "study.toml", "--points", "points.csv", "--out", "out"])


points_case("points of an unknown parameter", "k1,k3\n1,2\n", ["'k3'", "k1, k2"], at=1)
points_case("points without a parameter", "k1\n1\n", ["'k2'", "no column"], at=1)
points_case("points without a row", "k1,k2\n", ["no point"])
points_case("points without a value", "k1,k2\n1,2\n1,\n", ["no value"], at=3)
points_case("points that are impossible", "k1,k2\n1,2\n\n1,-2\n", ["<= 0", "impossible"], at=4)
points_case("points with a text", "k1,k2\n1,two\n", ["column 'k2'", "'two'"], at=2)
points_case("points in an empty file", "", ["is empty"])
case("no points file", ["points.csv", "no such file"],
     arguments=["propagate", "study.toml", "--points", "points.csv", "--out", "out"])
case("a check of a test file that is not there", ["missing.csv", "no such file"],
     study=edited(STUDY, ("tests.csv", "missing.csv")), arguments=["check", "study.toml"])
case("a report of a folder that is not there", ["nothing", "no such"], arguments=["report", "nothing"])
case("a report of a folder without results", ["result.json", "no such file"], arguments=["report", "."])


def report_case(name, result, expect, **files):
    case(name, expect, files={"results/result.json": result, **{f"results/{k}.csv": v for k, v in files.items()}},
         arguments=["report", "results"])


NAMES = '{"schema": 1, "parameters": {"names": ["k1"]}}'
report_case("a report of a cut result", '{"schema": 1,\n "par', ["result.json:2: ", "not valid JSON", "again"])
report_case("a report of an empty result", "", ["result.json", "not valid JSON"])
report_case("a report of something else", "[1, 2]", ["result.json", "not a result", "parameters.names"])
report_case("a report of another JSON", '{"parameters": 3}', ["result.json", "parameters.names"])
report_case("a report of a result that is not UTF-8", b'{"title": "\xff"}', ["result.json:1: ", "not valid JSON"])
report_case("a report of a result that is deeply nested", "[" * 200000, ["result.json: ", "nested deeper than 100 levels"])
report_case("a report of a result that is nested and closed", '{"a": ' + '{"a": ' * 200000 + "1" + "}" * 200001,
            ["result.json: ", "nested deeper than 100 levels"])
report_case("a report of a result with a number beyond all", '{"a": 1e999}', ["result.json: ", "1e999", "again"])
case("a report with modes of another file", ["modes.json: ", "not a list of modes", "again"],
     files={"results/result.json": NAMES, "results/modes.json": "[]"}, arguments=["report", "results"])
report_case("a report with clouds of another run", NAMES, ["clouds.csv", "fit"], clouds="iteration,f1\n0,1\n")
report_case("a report with clouds of junk", NAMES, ["clouds.csv:2: "], clouds="iteration,k1,f1\n0,a,1\n")
report_case("a report with tests that are not UTF-8", NAMES, ["tests.csv"], tests=b"f\xff\n1\n")


class ErrorsTest(support.CommandTest):
    """One test a case, made below."""

    @staticmethod
    def messages(err):
        """Without the progress that a slow machine has come to show."""
        return [line for line in err.splitlines() if not re.match(r"(reading|cloud|iteration|training|writing)\b", line)]

    def check(self, wrong):
        self.write("study.toml", wrong.study)
        self.write("tests.csv", wrong.tests)
        for name, content in wrong.files.items():
            self.write(name, content)
        before = sorted(str(path) for path in self.folder.rglob("*"))
        start = time.monotonic()
        ended = self.call(*wrong.arguments, timeout=20)
        took = time.monotonic() - start
        if os.environ.get("MOTTLE_SHOW"):
            print(f"\n[{wrong.name}] exit {ended.code}\n{ended.err.rstrip()}")
        self.assertEqual(ended.code, wrong.code, ended.err)
        self.assertLess(took, 5.0 * support.PATIENCE)
        self.assertEqual(ended.out, "", "nothing belongs on stdout")
        lines = self.messages(ended.err)
        if not wrong.is_usage:
            self.assertEqual(len(lines), 1, "one message: " + ended.err)
            self.assertTrue(lines[0].startswith("mottle: "), ended.err)
            self.assertLess(len(ended.err), 600, "a message is read by a person")
            self.assertTrue(all(c.isprintable() for c in lines[0]), ascii(ended.err))
        for fragment in wrong.expect:
            self.assertIn(fragment, ended.err)
        for trace in ("terminate called", "what()", "Sanitizer", "a bug of Mottle", "std::", "./src/"):
            self.assertNotIn(trace, ended.err)
        if wrong.arguments[0] == "update" and wrong.code == 2 and wrong.is_checked and not wrong.is_usage:
            checked = self.call("check", *wrong.arguments[1:], timeout=20)
            self.assertEqual((checked.code, self.messages(checked.err)), (2, lines), "check refuses what update refuses")
        self.assertEqual(before, sorted(str(path) for path in self.folder.rglob("*")), "a wrong input leaves no files")


def add_tests():
    names = set()
    for number, wrong in enumerate(CASES, 1):
        name = "".join(c if c.isalnum() else "_" for c in wrong.name)
        if name in names:
            raise AssertionError(f"two cases are called {wrong.name!r}")
        names.add(name)
        setattr(ErrorsTest, f"test_{number:03}_{name}", lambda self, wrong=wrong: self.check(wrong))


add_tests()

if __name__ == "__main__":
    support.main()
