"""A real Slurm on one machine, for tests: one controller and some nodes, each a slurmd of its own, in a temporary folder.

    with SlurmCluster() as cluster:
        subprocess.run(["srun", "-N", "4", "hostname"], env=cluster.environment())
        cluster.kill_node("n2")     # slurmd, its steps and their tasks at once, as when the power goes
        cluster.start_node("n2")

By hand, until Ctrl-C or SIGTERM, or as long as a command lasts:
    python3 slurm_cluster.py [--nodes 4] [--cpus 2] [-- COMMAND ...]

Nothing outside the folder is read or written, so several may run side by side. Slurm's daemons leave their parents and
change their names; each is therefore started under a *keeper*, to which the kernel hands all orphans below it
(PR_SET_CHILD_SUBREAPER). A keeper kills all below it when its standard input ends, hence also when the test itself was killed.

Needs Debian's slurm-wlm and munge; runs as root or as any user (who then is Slurm's user, too). Jobs have neither cgroups nor
accounting: sacct has nothing to tell, squeue and `scontrol show job` have. MPI: `srun --mpi=pmix`.
"""

import argparse
import contextlib
import ctypes
import getpass
import os
import pathlib
import secrets
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

# The times are short where users would wait for minutes: a lost node is noticed after SlurmdTimeout, its jobs wait for
# cred_expire (5 s is the least that Slurm takes) before they start again. Nodes share the machine, so each has its own TmpFS:
# PMIx keeps a folder there for the tasks of a step on a node.
CONFIGURATION = """\
ClusterName=mottle
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
TmpFS={folder}/tmp-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
MpiDefault=none
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=3
MessageTimeout=4
KillWait=1
UnkillableStepTimeout=10
JobRequeue=1
MailProg=/bin/true
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
{nodes}
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
# Nodes of one host name would take each other's ranks for their own, and Open MPI's shared memory for that of one node (it
# crashes where nodes have several ranks each): messages go by TCP, as between real nodes.
MPI = {"OMPI_MCA_btl": "self,tcp", "OMPI_MCA_btl_tcp_if_include": "lo"}
PROGRAMS = ("munged", "slurmctld", "slurmd", "srun", "sinfo", "scontrol")
PATH = os.pathsep.join([os.environ.get("PATH", os.defpath), "/usr/sbin", "/sbin"])


def why_not():
    """Why no cluster can be made here; empty: it can."""
    missing = [program for program in PROGRAMS if shutil.which(program, path=PATH) is None]
    return f"no {', '.join(missing)} here (Debian: slurm-wlm, munge)" if missing else ""


def free_ports(count):
    """Ports of loopback that are free now; another program may still be quicker."""
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def descendants(ancestor):
    """Processes below `ancestor`, as the kernel sees them now."""
    children = {}
    for status in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text(errors="replace").rpartition(")")[2].split()
        except OSError:
            continue  # it ended while we looked
        children.setdefault(int(fields[1]), []).append(int(status.parent.name))
    found, open_ends = [], [ancestor]
    while open_ends:
        below = children.get(open_ends.pop(), [])
        found += below
        open_ends += below
    return found


def keep(command):
    """Entry of a keeper: runs `command` until standard input or the command ends, then kills all that is below it."""
    set_child_subreaper = 36
    if ctypes.CDLL(None, use_errno=True).prctl(set_child_subreaper, 1, 0, 0, 0) != 0:
        sys.exit(f"prctl: {os.strerror(ctypes.get_errno())}")
    signals = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    for number in signals:
        signal.signal(number, signal.SIG_IGN)  # whoever holds our standard input ends us
    nothing = [(os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0)]
    daemon = os.posix_spawnp(command[0], command, os.environ, file_actions=nothing, setsigdef=signals)
    while daemon not in reaped() and not select.select([sys.stdin], [], [], 0.1)[0]:
        pass
    while below := descendants(os.getpid()):
        for process in below:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        reaped()
        time.sleep(0.01)


def reaped():
    """Children that have ended, now buried: those of our own and orphans from below."""
    ended = []
    with contextlib.suppress(ChildProcessError):
        while (child := os.waitpid(-1, os.WNOHANG)[0]) != 0:
            ended.append(child)
    return ended


class SlurmCluster:
    """A cluster that is up inside `with`; every process of it is gone afterwards, whatever happened.

    nodes, cpus   number of nodes (n1, n2, ...), and of processors that each claims to have, however many there are
    settings      further lines of slurm.conf
    A cluster that does not come up within `patience_s` is a RuntimeError with the ends of the logs.
    """

    def __init__(self, nodes=4, cpus=2, settings="", patience_s=60.0):
        self.names = [f"n{number}" for number in range(1, nodes + 1)]
        self.cpus = cpus
        self.settings = settings
        self.patience_s = patience_s
        self.keepers = {}
        self.folder = None

    def __enter__(self):
        if reason := why_not():
            raise RuntimeError(reason)
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="mottle-slurm-"))
        # A SIGTERM would end Python without leaving the block.
        self.former = signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
        try:
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for name in list(self.keepers)[::-1]:
            self.stop(name)
        signal.signal(signal.SIGTERM, self.former)
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self):
        self.folder.chmod(0o755)  # munged wants its socket within everybody's reach
        for name in ["munge", "state", *(f"{kind}-{node}" for node in self.names for kind in ("spool", "tmp"))]:
            (self.folder / name).mkdir(mode=0o755)
        self.write_configuration()
        self.start_munge()
        self.keep("slurmctld", "slurmctld", "-D", "-f", self.configuration)
        for node in self.names:
            self.start_node(node, wait=False)
        self.wait_until(lambda: set(self.states().values()) == {"idle"}, "nodes are not idle")

    @property
    def configuration(self):
        return self.folder / "slurm.conf"

    def write_configuration(self):
        port, *ports = free_ports(1 + len(self.names))
        nodes = "\n".join(f"NodeName={node} NodeHostname={socket.gethostname()} NodeAddr=127.0.0.1 Port={own} "
                          f"CPUs={self.cpus} State=UNKNOWN" for node, own in zip(self.names, ports))
        self.configuration.write_text(
            CONFIGURATION.format(host=socket.gethostname(), port=port, user=getpass.getuser(), folder=self.folder,
                                 nodes=nodes) + self.settings)

    def start_munge(self):
        munge = self.folder / "munge"
        key = munge / "key"
        key.write_bytes(secrets.token_bytes(128))
        key.chmod(0o400)
        self.keep("munged", "munged", "--foreground", "--force", f"--key-file={key}", f"--socket={munge}/socket",
                  f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed")
        self.wait_until((munge / "socket").exists, "munged has no socket")

    def keep(self, name, *command):
        """Starts a daemon under a keeper of its own."""
        with (self.folder / f"{name}.out").open("wb") as out:
            self.keepers[name] = subprocess.Popen(
                [sys.executable, __file__, "--keep", *map(str, command)], stdin=subprocess.PIPE, stdout=out, stderr=out,
                cwd=self.folder, env=self.environment(), start_new_session=True)

    def stop(self, name):
        """Kills a daemon with all that it has started, and waits until it is gone."""
        keeper = self.keepers.pop(name)
        keeper.stdin.close()
        keeper.wait()

    def start_node(self, node, wait=True):
        """Starts a node, again if it was killed, and waits until Slurm gives it work."""
        self.keep(node, "slurmd", "-D", "-N", node, "-f", self.configuration)
        if wait:
            self.wait_until(lambda: self.states()[node] in ("idle", "mix", "alloc"), f"{node} is not back")

    def kill_node(self, node, notice=False):
        """Kills slurmd, steps and tasks of a node. Slurm sees it within 10 s or so, with `notice` before this returns."""
        self.stop(node)
        if notice:
            self.call("scontrol", "update", f"nodename={node}", "state=down", "reason=killed")

    def environment(self, **more):
        """Environment of a client of this cluster."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("SLURM", "PMI"))}
        return {**kept, **MPI, "PATH": PATH, "SLURM_CONF": str(self.configuration), **more}

    def call(self, *command):
        """Standard output of a client; one that fails is a CalledProcessError."""
        return subprocess.run(list(map(str, command)), env=self.environment(), stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=True, timeout=60).stdout

    def states(self):
        """State of each node in the words of sinfo: idle, mix, alloc, down, ...; a star says that it does not answer."""
        try:
            return dict(line.split() for line in self.call("sinfo", "-h", "-N", "-o", "%N %t").splitlines())
        except subprocess.CalledProcessError:
            return {node: "unknown" for node in self.names}  # the controller is not there yet

    def wait_until(self, holds, otherwise):
        end = time.monotonic() + self.patience_s
        while not holds():
            gone = [name for name, keeper in self.keepers.items() if keeper.poll() is not None]
            if gone or time.monotonic() > end:
                raise RuntimeError(f"{otherwise}; {self.logs()}")
            time.sleep(0.05)

    def logs(self):
        """The last lines of all logs."""
        files = [*self.folder.glob("*.out"), *self.folder.glob("*.log"), *self.folder.glob("munge/log")]
        return "\n".join(f"--- {file.name}\n{file.read_text(errors='replace')[-1500:]}" for file in sorted(files))


def main():
    if sys.argv[1:2] == ["--keep"]:
        return keep(sys.argv[2:])
    parser = argparse.ArgumentParser(description="A Slurm on this machine, until Ctrl-C or as long as COMMAND lasts.")
    parser.add_argument("--nodes", type=int, default=4)
    parser.add_argument("--cpus", type=int, default=2, help="of each node, however many there are (default: 2)")
    parser.add_argument("command", nargs="*", metavar="COMMAND")
    arguments = parser.parse_args()
    with SlurmCluster(arguments.nodes, arguments.cpus) as cluster:
        if arguments.command:
            return subprocess.run(arguments.command, env=cluster.environment(), check=False).returncode
        print(f"export SLURM_CONF={cluster.configuration}", flush=True)
        try:
            signal.pause()
        except KeyboardInterrupt:
            pass
    return 0


if __name__ == "__main__":
    sys.exit(main())
