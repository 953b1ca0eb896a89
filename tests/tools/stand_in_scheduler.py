#!/usr/bin/env python3
"""Stand-ins for the commands of PBS and LSF, for tests: they take the options that Mottle gives, refuse all others, and do
the tasks on this machine.

    server = start(folder)    puts qsub, qselect, qstat, qdel, bsub, bjobs and bkill there, with their state in folder/state,
                              and starts a process that does the tasks: Mottle ends all that a command of its own leaves behind

A task is a process group of its own; a file for each says what has become of it. `folder/state/silent` makes all commands
fail as if the scheduler could not be reached, and `folder/state/blind` makes lists show nothing and say that all is well. With
`folder/state/held` no task begins.
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


def start(folder):
    (folder / "state").mkdir(parents=True)
    source = pathlib.Path(__file__).read_text(encoding="utf-8")
    for program in PROGRAMS:
        (folder / program).write_text(source, encoding="utf-8")
        (folder / program).chmod(0o755)
    return subprocess.Popen([sys.executable, folder / "qsub", "serve"])


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


def submit(name, last, limit, script, variable):
    """The job's number. `folder/state/longest` holds the length of the longest array that is taken, and `folder/state/most`
    the tasks that may be in the queue."""
    if (STATE / "longest").exists() and last > int((STATE / "longest").read_text()):
        sys.exit("qsub: Array job exceeds server or queue size limit" if "PBS" in variable else
                 "Job array index too large. Job not submitted.")
    waiting = sum(task.read()["state"] != "ended" for job in jobs() for task in tasks_of(job))
    if (STATE / "most").exists() and waiting + last > int((STATE / "most").read_text()):
        sys.exit("qsub: would exceed queue generic's per-user limit of jobs in 'Q' state")
    print("Welcome to the cluster <here>\n80 % of your quota are used")
    with open(STATE / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        job = str(1 + max((int(folder.name) for folder in STATE.iterdir() if folder.is_dir()), default=0))
        (STATE / job).mkdir()
    for number in range(1, last + 1):
        Task(job, number).write(state="waiting")
    (STATE / job / "job").write_text(json.dumps({"name": name, "is_array": "[" in variable}))
    part = STATE / job / "part"
    part.write_text(json.dumps({"last": last, "limit": limit or 3, "script": script, "variable": variable.strip("[]"),
                                "folder": os.getcwd(), "environment": dict(os.environ)}))
    part.rename(STATE / job / "request")
    return job


class Work:
    """An array whose tasks the server does, `limit` at a time."""

    def __init__(self, job):
        self.job = job
        self.request = json.loads((STATE / job / "request").read_text())
        self.waiting = list(range(1, self.request["last"] + 1))
        self.running = {}

    def go_on(self):
        for number, process in list(self.running.items()):
            if process.poll() is not None:
                self.running.pop(number)
                Task(self.job, number).write(state="ended", status=process.returncode, reason=ended_by(self.job, number))
        for number in [number for number in self.waiting if ended_by(self.job, number)]:
            self.waiting.remove(number)
            Task(self.job, number).write(state="ended", status=271, reason=ended_by(self.job, number))
        while self.waiting and not (STATE / "held").exists() and len(self.running) < self.request["limit"]:
            self.begin(self.waiting.pop(0))
        for number, process in self.running.items():
            if ended_by(self.job, number):
                os.killpg(process.pid, signal.SIGTERM)

    def begin(self, number):
        environment = {**self.request["environment"], self.request["variable"]: str(number)}
        self.running[number] = subprocess.Popen([self.request["script"]], env=environment, cwd=self.request["folder"],
                                                start_new_session=True)
        Task(self.job, number).write(state="running")


def serve():
    """Until the test ends it; then its tasks end, too."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    work = {}
    try:
        while True:
            for request in STATE.glob("*/request"):
                work.setdefault(request.parent.name, Work(request.parent.name))
            for one in work.values():
                one.go_on()
            time.sleep(0.05)
    finally:
        for process in [process for one in work.values() for process in one.running.values()]:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def ended_by(job, number):
    return "cancelled" if (STATE / job / "cancel").exists() or (STATE / job / f"cancel-{number}").exists() else ""


