"""Whole studies as users have them: one drawn, updated (and diagnosed where its question is which number is wrong), and judged."""
import dataclasses
import json
import pathlib
import tempfile
import tomllib
import zlib

import numpy as np

import commands
import measurements
from decks import DrawFailed
from errors import Answers, first_causes

SEED = 3816


@dataclasses.dataclass
class Parameter:
    """A factor on numbers of the model, whose mean over all structures of the kind is drawn from its prior."""
    targets: list
    prior: float  # relative deviation
    kind: str = "normal"

    def draw(self, rng, count, scatter):
        """A population's mean, and its specimens."""
        if self.kind == "lognormal":
            width = np.sqrt(np.log1p(self.prior ** 2))
            mean = np.exp(width * rng.standard_normal() - width ** 2 / 2)
            width = np.sqrt(np.log1p(scatter ** 2))
            return mean, mean * np.exp(width * rng.standard_normal(count) - width ** 2 / 2)
        mean = 1.0 + self.prior * max(rng.standard_normal(), -2.0)
        return mean, mean * (1.0 + scatter * rng.standard_normal(count))


@dataclasses.dataclass
class Family:
    """Studies of one kind."""
    what: str
    structure: object
    parameters: list
    frequencies: list
    error: object = None  # of errors.py; None: the model is right
    specimens: tuple = (8, 12)
    scatter: float = 0.03  # relative, of each parameter
    noise: float = 0.001  # relative, of a frequency
    is_stated: bool = True
    ratio: float = 1.0  # of the noise of every other frequency to the rest
    form: str = "rank"  # rank: sorted columns; named: the model's numbers; shapes: columns of shapes too; uff: a file each
    shape_modes: list = dataclasses.field(default_factory=list)
    dofs: list = dataclasses.field(default_factory=list)
    gaps: float = 0.0  # share of frequencies that were not found
    batches: tuple = ()  # a target that every third specimen has by a factor
    is_proposed: bool = False  # the study is that of `mottle init --yes`
    method: str = "maximum-likelihood"
    update: str = ""  # further lines of [update]


def noise_lines(family, shape_noise):
    """The study's statement of the noise."""
    if not family.is_stated:
        return []
    noises = [f'f{mode} = "{100 * noise:.6g} %"' for mode, noise in zip(family.frequencies, frequency_noise(family))]
    if family.form == "shapes":
        noises.append(f'"phi*" = {shape_noise!r}')
    return [f"repeatability = {{ {', '.join(noises)} }}"]


def frequency_noise(family):
    """Relative noise of each frequency."""
    return family.noise * np.where(np.arange(len(family.frequencies)) % 2 == 0, 1.0, family.ratio)


def study_text(family, shape_noise):
    """study.toml."""
    rows = [family.structure.toml()]
    for k, parameter in enumerate(family.parameters):
        given = getattr(family.structure, "inputs", None)
        target = [] if given else [f"target = {json.dumps(parameter.targets)}", "relative = true"]
        rows += ["[[parameter]]", f'name = "x{k}"', *target,
                 f'distribution = {{ kind = "{parameter.kind}", mean = 1.0, std = {max(parameter.prior, family.scatter)} }}']
    tracking = "order" if family.form == "rank" or hasattr(family.structure, "inputs") else "mac"
    rows += ["[outputs]", f"frequencies = {family.frequencies}", f'tracking = "{tracking}"']
    if family.form == "shapes":
        rows.append(f"shapes = {{ modes = {family.shape_modes}, dofs = {json.dumps(family.dofs)} }}")
    file = '"tests"' if family.form == "uff" else '"tests.csv"'
    pairing = {"rank": "order", "named": "named", "shapes": "named", "uff": "mac"}[family.form]
    rows += ["[test]", f"file = {file}", f'pairing = "{pairing}"', *noise_lines(family, shape_noise), "[update]", f'method = "{family.method}"', family.update]
    return "\n".join(rows) + "\n"


def draw_truth(family, rng):
    """Population's means, factors {target: [specimen]}, and the number of the specimen that differs."""
    count = int(rng.integers(family.specimens[0], family.specimens[1] + 1))
    means, truth = [], {}
    for parameter in family.parameters:
        mean, values = parameter.draw(rng, count, family.scatter)
        means.append(mean)
        truth.update({target: values for target in parameter.targets})
    if family.batches:
        target, factor = family.batches
        share = np.where(np.arange(count) % 3 == 0, factor, 1.0)
        truth[target] = truth[target] * share
        means = [mean * (share.mean() if target in parameter.targets else 1.0) for mean, parameter in zip(means, family.parameters)]
    special = family.error.change(truth, count, rng) if family.error else None
    return np.array(means), truth, count, special


def measure(family, rng, truth, count, program):
    """Columns and values [specimen x column] with noise and gaps, and the noise of shapes."""
    frequencies, shapes = family.structure.modes(truth, count, family.frequencies, family.dofs, family.form == "rank", program=program)
    frequencies = frequencies * (1.0 + frequency_noise(family) * rng.standard_normal(frequencies.shape))
    if family.form == "rank":
        frequencies.sort(axis=1)
    frequencies[rng.random(frequencies.shape) < family.gaps] = np.nan
    shape_noise = float(0.01 * np.abs(shapes).max()) if shapes.size else 0.0
    shapes = shapes + shape_noise * rng.standard_normal(shapes.shape)
    columns = [f"f{mode}" for mode in family.frequencies]
    values = [frequencies]
    for mode in (family.frequencies if family.form == "uff" else family.shape_modes):
        columns += [f"phi{mode}:{dof}" for dof in family.dofs]
        values.append(shapes[:, :, family.frequencies.index(mode)])
    values = np.hstack(values)
    if family.error:
        family.error.spoil(columns, values)
    return columns, values, shape_noise


