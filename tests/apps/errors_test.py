"""A wrong input gives one message on stderr, exit code 2 and no files. What update refuses, check refuses with the same
words. One case of each part that refuses; which inputs are refused, and in what words, is in tests/study.

    python3 errors_test.py PATH_TO_MOTTLE          MOTTLE_SHOW=1 prints each message
"""

import os
import re
import resource

import support
from support import STUDY, TESTS, edited, line_of

CASES = []


class Case:
    """One wrong input and what its message must hold."""

    def __init__(self, name, expect, *, study=STUDY, tests=TESTS, files=None, arguments=None, at=None,
                 is_usage=False, code=2, is_checked=True):
        self.name = name
        self.expect = list(expect)
        self.study = study
        self.tests = tests
        self.files = files or {}
        self.arguments = arguments or ["update", "study.toml", "--out", "out"]
        self.is_usage = is_usage
        self.code = code
        self.is_checked = is_checked  # whether `check` can know it
        if at is not None:
            self.expect.append(f"study.toml:{line_of(study, at)}: ")


def case(name, expect, **how):
    CASES.append(Case(name, expect, **how))


def study_case(name, changes, expect, at=None, **how):
    """The good study with `changes` [(old, new), ...]; `at` is text on the line that the message must name."""
    case(name, ["study.toml", *expect], study=edited(STUDY, *changes), at=at, **how)


def set_case(name, assignment, expect, **how):
    case(name, expect, arguments=["update", "study.toml", "--out", "out", "--set", assignment], **how)


def truth(*lines):
    return edited(STUDY, ('[outputs]', "\n".join(["[truth]", *lines, "", "[outputs]"])))


# --- one case of each part that refuses ----------------------------------------------------------------------------
study_case("not TOML", [("[outputs]", "[outputs")], ["not valid TOML"], at="[outputs")
study_case("unknown key in the outputs", [("frequencies = [1, 2, 3]", "frequencies = [1]\nfrequences = [1, 2, 3]")],
           ["outputs.frequences", "did you mean 'frequencies'"], at="frequences")
study_case("a parameter that acts on nothing", [('target = "spring:k2"', 'target = "spring:k9"')],
           ["parameter 'k2'", "acts on nothing", "'spring:k9'", "did you mean 'spring:k"])
study_case("a control character in a parameter's name", [('name = "k1"\ntarget', 'name = "k1\\u001b[31m"\ntarget')],
           ["parameter.1.name", "control characters"], at="u001b")
study_case("fewer specimens than outputs", [], ["covariance", "3 outputs", "3 specimens", "singular", "more specimens"],
           at="[test]", tests="\n".join(TESTS.splitlines()[:4]))
study_case("no test", [('[test]\nfile = "tests.csv"', "")], ["test: is missing", "[test]"], is_checked=False)
case("a number with a unit", ["tests.csv:3: ", "column 'f2'", "'0.308 Hz'"],
     tests=edited(TESTS, ("0.3080098662667982", "0.308 Hz")))
case("binary junk", ["tests.csv:1: ", "0xFF", "UTF-8"], tests=bytes(range(255, 0, -1)) * 8)
case("a study of binary junk", ["study.toml:1: ", "0x00", "plain text"], study=bytes(range(256)) * 16)
case("a study that is deeply nested", ["study.toml:1: ", "not valid TOML", "nest"], study="a = " + "[" * 100000)
case("a study with a deeply dotted key", ["study.toml"], study="a" + ".a" * 20000 + " = 1\n" + STUDY)
case("a study that cannot be read", ["/proc/self/mem", "reading failed"], code=3,
     arguments=["update", "/proc/self/mem", "--out", "out"])
case("a study that never ends", ["/dev/zero", "regular file"], arguments=["update", "/dev/zero", "--out", "out"])
case("tests in another unit: diagnose", ["times the model's", "2 pi", "rad/s"], arguments=["diagnose", "study.toml", "--out", "out"],
     tests="f1,f2,f3\n1.11,1.97,2.83\n0.99,1.94,2.80\n1.04,2.08,2.82\n0.97,1.86,2.84\n1.05,2.21,2.89\n1.03,2.12,2.87\n")
case("simulate without a truth", ["study.toml", "truth", "missing", "[truth]"],
     arguments=["simulate", "study.toml", "--out", "out"])
case("points that are impossible", ["points.csv:4: ", "<= 0", "impossible"], files={"points.csv": "k1,k2\n1,2\n\n1,-2\n"},
     arguments=["propagate", "study.toml", "--points", "points.csv", "--out", "out"])
case("targets of a deck that is not there", ["none.bdf"], arguments=["targets", "none.bdf"])
case("a check of a test file that is not there", ["missing.csv", "no such file"],
     study=edited(STUDY, ("tests.csv", "missing.csv")), arguments=["check", "study.toml"])

# --- the command line -----------------------------------------------------------------------------------------------
set_case("--set of an unknown key", "update.sampels=3", ["update.sampels", "did you mean 'samples'", "--set"])
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

# --- report ---------------------------------------------------------------------------------------------------------
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
        before_cpu = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        ended = self.call(*wrong.arguments, timeout=20)
        took = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before_cpu  # of the processor: other work is no fault
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