def qsub(arguments):
    options, rest = options_of(arguments, ("-N", "-j", "-o", "-l", "-J", "-q", "-A", "-r"), ("-V",))
    values = dict(options)
    if values.get("-q") == "no-such":
        sys.exit("qsub: Unknown queue")
    if len(values["-N"]) > 15:
        sys.exit("qsub: illegal -N value")
    array = re.fullmatch(r"(1)-(\d+)(?:%(\d+))?", values.get("-J", "1-1"))
    if "-J" in values and array[1] == array[2]:
        sys.exit("qsub: illegal -J value")
    os.chdir(STATE)  # as PBS starts a job in the user's home
    job = submit(values["-N"], int(array[2]), int(array[3] or 0), rest[0],
                 "[PBS_ARRAY_INDEX]" if "-J" in values else "PBS_NOTHING")
    (STATE / job / "asked").write_text(json.dumps(arguments))
    print(f"{job}[].server" if "-J" in values else f"{job}.server")


def qselect(arguments):
    values = dict(options_of(arguments, ("-N",), ("-x",))[0])
    for job in jobs_named(values["-N"]):
        print(f"{job}[].server" if jobs()[job]["is_array"] else f"{job}.server")


def qstat(arguments):
    found = {}
    for job in [re.match(r"\d+", name)[0] for name in options_of(arguments, (), ("-x", "-t", "-f"))[1]]:
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
    for name, values in found.items():
        print(f"Job Id: {name}")
        for key, value in {**values, "Variable_List": "N=007,BASH_FUNC_ml%%=() {  a=\"$1\"\n}"}.items():
            print(f"    {key} = {value}")
        print()


def qdel(arguments):
    for name in arguments:
        job, number = re.match(r"(\d+)(?:\[(\d*)\])?", name).groups()
        (STATE / job / (f"cancel-{number}" if number else "cancel")).touch()


def bsub(arguments):
    options, rest = options_of(arguments, ("-J", "-cwd", "-o", "-n", "-R", "-q", "-P", "-W"), ("-r",))
    values = dict(options)
    if values.get("-q") == "no-such":
        sys.exit("no-such: No such queue. Job not submitted.")
    name, last, limit = re.fullmatch(r"([\w-]+)\[1-(\d+)\](?:%(\d+))?", values["-J"]).groups()
    os.chdir(values["-cwd"])
    job = submit(name, int(last), int(limit or 0), rest[0], "[LSB_JOBINDEX]")
    (STATE / job / "asked").write_text(json.dumps(arguments))
    print(f"Job <{job}> is submitted to default queue <normal>.")


def bjobs(arguments):
    options, rest = options_of(arguments, ("-J", "-o"), ("-a", "-noheader"))
    values = dict(options)
    if values["-o"] != "name jobindex stat exec_host exit_reason delimiter='|'":
        sys.exit("bad output format")
    found = jobs_named(values["-J"]) if "-J" in values else [job for job in rest if job in jobs()]
    if not found:
        print(f"Job <{values.get('-J', rest)}> is not found", file=sys.stderr)
        sys.exit(255)
    for job in found:
        for task in tasks_of(job):
            now = task.read()
            state = {"waiting": "PEND", "running": "RUN"}.get(now["state"], "EXIT" if now.get("status") else "DONE")
            reason = "TERM_OWNER: job killed by owner" if now.get("reason") else "-"
            print(f"{jobs()[job]['name']}[{task.number}]|{task.number}|{state}|{'-' if state == 'PEND' else 'here'}|{reason}")


def bkill(arguments):
    rest = arguments
    if rest[:1] == ["-J"]:
        for job in jobs_named(rest[1]):
            (STATE / job / "cancel").touch()
        return
    qdel(rest)


def main():
    if sys.argv[1:] == ["serve"]:
        return serve()
    if (STATE / "silent").exists():
        sys.exit("Connection refused: cannot connect to server")
    if (STATE / "blind").exists() and pathlib.Path(sys.argv[0]).name in ("qselect", "qstat", "bjobs"):
        return None
    return globals()[pathlib.Path(sys.argv[0]).name](sys.argv[1:])


if __name__ == "__main__":
    main()
