#!/usr/bin/env python3
"""Stand-ins for the commands of PBS and LSF, for tests: they take the options that Mottle gives, refuse all others, and do
the tasks on this machine.

    install(folder)      puts qsub, qselect, qstat, qdel, bsub, bjobs and bkill there; their state is in folder/state

A task is a process group of its own; a file for each says what has become of it. `folder/state/silent` makes all commands
fail as if the scheduler could not be reached.
"""

import fcntl
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

PROGRAMS = ("qsub", "qselect", "qstat", "qdel", "bsub", "bjobs", "bkill")
STATE = pathlib.Path(__file__).resolve().parent / "state"


def install(folder):
    (folder / "state").mkdir(parents=True)
    source = pathlib.Path(__file__).read_text(encoding="utf-8")
    for program in PROGRAMS:
        (folder / program).write_text(source, encoding="utf-8")
        (folder / program).chmod(0o755)


def options_of(arguments, with_value, flags=()):
    """Options as (name, value), and what follows them."""
    found, rest = [], list(arguments)
    while rest and rest[0].startswith("-"):
        name = rest.pop(0)
        if name in flags:
            found.append((name, ""))
        elif name in with_value and rest:
            found.append((name, rest.pop(0)))
        else:
            sys.exit(f"illegal option: {name}")
    return found, rest


class Task:
    """What is known of a task: a file that is written whole."""

    def __init__(self, job, number):
        self.file = STATE / job / f"{number}.json"
        self.number = number

    def read(self):
        return json.loads(self.file.read_text())

    def write(self, **values):
        part = self.file.with_suffix(".part")
        part.write_text(json.dumps(values))
        part.rename(self.file)


def tasks_of(job):
    return [Task(job, int(file.stem)) for file in (STATE / job).glob("[0-9]*.json")]


def jobs():
    return {folder.name: json.loads((folder / "job").read_text()) for folder in STATE.iterdir() if (folder / "job").exists()}


def jobs_named(name):
    return [job for job, what in jobs().items() if what["name"] == name]


