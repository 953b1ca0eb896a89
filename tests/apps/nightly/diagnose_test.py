"""`mottle diagnose` with candidates of an airframe, which takes minutes.

    python3 nightly/diagnose_test.py PATH_TO_MOTTLE
"""

import json
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402  (found by the line above)


class Diagnose(support.CommandTest):
    def diagnosis(self, *arguments, **how):
        self.succeed("diagnose", "study.toml", "--out", "out", "--quiet", *arguments, **how)
        return json.loads((self.folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))

    def test_candidates_of_a_large_model_are_fitted_as_each_alone(self):
        """Together they are solved by a model each."""
        if support.PATIENCE > 1:
            self.skipTest("takes minutes under sanitizers")
        example = support.SOURCE / "examples" / "02-airframe"
        for name in ("airframe.bdf", "specimens.csv"):
            shutil.copy(example / name, self.folder)
        study = (example / "study.toml").read_text(encoding="utf-8")
        cut = study.index("[[parameter]]\nname = \"tail_yaw\"")
        self.write("study.toml", study[:cut] + study[study.index("[[parameter]]", cut + 1):])
        names = ["PBUSH:103:K6", "CONM2:8303:M"]

        def found(candidates):
            result = self.diagnosis("--set", f"diagnose.candidates={json.dumps(candidates)}", timeout=600)
            return {entry["name"]: entry for entry in result["candidates"]}

        together = found(names)
        alone = found(names[:1])[names[0]]["bic"]
        self.assertAlmostEqual(together[names[0]]["bic"], alone, delta=0.05 + 1e-3 * abs(alone))
        self.assertLess(alone, -300.0)


if __name__ == "__main__":
    support.main()
