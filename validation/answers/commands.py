"""Calls of the program, with their processor time."""
import dataclasses
import os
import pathlib
import subprocess


@dataclasses.dataclass
class Answer:
    """How a command ended."""
    code: int
    errors: str
    seconds: float  # of processor time


def call(program, *words, folder):
    """Runs the program in a folder, with one thread and no cache where the verb computes."""
    if words[0] in ("update", "diagnose", "propagate"):
        words = (*words, "--quiet", "--threads", "1", "--cache", "off")
    with open(pathlib.Path(folder) / "stderr.txt", "w+", encoding="utf-8") as errors:
        process = subprocess.Popen([program, *map(str, words)], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        return Answer(process.returncode, errors.read().strip(), usage.ru_utime + usage.ru_stime)
