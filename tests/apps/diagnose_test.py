"""`mottle diagnose` as a user meets it."""

import json
import math
import shutil
import subprocess
import time
import tomllib

import nastran_test
import support
from support import edited, line_of, main

# Three outputs beside two parameters: the noise must be known to tell it from a candidate.
STUDY = edited(support.STUDY, ('file = "tests.csv"', 'file = "tests.csv"\nrepeatability = { f1 = 0.002, f2 = 0.002, f3 = 0.002 }'))


# So many specimens that likelihood ratios need no replications, which take seconds.
MANY = "\n".join([support.TESTS.splitlines()[0]] + [
    ",".join(str(float(cell) * (1.0 + 0.004 * math.sin(7 * row + 3 * column + copy * copy))) for column, cell in enumerate(line.split(",")))
    for copy in range(6) for row, line in enumerate(support.TESTS.splitlines()[1:])]) + "\n"


class Diagnose(support.CommandTest):

    def setUp(self):
        super().setUp()
        self.write("study.toml", STUDY)
        self.write("tests.csv", MANY)

    def test_noise_that_cannot_be_told_from_a_candidate_is_refused_and_nothing_left_behind(self):
        self.write("study.toml", support.STUDY)
        ended = self.call("diagnose", "study.toml", "--out", "refused")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("give [test] repeatability", ended.err)
        self.assertFalse((self.folder / "refused").exists())

    def diagnosis(self, *arguments, **how):
        self.succeed("diagnose", "study.toml", "--out", "out", "--quiet", *arguments, **how)
        return json.loads((self.folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))

    def test_every_spring_that_no_parameter_acts_on_is_a_candidate(self):
        result = self.diagnosis()
        self.assertEqual(sorted(entry["name"] for entry in result["candidates"]), ["k3", "k4", "k5", "k6"])
        self.assertEqual(result["parameters"]["names"], ["k1", "k2"])
        self.assertEqual(len(result["cosines"]["matrix"]), 4)
        self.assertTrue(result["sentences"])
        for key in ("best", "alike", "explained", "given", "proposed", "model_evaluations", "seed", "level"):
            self.assertIn(key, result)

    def test_evidences_of_candidates_are_those_of_updates_with_them(self):
        candidate = '{ name = "k6", target = "spring:k6", distribution = { kind = "normal", mean = 3.0, std = 0.6 } }'
        bayes = edited(STUDY, ('method = "mares"', 'method = "bayes"')) + "[update.bayes]\nparticles = 100\n"
        self.write("study.toml", bayes + f"[diagnose]\nevidence = 1\ncandidates = [{candidate}]\n")
        self.write("alone.toml", bayes)
        self.write("with.toml", bayes + '[[parameter]]\nname = "k6"\ntarget = "spring:k6"\ndistribution = { kind = "normal", mean = 3.0, std = 0.6 }\n')
        evidence = self.diagnosis()["evidence"]
        self.assertEqual(evidence["method"], "bayes")
        self.assertEqual([model["candidate"] for model in evidence["models"]], [None, "k6"])
        for model, study in zip(evidence["models"], ("alone", "with")):
            self.succeed("update", f"{study}.toml", "--out", study, "--quiet")
            updated = json.loads((self.folder / study / "result.json").read_text(encoding="utf-8"))["evidence"]
            self.assertEqual(model["ln_evidence"], updated["ln_evidence"])
            self.assertEqual(model["standard_error"], updated["standard_error"])
        self.assertAlmostEqual(sum(model["probability"] for model in evidence["models"]), 1.0)

    def test_a_diagnosis_is_kept_where_no_evidence_can_be_sampled(self):
        self.write("study.toml", STUDY + "[update.hierarchical]\nparticles = 100000\nislands = 30\n[diagnose]\nevidence = 1\ncandidates = [\"spring:k6\"]\n")
        result = self.diagnosis()
        self.assertEqual(result["best"], "k6")
        for model in result["evidence"]["models"]:
            self.assertIn("particles", model["failure"])

    def wrong_spring(self, more=""):
        """The three masses with a spring that is softer than that of the tests, k6; `more`: the end of the study."""
        example = support.SOURCE / "examples" / "01-three-masses"
        shutil.copy(example / "specimens-shapes.csv", self.folder)
        text = edited((example / "shapes.toml").read_text(encoding="utf-8"), ("stiffness = 3.0", "stiffness = 2.0"))
        self.write("study.toml", text + more)

    def at_linear_stage(self, *arguments):
        """The linear answer as a running diagnosis leaves it, and the process."""
        process = subprocess.Popen([support.MOTTLE, "diagnose", "study.toml", "--out", "out", "--quiet", *arguments], cwd=self.folder)
        self.addCleanup(process.kill)
        file = self.folder / "out" / "diagnosis.json"
        until = time.monotonic() + 60 * support.PATIENCE
        while process.poll() is None and time.monotonic() < until:
            try:
                found = json.loads(file.read_text(encoding="utf-8"))  # whole, whenever it is read
                if found["stage"] == "linear":
                    return found, process
            except FileNotFoundError:  # not yet written, or an earlier one was just put aside
                pass
            time.sleep(0.001)
        self.fail("no linear answer was seen")

    def test_the_linear_answer_is_written_before_the_fits_and_replaced_by_them(self):
        self.write("tests.csv", support.TESTS)  # with replications, which take a second
        linear, process = self.at_linear_stage()
        self.assertEqual({candidate["fitted"] for candidate in linear["candidates"]}, {False})
        self.assertTrue(all("gain" in candidate["linear"] for candidate in linear["candidates"]))
        self.assertEqual(process.wait(timeout=60 * support.PATIENCE), 0)
        fitted = json.loads((self.folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
        self.assertEqual(fitted["stage"], "fitted")
        self.assertTrue(fitted["candidates"][0]["fitted"])
        self.assertEqual(linear["candidates"][0].keys(), fitted["candidates"][0].keys())

    def test_a_linear_answer_that_an_interrupted_run_left_does_not_take_the_place_of_a_result(self):
        self.write("tests.csv", support.TESTS)
        self.diagnosis()
        _, process = self.at_linear_stage()
        process.kill()
        process.wait()
        _, process = self.at_linear_stage()
        process.kill()
        process.wait()
        previous = json.loads((self.folder / "out" / "previous-results" / "diagnosis.json").read_text(encoding="utf-8"))
        self.assertEqual(previous["stage"], "fitted")
        self.diagnosis()
        self.assertFalse((self.folder / "out" / "previous-results").exists())

    def test_the_page_holds_the_result_and_the_report_of_an_update_links_it(self):
        self.wrong_spring()

        def data_of(name):
            text = (self.folder / "out" / name).read_text(encoding="utf-8")
            start = text.index('id="mottle-data">') + len('id="mottle-data">')
            return json.loads(text[start:text.index("</script", start)])

        self.succeed("update", "study.toml", "--out", "out", "--quiet", "--set", "update.samples=50")
        self.assertNotIn("diagnosis", data_of("report.html"))
        result = self.diagnosis()
        self.assertEqual(data_of("diagnosis.html"), {"kind": "diagnosis", "result": result})
        self.assertEqual(data_of("report.html")["diagnosis"], "diagnosis.html")
        # An update of other parameters is not what the diagnosis is about.
        with open(self.folder / "study.toml", "a", encoding="utf-8") as study:
            study.write(result["proposed_toml"])
        self.succeed("update", "study.toml", "--out", "out", "--quiet", "--set", "update.samples=50")
        self.assertNotIn("diagnosis", data_of("report.html"))

    def test_a_candidate_keeps_within_its_prior(self):
        """The tests ask for 3.0 where the prior ends at 2.2: that explanation is said to be none."""
        self.wrong_spring(more='[diagnose]\ncandidates = ["spring:k3", { name = "outer", target = "spring:k6", distribution = '
                          '{ kind = "uniform", lower = 1.8, upper = 2.2 } }]\n')
        result = self.diagnosis()
        outer = next(entry for entry in result["candidates"] if entry["name"] == "outer")
        answer = outer[outer["best"]]
        self.assertLessEqual(answer["mean"], 2.2 + 1e-9)
        self.assertFalse(answer["possible"])
        self.assertGreater(answer["needed"], 2.5)
        self.assertNotIn("outer", [entry["name"] for entry in result["proposed"]])
        self.assertTrue(any("outer would need" in sentence for sentence in result["sentences"]))

    def test_all_candidates_are_fitted_on_request(self):
        self.wrong_spring()
        few = self.diagnosis("--set", "diagnose.screened=1")
        all_fitted = self.diagnosis("--set", "diagnose.screened=1", "--thorough")
        self.assertLess(sum(entry["fitted"] for entry in few["candidates"]), len(few["candidates"]))
        self.assertTrue(all(entry["fitted"] for entry in all_fitted["candidates"]))
        out = self.succeed("diagnose", "study.toml", "--out", "out", "--set", "diagnose.screened=1").out
        self.assertIn("(linear)", out)
        self.assertIn("--thorough", out)

    def test_what_is_proposed_can_be_pasted_into_the_study(self):
        self.wrong_spring()
        ended = self.succeed("diagnose", "study.toml", "--out", "out")
        lines = ended.out[ended.out.index("add to study.toml "):ended.out.index("diagnosis: ")].splitlines()[1:]
        self.assertIn("is proposed (BIC", ended.err)
        self.assertIn("Round 2", ended.err)
        result = json.loads((self.folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
        self.assertEqual("\n".join(lines), result["proposed_toml"].rstrip("\n"))
        self.assertTrue(result["later_rounds"][0]["candidates"])
        self.assertEqual(result["later_rounds"][0]["beside"], [next(p["name"] for p in result["proposed"] if not p["given"])])
        with open(self.folder / "study.toml", "a", encoding="utf-8") as study:
            study.write(result["proposed_toml"])
        self.succeed("update", "study.toml", "--out", "updated", "--set", "update.samples=50")

    def test_without_a_candidate_the_model_has_its_own_value_whatever_the_candidates_distribution(self):
        # The tests' structure has the model's k6: nothing is missing.
        example = support.SOURCE / "examples" / "01-three-masses"
        shutil.copy(example / "specimens-shapes.csv", self.folder)
        right = (example / "shapes.toml").read_text(encoding="utf-8")
        table = '{ name = "outer", target = "spring:k6", distribution = { kind = "%s", mean = 2.0, std = 0.5 }%s }'
        for kind, scale in (("normal", ""), ("lognormal", ', scale = "log"')):
            self.write("study.toml", right + f"[diagnose]\ncandidates = [{table % (kind, scale)}]\n")
            result = self.diagnosis()
            self.assertIn("No candidate explains", result["sentences"][0], kind)
            self.assertEqual(result["candidates"][0]["nominal"], 3.0)
            self.assertEqual(result["proposed_toml"], "")

    def test_no_evidence_is_sampled_that_has_none_to_compare_with(self):
        example = support.SOURCE / "examples" / "01-three-masses"
        shutil.copy(example / "specimens-shapes.csv", self.folder)
        # Positive for the model, but beyond what a fit can come back from.
        self.write("study.toml", (example / "shapes.toml").read_text(encoding="utf-8") + (
            "[diagnose]\nevidence = 1\ncandidates = [{ name = \"far\", target = \"spring:k6\", bounds = [1e8, inf], "
            "distribution = { kind = \"normal\", mean = 1e9, std = 1e-3 } }]\n"))
        models = self.diagnosis()["evidence"]["models"]
        self.assertEqual(len(models), 1)
        self.assertIn("no candidate has a fit", models[0]["failure"])

    def test_what_is_proposed_keeps_its_prior(self):
        self.wrong_spring(more=(
            '[diagnose]\ncandidates = [{ name = "outer \\"spring\\"", target = "spring:k6", scale = "log", '
            'distribution = { kind = "lognormal", mean = 2.0, std = 0.5 }, bounds = [0.1, inf] }]\n'))
        proposed = tomllib.loads(self.diagnosis()["proposed_toml"])["parameter"]
        self.assertEqual(proposed, [{"name": 'outer "spring"', "target": "spring:k6", "scale": "log", "bounds": [0.1, math.inf],
                                     "distribution": {"kind": "lognormal", "mean": 2.0, "std": 0.5}}])

    def test_a_candidate_that_never_settles_is_not_proposed(self):
        """The wing's vertical spring is nearly rigid: its linear models change from iteration to iteration."""
        if support.PATIENCE > 1:
            self.skipTest("takes minutes under sanitizers")
        examples = support.SOURCE / "examples"
        tests = examples / "05-uff-population" / "specimens"
        (self.folder / "study.toml").unlink()
        self.succeed("init", examples / "02-airframe" / "airframe.bdf", tests, "--yes", "--out", "study.toml",
                     "--targets", "PSHELL:1:T,MAT1:1:E,MAT1:2:E,PSHELL:4:T,PBUSH:102:K4")
        with open(self.folder / "study.toml", "a", encoding="utf-8") as study:
            study.write('\n[[parameter]]\nname = "K4_101"\ntarget = "PBUSH:101:K4"\n'
                        'distribution = { kind = "normal", mean = 1e5, std = 2e4 }\n'
                        '[diagnose]\ncandidates = ["PBUSH:101:K2"]\n')
        result = self.diagnosis(timeout=300)
        self.assertEqual(result["candidates"][0]["freed"], {"failure": "its fit does not converge"})
        self.assertFalse(result["explained"])
        self.assertEqual(result["proposed_toml"], "")

    def test_candidates_are_targets_or_tables(self):
        text = STUDY + ('[diagnose]\ncandidates = ["spring:k6", { name = "mid", target = "spring:k4", distribution = '
                        '{ kind = "normal", mean = 1.0, std = 0.1 } }]\n')
        self.write("study.toml", text)
        names = [entry["name"] for entry in self.diagnosis()["candidates"]]
        self.assertEqual(sorted(names), ["k6", "mid"])

    def test_a_spring_of_zero_stiffness_may_be_a_candidate(self):
        self.write("study.toml", edited(STUDY, ("stiffness = 3.0", "stiffness = 0.0")) +
                   '[diagnose]\ncandidates = ["spring:k6"]\n')
        candidate = self.diagnosis()["candidates"][0]
        self.assertEqual(candidate["nominal"], 0.0)
        self.assertAlmostEqual(candidate["scale"], 0.2)

    def test_the_same_seed_gives_the_same_numbers_on_any_threads(self):
        texts = []
        for threads in ("1", "3"):
            result = self.diagnosis("--threads", threads)
            result.pop("timings_s")
            texts.append(json.dumps(result))
        self.assertEqual(texts[0], texts[1])

    def test_a_table_and_sentences_are_printed(self):
        self.write("tests.csv", support.TESTS)  # with replications
        out = self.succeed("diagnose", "study.toml", "--out", "out").out
        self.assertIn("candidate", out)
        self.assertIn("Proposed set:", out)
        summary = json.loads(self.succeed("diagnose", "study.toml", "--out", "out", "--json").out)
        self.assertEqual(summary["command"], "diagnose")

    def test_candidates_of_a_large_model_are_fitted_as_each_alone(self):
        """Together they are solved by a model each. The measured cantilevers are stiffer in plane 1 by 1.3, or softer in plane 2."""
        stiffer = 1.3 * nastran_test.INERTIA_1
        specimens = [sorted(math.sqrt(1.0 + 0.03 * math.sin(5 * k)) * frequency for frequency in
                            nastran_test.cantilever(stiffer) + nastran_test.cantilever(nastran_test.INERTIA_2)) for k in range(8)]
        self.write("tests.csv", "f1,f2,f3,f4\n" + "".join(",".join(map(repr, row)) + "\n" for row in specimens))
        self.write("deck.bdf", edited(nastran_test.deck(100), ("PELAS,9,1.0+4\n", ""), ("CELAS1,99,9,101,2\n", "")))
        study = nastran_test.STUDY
        self.write("study.toml", edited(study, (study[study.rindex("[[parameter]]"):study.index("[outputs]")], ""), ("[1, 2]", "[1, 2, 3, 4]")) +
                   '[test]\nfile = "tests.csv"\nrepeatability = { "f*" = "0.1 %" }\n')
        found = {"PBAR:1:I1": stiffer, "PBAR:1:I2": nastran_test.INERTIA_2 / 1.3}

        def fitted(candidates):
            result = self.diagnosis("--set", f"diagnose.candidates={json.dumps(candidates)}")
            return {entry["name"]: entry for entry in result["candidates"]}

        together = fitted(list(found))
        drawing = json.loads((self.folder / "out" / "diagnosis-model.json").read_text(encoding="utf-8"))
        self.assertLessEqual(set(found), {part["name"] for part in drawing["parameters"] if part["edges"]})
        for name, inertia in found.items():
            alone = fitted([name])[name]
            self.assertAlmostEqual(together[name]["bic"], alone["bic"], delta=0.05 + 1e-3 * abs(alone["bic"]))
            self.assertAlmostEqual(together[name]["shifted"]["mean"] / inertia, 1.0, delta=1e-4)

    def test_a_wrong_candidate_is_refused_with_its_line(self):
        for target, message in (("spring:k9", "unknown target 'spring:k9'"),
                                ("spring:k1", "'spring:k1' is what k1 acts on already")):
            text = STUDY + f'[diagnose]\ncandidates = ["{target}"]\n'
            self.write("study.toml", text)
            ended = self.call("diagnose", "study.toml", "--out", "refused")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn(f"study.toml:{line_of(text, 'candidates = ')}: ", ended.err)
            self.assertIn(message, ended.err)
            self.assertFalse((self.folder / "refused").exists())

    def test_unknown_keys_and_wrong_types_are_refused(self):
        for line, message in (('candidate = ["spring:k3"]', "did you mean 'candidates'?"),
                              ("candidates = 3", "allowed is a list of targets"),
                              ("candidates = [3]", "allowed is a list of targets"),
                              ("spread = -1.0", "allowed is")):
            self.write("study.toml", STUDY + f"[diagnose]\n{line}\n")
            ended = self.call("diagnose", "study.toml", "--out", "refused")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn(message, ended.err)


if __name__ == "__main__":
    main()
