"""The table of whole studies: answers by family, and the goals over all."""
import concurrent.futures
import json

import numpy as np

from families import families
from studies import SEED, one_set

KINDS = ("adequate", "inadequate", "undecided", "failed")
HEAD = ("| what | sets | adequate | inadequate | undecided | failed | means within their 95 % intervals, % | refused, or not reassured with the error named "
        "| cause named among the first two | processor time, s | reached |\n|---|---|---|---|---|---|---|---|---|---|---|")
ABOUT = (
    f"Made by run.py, seed {SEED}: families.py says what is drawn. The truth is drawn from the prior; 8 to 12 specimens scatter by 3 % and frequencies have a "
    "stated noise of 0.1 % where nothing else is said; the method is `maximum-likelihood`. Families with a right model come first. *Failed*: the command refused "
    "the study with a message, or ended with an error. Sets are fewer where time ended first. "
    "A wrong model is *refused* by its verdict, or on reading with the error named. Where specimens are wrong and the model is right (loose joints, batches), "
    "*adequate* with the error named and without the green of a reassuring verdict is the right answer, and counts as named. *Causes* are the first two of `verdict.causes`, "
    "where there are none the headline and the summary, and the first two candidates of `mottle diagnose` where the question is which number is wrong and "
    "the verdict is not adequate. Processor time is that of `init`, `update` and `diagnose`, mean of the sets. A family's goal: right models refused or failed in "
    "7 % and two standard errors at most; wrong ones refused, or not reassured with the error named, in 90 %, the cause named in 75 %.")
RIGHT, REFUSED, NAMED = 0.07, 0.90, 0.75  # goals: at most, at least, at least


def is_caught(answer):
    """A refusal by the verdict, or one on reading, or an answer that is open or marked as doubtful, that names the error."""
    return answer["conclusion"] == "inadequate" or (answer["named"] and not answer.get("reassures", False))


def is_blamed(answer):
    """A right model that is refused, or whose study fails."""
    return answer["conclusion"] in ("inadequate", "failed")


def two_errors(share, sets):
    """Two standard errors of a share."""
    return 2 * np.sqrt(share * (1 - share) / sets)


def logged(log):
    """Answers in the log: {(family, number): answer}."""
    if not log or not log.exists():
        return {}
    lines = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    return {(line["what"], line["number"]): line for line in lines}


def all_answers(program, sets, jobs, log):
    """{family: answers}: a first set of all families, then a second one...; sets in the log count, and new ones are added to it."""
    known = logged(log)
    wanted = [(family, number) for number in range(sets) for family in families() if (family.what, number) not in known]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        answers = pool.map(lambda one: one_set(program, *one), wanted)
        for (family, number), answer in zip(wanted, answers):
            known[family.what, number] = {"what": family.what, "number": number, **answer}
            if log:
                with open(log, "a", encoding="utf-8") as file:
                    file.write(json.dumps(known[family.what, number]) + "\n")
    names = {family.what for family in families()}
    return {what: [answer for (name, _), answer in sorted(known.items()) if name == what] for what in names}


def row(family, answers):
    """One line of the table, and whether the family's goal is met: of right models with two standard errors."""
    sets = len(answers)
    counts = [sum(answer["conclusion"] == kind for answer in answers) for kind in KINDS]
    seconds = np.mean([answer["seconds"] for answer in answers])
    if family.error is None:
        intervals = sum(answer["intervals"] for answer in answers)
        coverage = f"{100 * sum(answer['held'] for answer in answers) / intervals:.1f}" if intervals else "-"
        is_met = sum(map(is_blamed, answers)) <= sets * (RIGHT + two_errors(RIGHT, sets))
        cells = [coverage, "-", "-"]
    else:
        caught, named = sum(map(is_caught, answers)), sum(answer["named"] for answer in answers)
        is_met = caught >= REFUSED * sets and named >= NAMED * sets
        cells = ["-", caught, named]
    line = " | ".join(map(str, [family.what, sets, *counts, *cells, f"{seconds:.1f}", "yes" if is_met else "no"]))
    return f"| {line} |"


def goals(answers, is_short):
    """Sentences on all families together, each with the same weight, and whether all goals are met; in the short form with two standard errors."""
    right, wrong = ([answers[family.what] for family in families() if bool(family.error) == is_wrong] for is_wrong in (False, True))
    goal_list = [("Right models are refused or fail", right, is_blamed, RIGHT, "at most"),
                 ("Wrong models are refused, or not reassured with the error named,", wrong, is_caught, REFUSED, "at least"),
                 ("The cause is among the first two", wrong, lambda answer: answer["named"], NAMED, "at least")]
    sentences, met = [], []
    for what, sets, claim, goal, bound in goal_list:
        share = float(np.mean([np.mean([claim(answer) for answer in family]) for family in sets]))
        count = sum(map(len, sets))
        slack = two_errors(goal, count) if is_short else 0.0
        met.append(share <= goal + slack if bound == "at most" else share >= goal - slack)
        sentences.append(f"- {what} in {100 * share:.1f} % ({count} sets of {len(sets)} families); goal: {bound} {100 * goal:.0f} %: {'yes' if met[-1] else 'no'}.")
    return sentences, all(met)


def section(program, sets, jobs, log=None, is_short=False):
    """The table with its heading, and whether the goals over all are met."""
    answers = all_answers(program, sets, jobs, log)
    lines = [row(family, answers[family.what]) for family in families()]
    print("\n".join([HEAD, *lines]))
    sentences, met = goals(answers, is_short)
    print("\n".join(sentences))
    text = ["# Answers to whole studies", "", ABOUT, "", HEAD, *lines, "", "Over all families, each with the same weight:", "", *sentences]
    return "\n".join(text) + "\n", met