def submit(name, first, last, limit, script, variable):
    """The job's number. Its tasks are done by a process of their own, `limit` at a time."""
    with open(STATE / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        job = str(1 + max((int(folder.name) for folder in STATE.iterdir() if folder.is_dir()), default=0))
        (STATE / job).mkdir()
    for number in range(first, last + 1):
        Task(job, number).write(state="waiting")
    (STATE / job / "job").write_text(json.dumps({"name": name, "is_array": last > first or "[" in variable}))
    if os.fork() == 0:
        os.setsid()
        null = os.open(os.devnull, os.O_RDWR)
        for stream in range(3):
            os.dup2(null, stream)
        work(job, range(first, last + 1), limit or 3, script, variable.strip("[]"))
        os._exit(0)
    return job


def work(job, numbers, limit, script, variable):
    waiting, running = list(numbers), {}
    while waiting or running:
        for number, process in list(running.items()):
            if process.poll() is not None:
                running.pop(number)
                Task(job, number).write(state="ended", status=process.returncode, reason=ended_by(job, number))
        for number in [number for number in waiting if ended_by(job, number)]:
            waiting.remove(number)
            Task(job, number).write(state="ended", status=271, reason=ended_by(job, number))
        while waiting and len(running) < limit:
            number = waiting.pop(0)
            running[number] = subprocess.Popen([script], env={**os.environ, variable: str(number)}, start_new_session=True)
            Task(job, number).write(state="running", process=running[number].pid)
        for number, process in running.items():
            if ended_by(job, number):
                os.killpg(process.pid, signal.SIGTERM)
        time.sleep(0.05)


def ended_by(job, number):
    return "cancelled" if (STATE / job / "cancel").exists() or (STATE / job / f"cancel-{number}").exists() else ""


def qsub(arguments):
    options, rest = options_of(arguments, ("-N", "-j", "-o", "-l", "-J", "-q", "-A", "-r"), ("-V",))
    values = dict(options)
    if values.get("-q") == "no-such":
        sys.exit("qsub: Unknown queue")
    if len(values["-N"]) > 15:
        sys.exit("qsub: illegal -N value")
    array = re.fullmatch(r"(\d+)-(\d+)(?:%(\d+))?", values.get("-J", "1-1"))
    if "-J" in values and array[1] == array[2]:
        sys.exit("qsub: illegal -J value")
    job = submit(values["-N"], int(array[1]), int(array[2]), int(array[3] or 0), rest[0],
                 "[PBS_ARRAY_INDEX]" if "-J" in values else "PBS_NOTHING")
    (STATE / job / "asked").write_text(json.dumps(arguments))
    print(f"{job}[].server" if "-J" in values else f"{job}.server")


def qselect(arguments):
    values = dict(options_of(arguments, ("-N",), ("-x",))[0])
    for job in jobs_named(values["-N"]):
        print(f"{job}[].server" if jobs()[job]["is_array"] else f"{job}.server")


def qstat(arguments):
    found = {}
    for job in [re.match(r"\d+", name)[0] for name in options_of(arguments, ("-F",), ("-x", "-t", "-f"))[1]]:
        what = jobs()[job]
        if what["is_array"]:
            found[f"{job}[].server"] = {"Job_Name": what["name"], "job_state": "B"}
        for task in tasks_of(job):
            now = task.read()
            letter = {"waiting": "Q", "running": "R", "ended": "X" if what["is_array"] else "F"}[now["state"]]
            one = {"Job_Name": what["name"], "job_state": letter}
            if now["state"] != "waiting":
                one["exec_host"] = "here/0*1"
            if now["state"] == "ended":
                one["Exit_status"] = now["status"]
            found[f"{job}[{task.number}].server" if what["is_array"] else f"{job}.server"] = one
    print(json.dumps({"timestamp": 0, "pbs_version": "stand-in", "Jobs": found}))


def qdel(arguments):
    for name in arguments:
        job, number = re.match(r"(\d+)(?:\[(\d*)\])?", name).groups()
        (STATE / job / (f"cancel-{number}" if number else "cancel")).touch()


def bsub(arguments):
    options, rest = options_of(arguments, ("-J", "-cwd", "-o", "-n", "-R", "-q", "-P", "-W"), ("-r",))
    values = dict(options)
    if values.get("-q") == "no-such":
        sys.exit("no-such: No such queue. Job not submitted.")
    name, first, last, limit = re.fullmatch(r"([\w-]+)\[(\d+)-(\d+)\](?:%(\d+))?", values["-J"]).groups()
    os.chdir(values["-cwd"])
    job = submit(name, int(first), int(last), int(limit or 0), rest[0], "LSB_JOBINDEX")
    (STATE / job / "asked").write_text(json.dumps(arguments))
    print(f"Job <{job}> is submitted to default queue <normal>.")


def bjobs(arguments):
    values = dict(options_of(arguments, ("-J", "-o"), ("-a", "-noheader"))[0])
    if values["-o"] != "name jobindex stat exec_host exit_reason delimiter='|'":
        sys.exit("bad output format")
    if not jobs_named(values["-J"]):
        print(f"Job <{values['-J']}> is not found", file=sys.stderr)
        sys.exit(255)
    for job in jobs_named(values["-J"]):
        for task in tasks_of(job):
            now = task.read()
            state = {"waiting": "PEND", "running": "RUN"}.get(now["state"], "EXIT" if now.get("status") else "DONE")
            reason = "TERM_OWNER: job killed by owner" if now.get("reason") else "-"
            print(f"{values['-J']}[{task.number}]|{task.number}|{state}|{'-' if state == 'PEND' else 'here'}|{reason}")


def bkill(arguments):
    rest = arguments
    if rest[:1] == ["-J"]:
        for job in jobs_named(rest[1]):
            (STATE / job / "cancel").touch()
        return
    qdel(rest)


def main():
    if (STATE / "silent").exists():
        sys.exit("Connection refused: cannot connect to server")
    globals()[pathlib.Path(sys.argv[0]).name](sys.argv[1:])


if __name__ == "__main__":
    main()
