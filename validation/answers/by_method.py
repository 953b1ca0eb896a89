"""Are right models called right? Chains of springs by every method, with one setting a row of the table."""
import concurrent.futures
import dataclasses
import json
import pathlib
import subprocess
import tempfile

import numpy as np

from chains import Chain, between_walls, parts_in_a_row, storeys, two_of_seven, two_that_cross

SEED = 3801


@dataclasses.dataclass
class Setting:
    """What is drawn, and how it is updated."""
    what: str
    chain: Chain
    prior: float  # relative deviation of the parameters' means
    modes: int
    method: str = "maximum-likelihood"
    specimens: tuple = (8, 10)
    scatter: float = 0.03  # of the specimens' parameters
    noise: float = 0.001  # of a frequency
    is_stated: bool = True
    ratio: float = 1.0  # of the noise of frequencies 1, 3, ... to that of 2, 4, ...

    def noises(self):
        """Relative noise of each frequency."""
        return self.noise / np.where(np.arange(self.modes) % 2 == 0, 1.0, self.ratio)


def settings():
    """All rows of the table."""
    row = parts_in_a_row()
    found = [Setting(f"four like parts in a row, prior {100 * std:.0f} %", row, std, modes)
             for std, modes in ((0.1, 6), (0.2, 6), (0.3, 6), (0.3, 8), (0.3, 12))]
    found += [Setting("a uniform chain between two walls, prior 20 %", between_walls(), 0.2, 6),
              Setting("four storeys, prior 20 %", storeys(), 0.2, 4)]
    found += [Setting("four like parts in a row, prior 30 %", row, 0.3, 6, method)
              for method in ("deterministic", "inversion", "moment-matching", "covariance-adjustment", "mares")]
    found += [Setting("modes by rank that cross, scatter 20 %", two_that_cross(), 0.05, 3, scatter=0.2)]
    found += [Setting(f"two parameters, {n} specimens, noise not stated, levels differ by {ratio:g}", two_of_seven(), 0.1, 5, specimens=(n, n), scatter=0.1,
                      noise=0.002, is_stated=False, ratio=ratio) for n in (10, 30) for ratio in (1.0, 2.0, 3.0, 5.0)]
    return found


SETTINGS = settings()


def study_text(setting):
    """The study of a chain whose parts are the parameters."""
    rows = [setting.chain.toml()]
    for part in range(len(setting.chain.parts)):
        rows += ["[[parameter]]", f'name = "x{part}"', f"target = {setting.chain.targets(part)}", "relative = true",
                 f'distribution = {{ kind = "normal", mean = 1, std = {max(setting.prior, setting.scatter)} }}']
    noise = [f'repeatability = {{ "*" = "{100 * setting.noise} %" }}'] if setting.is_stated else []
    return "\n".join([*rows, "[outputs]", f"frequencies = {list(range(1, setting.modes + 1))}", 'tracking = "order"', "[test]",
                      'file = "tests.csv"', *noise, "[update]", f'method = "{setting.method}"'])


def draw_truth(rng, setting):
    """A population's mean from the prior, all springs positive, and specimens [specimen x part]."""
    while True:
        mean = 1.0 + setting.prior * rng.standard_normal(len(setting.chain.parts))
        if (mean > 0.2).all():
            break
    count = int(rng.integers(setting.specimens[0], setting.specimens[1] + 1))
    return mean, mean * (1.0 + setting.scatter * rng.standard_normal((count, mean.size)))


def solutions_of(result):
    """Means and their intervals: of the estimate, then of the others."""
    block = result["parameters"]
    found = [(np.array(block["mean"]), block.get("mean_ci95"))]
    return found + [(np.array(other["mean"]), other["mean_ci95"]) for other in result["other_solutions"]]


def one_set(program, number, index):
    """Draws a set, updates, and says what came out."""
    setting = SETTINGS[index]
    rng = np.random.default_rng([SEED, index, number])
    mean, specimens = draw_truth(rng, setting)
    tests = np.array([setting.chain.modes(x)[0][:setting.modes] for x in specimens])
    tests *= 1.0 + setting.noises() * rng.standard_normal(tests.shape)
    tests.sort(axis=1)  # known by rank
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        (place / "study.toml").write_text(study_text(setting), encoding="utf-8")
        np.savetxt(place / "tests.csv", tests, delimiter=",", header=",".join(f"f{k + 1}" for k in range(setting.modes)), comments="")
        done = subprocess.run([program, "update", "study.toml", "--out", "out", "--quiet", "--threads", "1", "--cache", "off"],
                              cwd=place, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            return {"conclusion": "failed", "reason": done.stderr.strip()}
        result = json.loads((place / "out/result.json").read_text(encoding="utf-8"))
    solutions = solutions_of(result)
    nearest = min(range(len(solutions)), key=lambda k: np.abs(solutions[k][0] - mean).max())
    ends = solutions[nearest][1]
    known = [(low, high, true) for (low, high), true in zip(ends or [], mean) if low is not None]
    return {"conclusion": result["verdict"]["conclusion"], "others": len(solutions) - 1,
            "named": bool(np.abs(solutions[nearest][0] / specimens.mean(axis=0) - 1.0).max() < 0.1),
            "held": sum(low <= true <= high for low, high, true in known), "intervals": len(known)}


def row(program, index, sets, jobs):
    """One line of the table, and whether its goal is met: inadequate in 5 % and two standard errors at most."""
    setting = SETTINGS[index]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        answers = list(pool.map(lambda number: one_set(program, number, index), range(sets)))
    count = {kind: sum(answer["conclusion"] == kind for answer in answers)
             for kind in ("adequate", "inadequate", "undecided", "failed")}
    whole = [answer for answer in answers if answer["conclusion"] != "failed"]
    intervals = sum(answer["intervals"] for answer in whole)
    held = f"{100 * sum(answer['held'] for answer in whole) / intervals:.1f}" if intervals else "-"
    named, others = (sum(bool(answer[key]) for answer in whole) for key in ("named", "others"))
    is_met = count["inadequate"] <= sets * (0.05 + 2 * np.sqrt(0.05 * 0.95 / sets)) and count["failed"] == 0
    line = (f"| {setting.what}, {setting.modes} frequencies | {setting.method} | {sets} | {count['adequate']} | {count['inadequate']} | {count['undecided']} | "
            f"{count['failed']} | {named} | {others} | {held} | {'yes' if is_met else 'no'} |")
    print(line, flush=True)
    return line, is_met


HEAD = ("| what | method | sets | adequate | inadequate | undecided | failed | true parameters among the solutions | with other solutions "
        "| means within their 95 % intervals, % | reached |\n|---|---|---|---|---|---|---|---|---|---|---|")


def section(program, sets, jobs):
    """The table with its heading, and whether all goals are met."""
    print(HEAD)
    rows = [row(program, k, sets, jobs) for k in range(len(SETTINGS))]
    text = ["# Answers to right models", "",
            f"Made by run.py, seed {SEED}. True means are drawn from the prior; 8 to 10 specimens scatter by 3 % "
            "about them, frequencies are known by rank, with a stated noise of 0.1 %, where nothing else is said. *True parameters among the solutions*: all within "
            "10 % of the specimens' mean, of the estimate or of another solution that is named. Intervals are those of the solution nearest to "
            "the truth. Goal: inadequate in 5 % and two standard errors at most.", "", HEAD, *(line for line, _ in rows)]
    return "\n".join(text) + "\n", all(met for _, met in rows)
