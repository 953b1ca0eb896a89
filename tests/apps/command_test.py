"""Any solver by its command, as a user meets it: results, faults of the study, kill and resume, reuse.

    python3 command_test.py PATH_TO_MOTTLE
"""

import json
import math
import signal
import subprocess
import time
import unittest

import support
from support import edited, numbers, read_result

SOLVER = """\
import math, sys
k1, k2 = (float(word) for word in open("in.txt").read().split())
with open("LOG", "a") as log:
    log.write(f"{k1} {k2}\\n")
mean, half = (k1 + 2 * k2) / 2, math.sqrt(k1 * k1 / 4 + k2 * k2)
print("FREQUENCIES")
for value in (mean - half, mean + half):
    print(math.sqrt(value) / (2 * math.pi))
"""

AWK_SOLVER = """\
{ k[NR] = $1 }
END {
  mean = (k[1] + 2 * k[2]) / 2
  half = sqrt(k[1] * k[1] / 4 + k[2] * k[2])
  printf "FREQUENCIES\\n%.12e\\n%.12e\\n", sqrt(mean - half) / 6.283185307179586, sqrt(mean + half) / 6.283185307179586
}
"""

STUDY = """\
title = "Two masses in a row"
seed = 3

[model]
kind = "command"
templates = ["in.txt.template"]
files = ["solver.py"]
command = ["python3", "-S", "-E", "solver.py"]
timeout = "20 s"
parallel = 2

[model.frequencies]
file = "stdout.txt"
format = "column"
after = "FREQUENCIES"
column = 1

""" + support.two_masses(samples=16, iterations=2)


class AnySolverTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.log = self.folder / "runs.log"
        self.write("solver.py", SOLVER.replace("LOG", str(self.log)))
        self.write("in.txt.template", "{{k1}}\n{{k2:%20.14e}}\n")
        self.write("study.toml", STUDY)
        self.write("tests.csv", support.TWO_MASSES_TESTS)

    def runs(self):
        return self.log.read_text().splitlines() if self.log.exists() else []

    def test_check_runs_once_and_leaves_nothing(self):
        before = {path.name for path in self.folder.iterdir()}
        out = self.succeed("check", "study.toml").out
        self.assertEqual(len(self.runs()), 1)
        # lambda = (3 -+ sqrt 5) / 2 k for two equal springs and masses of 1 kg
        self.assertIn(f"{(3 - 5 ** 0.5) ** 0.5 / 6.283185307179586:.7f}"[:7], out)
        self.assertEqual({path.name for path in self.folder.iterdir()} - before, {"runs.log"})

    def test_check_says_how_many_runs_the_update_of_a_linear_model_takes(self):
        self.write("solver.py", (
            'k1, k2 = (float(word) - 2.0 for word in open("in.txt").read().split())\n'
            f'open({str(self.log)!r}, "a").write("run\\n")\n'
            'print("FREQUENCIES")\nprint(1.0 + 0.1 * k1 + 0.02 * k2)\nprint(3.0 + 0.05 * k1 + 0.2 * k2)\n'))
        moved = [(0.1, -0.2), (-0.15, 0.1), (0.3, 0.25), (-0.2, -0.1), (0.05, 0.3), (-0.3, 0.0)]
        self.write("tests.csv", "f1,f2\n" + "".join(
            f"{1.0 + 0.1 * a + 0.02 * b!r},{3.0 + 0.05 * a + 0.2 * b!r}\n" for a, b in moved))
        for method in ("deterministic", "perturbation", "maximum-likelihood", "mares"):
            chosen = ("--set", f'update.method="{method}"', "--set", "update.samples=12", "--set", "update.iterations=6")
            expected = json.loads(self.succeed("check", "study.toml", "--json", *chosen).out)["expected_runs"]
            self.log.unlink()
            self.succeed("update", "study.toml", "--out", method, "--quiet", *chosen)
            # Fewer where the specimens' derivatives hold from one iteration to the next.
            self.assertTrue(0.5 < expected / len(self.runs()) < 4.0, f"{method}: {expected}, {len(self.runs())}")
            self.assertIn(f"the update would take about {expected} runs", (self.folder / method / "mottle.log").read_text())

    def test_check_says_that_a_population_takes_as_many_runs_as_its_sampler_starts_with(self):
        chosen = ("--set", 'update.method="hierarchical"', "--set", "test.repeatability={ \"f*\" = \"0.1 %\" }")
        expected = json.loads(self.succeed("check", "study.toml", "--json", *chosen).out)["expected_runs"]
        self.assertGreaterEqual(expected, 8 * 500 * 6)  # islands, particles, specimens
        update = subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "long", *chosen], cwd=self.folder,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        warned = next((line for line in update.stderr if "the update would take more than" in line), "")
        update.terminate()
        update.communicate()
        self.assertRegex(warned, r"more than \d+ runs, .*A \[surrogate\] takes 50 or so")

    def test_an_update_ends_and_its_repetition_repeats_nothing(self):
        self.succeed("update", "study.toml", "--out", "a", "--quiet")
        self.assertIn(read_result(self.folder / "a")["status"], ("converged", "max-iterations", "stalled"))
        count = len(self.runs())
        self.assertEqual(count, len(set(self.runs())), "no parameter vector ran twice")
        first = numbers(self.folder / "a")
        self.succeed("update", "study.toml", "--out", "a", "--quiet")
        self.assertEqual(len(self.runs()), count)
        self.assertEqual(numbers(self.folder / "a"), first)
        self.write("in.txt.template", "{{k1}}\n{{k2}}\n")
        self.succeed("update", "study.toml", "--out", "a", "--quiet")
        self.assertGreaterEqual(len(self.runs()), 2 * count - 1)

    def test_no_runs_are_spent_on_other_minima_unasked(self):
        for method in ("deterministic", "maximum-likelihood"):
            out = self.succeed("check", "study.toml", "--set", f'update.method="{method}"').out
            self.assertIn("Other solutions are not searched for", " ".join(out.split()))
        chosen = ["--quiet", "--set", 'update.method="deterministic"', "--set", "update.iterations=20"]
        self.log.unlink()
        self.succeed("update", "study.toml", "--out", "a", *chosen)
        unasked = len(self.runs())
        self.assertLess(unasked, 2 * 16 + 50, "two clouds, and few derivatives")
        result = read_result(self.folder / "a")
        self.assertTrue(any("Other solutions" in note for note in result["notes"]))
        self.assertFalse([step for step in result["verdict"]["next"] if "diagnose" in step["command"]], "it refuses such models")
        self.succeed("update", "study.toml", "--out", "b", *chosen, "--set", "update.starts=8")
        self.assertGreater(len(self.runs()), unasked + 8)
        self.assertFalse(any("Other solutions" in note for note in read_result(self.folder / "b")["notes"]))

    def test_threads_and_parallel_change_no_number(self):
        self.succeed("propagate", "study.toml", "--out", "a", "--quiet", "--threads", "1")
        self.succeed("propagate", "study.toml", "--out", "b", "--quiet", "--set", "model.parallel=5")
        self.assertEqual((self.folder / "a" / "cloud.csv").read_bytes(), (self.folder / "b" / "cloud.csv").read_bytes())

    def test_kill_and_resume(self):
        self.succeed("update", "study.toml", "--out", "whole", "--quiet")
        whole = len(self.runs())
        self.log.unlink()
        for part in (0.3, 0.6, 0.9):
            process = subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "out", "--quiet", "--resume"],
                                       cwd=self.folder)
            while len(self.runs()) < part * whole and process.poll() is None:
                time.sleep(0.005)
            process.send_signal(signal.SIGKILL)
            process.wait()
        self.succeed("update", "study.toml", "--out", "out", "--quiet", "--resume")
        self.assertEqual(numbers(self.folder / "out"), numbers(self.folder / "whole"))
        self.assertLessEqual(len(self.runs()), whole + 3 * 2, "only runs in flight were lost")
        self.assertFalse((self.folder / "out" / "runs").exists())

    def test_a_surrogate_takes_few_runs_and_resumes(self):
        maximum_likelihood = ["--quiet", "--set", 'update.method="maximum-likelihood"', "--set", "update.samples=30"]
        self.succeed("update", "study.toml", "--out", "direct", *maximum_likelihood)
        direct = len(self.runs())
        self.log.unlink()
        self.write("study.toml", STUDY + "\n[surrogate]\nruns = 20\n")
        self.succeed("update", "study.toml", "--out", "whole", *maximum_likelihood)
        whole = len(self.runs())
        self.assertLess(3 * whole, direct)
        parameters = {name: read_result(self.folder / name)["parameters"] for name in ("direct", "whole")}
        for key in ("mean", "std"):
            for own, expected in zip(parameters["whole"][key], parameters["direct"][key]):
                self.assertLess(abs(own / expected - 1), 0.01, key)
        self.log.unlink()
        process = subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "out", *maximum_likelihood], cwd=self.folder)
        while len(self.runs()) < 0.6 * whole and process.poll() is None:
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.succeed("update", "study.toml", "--out", "out", "--resume", *maximum_likelihood)
        self.assertEqual(numbers(self.folder / "out"), numbers(self.folder / "whole"))
        self.assertLessEqual(len(self.runs()), whole + 2, "only runs in flight were lost")

    def test_a_stop_request_ends_the_solvers_and_can_be_resumed(self):
        self.write("solver.py", "import time\ntime.sleep(100)\n" + SOLVER)
        process = subprocess.Popen([support.MOTTLE, "propagate", "study.toml", "--out", "out"], cwd=self.folder,
                                   stderr=subprocess.PIPE)
        while not list(self.folder.glob("out/runs/*/run-1/stdout.txt")):
            time.sleep(0.01)
        process.send_signal(signal.SIGTERM)
        start = time.monotonic()
        process.communicate()
        self.assertEqual(process.returncode, 4)
        self.assertLess(time.monotonic() - start, 20 * support.PATIENCE)

    def test_faults_of_the_study_are_found_with_file_and_line(self):
        for old, new, part in (
                ('column = 1', 'column = 0', "column"),
                ('format = "column"', 'format = "colum"', 'did you mean "column"?'),
                ('timeout = "20 s"', 'timeout = "20 m"', "found \"20 m\", allowed is a time"),
                ('command = ["python3", "-S", "-E", "solver.py"]', 'command = ["pyhton3"]', "no program 'pyhton3'"),
                ('parallel = 2', 'parallell = 2', "did you mean 'parallel'?"),
                ('frequencies = [1, 2]', 'frequencies = [1, 2]\ntracking = "mac"', "[model.shapes]"),
                ('frequencies = [1, 2]', 'frequencies = [1, 3]', "the model has modes 1 to 2"),
                ('name = "k2"', 'name = "k3"', "Known: k1, k3"),
                ('column = 1', 'column = 1\nafterwards = 2', "is not known here"),
                ('files = ["solver.py"]', 'files = ["solver.py", "x/solver.py", "../solver.py"]', "two files")):
            self.write("study.toml", edited(STUDY, (old, new)))
            ended = self.call("update", "study.toml", "--out", "out")
            self.assertEqual(ended.code, 2, f"{new}: {ended.err}")
            self.assertIn(part, ended.err)

    def test_a_solver_that_fails_at_the_means_ends_with_its_words(self):
        self.write("solver.py", "import sys\nsys.exit('no licence today')\n")
        ended = self.call("update", "study.toml", "--out", "out")
        self.assertEqual(ended.code, 3, ended.err)
        self.assertIn("no licence today", ended.err)
        kept = list((self.folder / "out" / "failed-runs").iterdir())
        self.assertEqual(len(kept), 1)
        self.assertIn(str(kept[0]), ended.err)

    def test_every_method_lives_with_a_solver_without_derivatives(self):
        self.write("solver.awk", AWK_SOLVER)
        self.write("study.toml", edited(STUDY, ('"solver.py"]\ncommand = ["python3", "-S", "-E", "solver.py"]',
                                                '"solver.awk"]\ncommand = ["awk", "-f", "solver.awk", "in.txt"]')))
        for method in ("covariance-adjustment", "deterministic", "inversion", "mares", "maximum-likelihood",
                       "moment-matching", "perturbation"):
            self.succeed("update", "study.toml", "--out", "methods", "--quiet", "--set", f'update.method="{method}"',
                         "--set", "test.repeatability={ \"f*\" = 0.001 }", timeout=300)
            result = read_result(self.folder / "methods")
            self.assertIn(result["status"], ("converged", "max-iterations", "stalled"), method)
            self.assertEqual(result["failed_evaluations"], [], method)

    def test_what_the_docs_advise_makes_output_that_is_cut_short_a_failed_run(self):
        column = 'format = "column"\nafter = "F"\ncolumn = 1'
        self.write("tests.csv", "f1,f2\n" + "".join(f"{1.25 + 0.01 * k},{2.25 + 0.02 * k * k}\n" for k in range(6)))
        for check, rule, whole in (
                ('&& test -z "$(tail -c 1 given)"', column, "F\n1.25\n2.25\n"),
                ("&& tail -n 1 given | grep -qx END", column, "F\n1.25\n2.25\n\nEND\n"),
                ("", "format = 'regex'\npattern = 'f = (\\S+) Hz'", "f = 1.25 Hz\nf = 2.25 Hz"),
                ("", 'format = "csv"\ncolumn = "f"', "f,end\n1.25,.\n2.25,."),
                ("", 'format = "json"\ncolumn = "f"', '{"f": [1.25, 2.25]}')):
            study = edited(STUDY, ('["python3", "-S", "-E", "solver.py"]', f"': {{{{k1}}}} {{{{k2}}}}; cat given {check}'"),
                           ('templates = ["in.txt.template"]\nfiles = ["solver.py"]', 'files = ["given"]'),
                           ('format = "column"\nafter = "FREQUENCIES"\ncolumn = 1', rule + "\nmodes = 2"))
            self.write("study.toml", study)
            for content, code in ((whole, 0), (whole[:whole.index("2.25") + 3], 3)):
                with self.subTest(check=check, rule=rule, content=content):
                    self.write("given", content)
                    ended = self.call("check", "study.toml")
                    self.assertEqual(ended.code, code, ended.err)

    def test_the_copied_study_runs_from_its_folder(self):
        self.succeed("propagate", "study.toml", "--out", "out", "--quiet")
        self.succeed("propagate", "out/study.toml", "--out", "again", "--quiet")
        self.assertEqual((self.folder / "out" / "cloud.csv").read_bytes(), (self.folder / "again" / "cloud.csv").read_bytes())


if __name__ == "__main__":
    support.main()
