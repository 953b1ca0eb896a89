"""Runs the two programs that the scripts of this folder compare, and keeps their files where asked."""

import json
import os
import pathlib
import subprocess
import tempfile


def run_calculix(ccx, folder, name):
    """Frequencies in Hz of the job `name` in `folder`."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    done = subprocess.run([ccx, name], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    frequencies, is_table = [], False
    for line in (folder / f"{name}.dat").read_text(encoding="ascii").splitlines():
        fields = line.split()
        if "E I G E N V A L U E   O U T P U T" in line:
            is_table = True
        elif is_table and len(fields) == 5 and fields[0].isdigit():
            frequencies.append(float(fields[3]))
        elif is_table and "P A R T I C I P A T I O N" in line:
            break
    if not frequencies:
        raise SystemExit(f"CalculiX gave no frequencies for {name}:\n{done.stdout[-2000:]}")
    return frequencies


def run_mottle(command, deck):
    """Frequencies in Hz of a deck."""
    done = subprocess.run([command, "modes", str(deck), "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{command} modes {deck} ended with {done.returncode}:\n{done.stderr}")
    return json.loads(done.stdout)["frequencies"]


def run_in_folder(parser, compare):
    """Calls compare(folder, arguments) in a folder of its own, or in the one that --keep names."""
    parser.add_argument("--keep", type=pathlib.Path, help="folder in which to leave inputs and outputs")
    arguments = parser.parse_args()
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        compare(arguments.keep, arguments)
        return
    with tempfile.TemporaryDirectory() as folder:
        compare(pathlib.Path(folder), arguments)