def write_tests(family, place, columns, values):
    """tests.csv, or a universal file for each specimen."""
    if family.form != "uff":
        (place / "tests.csv").write_text(measurements.table(columns, values), encoding="utf-8")
        return
    (place / "tests").mkdir()
    modes, dofs = len(family.frequencies), len(family.dofs)
    for k, row in enumerate(values):
        text = measurements.universal_file(row[:modes], row[modes:].reshape(modes, dofs).T, family.dofs)
        (place / "tests" / f"specimen-{k + 1:02d}.uff").write_text(text, encoding="ascii")


def diagnose(program, place):
    """Targets that `diagnose` tries, the best first, and its processor time."""
    answer = commands.call(program, "diagnose", "study.toml", "--out", "diagnosis", folder=place)
    if answer.code != 0:
        return [], answer.seconds
    table = json.loads((place / "diagnosis/diagnosis.json").read_text(encoding="utf-8"))
    return [candidate["targets"] for candidate in table["candidates"] if not candidate["screened_out"]], answer.seconds


def propose(program, family, place):
    """Writes the study of `mottle init --yes`, with the noise where the user knows it; its processor time."""
    tests = "tests" if family.form == "uff" else "tests.csv"
    answer = commands.call(program, "init", family.structure.name, tests, "--yes", "--out", "study.toml", folder=place)
    if answer.code == 0 and family.is_stated:
        text = (place / "study.toml").read_text(encoding="utf-8")
        noise = f'repeatability = {{ "f*" = "{100 * family.noise:.6g} %" }}'
        (place / "study.toml").write_text(text.replace("[test]", f"[test]\n{noise}", 1), encoding="utf-8")
    return answer


def covered(family, result, study, means):
    """Means within their intervals at the solution nearest to the truth, and how many are known; of parameters that were drawn."""
    block = result["parameters"]
    true = {parameter.targets[0]: mean for parameter, mean in zip(family.parameters, means)}
    if not family.is_proposed:
        wanted = list(enumerate(means))
    else:
        targets = [parameter["target"] for parameter in study["parameter"]]
        firsts = [target if isinstance(target, str) else target[0] for target in targets]
        wanted = [(k, true.get(target, 1.0)) for k, target in enumerate(firsts)]
    solutions = [(block["mean"], block.get("mean_ci95"))] + [(other["mean"], other["mean_ci95"]) for other in result["other_solutions"]]
    _, ends = min(solutions, key=lambda solution: max(abs(solution[0][k] - mean) for k, mean in wanted))
    known = [(ends[k], mean) for k, mean in wanted if ends and ends[k][0] is not None]
    return sum(bool(low <= mean <= high) for (low, high), mean in known), len(known)


def update(program, family, place, means, special):
    """Answers to the study in a folder: a conclusion, what is covered, and what is named."""
    first = propose(program, family, place) if family.is_proposed else commands.Answer(0, "", 0.0)
    answer = commands.call(program, "update", "study.toml", "--out", "out", folder=place) if first.code == 0 else first
    found = {"conclusion": "failed", "seconds": first.seconds + answer.seconds, "held": 0, "intervals": 0, "named": False,
             "code": answer.code, "said": answer.errors}
    answers = Answers(answer.errors, specimen=special)
    if answer.code == 0:
        result = json.loads((place / "out/result.json").read_text(encoding="utf-8"))
        study = tomllib.loads((place / "study.toml").read_text(encoding="utf-8"))
        answers.causes = first_causes(result)
        found.update(conclusion=result["verdict"]["conclusion"], reassures=result["verdict"]["is_reassuring"], said=answers.causes)
        found["held"], found["intervals"] = covered(family, result, study, means)
    if family.error and family.error.asks_diagnosis and answer.code == 0 and found["conclusion"] != "adequate":
        answers.candidates, seconds = diagnose(program, place)
        found["seconds"] += seconds
        found["said"] += f" | candidates {answers.candidates[:2]}"
    found["named"] = bool(family.error and family.error.is_named(answers))
    return found


def draw(program, family, number):
    """Means, the specimen that differs, columns, values and the noise of shapes; again where modes cannot be followed."""
    for attempt in range(20):
        rng = np.random.default_rng([SEED, zlib.crc32(family.what.encode()), number, attempt])
        means, truth, count, special = draw_truth(family, rng)
        try:
            return means, special, measure(family, rng, truth, count, program)
        except DrawFailed as failure:
            reason = failure
    raise DrawFailed(f"{family.what}: none of 20 draws could be followed: {reason}")


def write_study(family, place, measured):
    """All files that a user has."""
    columns, values, shape_noise = measured
    for name, text in family.structure.files().items():
        (place / name).write_text(text, encoding="utf-8")
    if not family.is_proposed:
        (place / "study.toml").write_text(study_text(family, shape_noise), encoding="utf-8")
    write_tests(family, place, columns, values)


def one_set(program, family, number, keep=None):
    """Draws a set, writes it (to stay in the folder `keep`), and says what comes out."""
    means, special, measured = draw(program, family, number)
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(keep or folder)
        place.mkdir(parents=True, exist_ok=True)
        write_study(family, place, measured)
        return update(program, family, place, means, special)
