"""What the replications share: one call of a program that prints one JSON object."""
import json
import subprocess
import sys


def call(program, *words):
    """What the program printed; ends the run where it failed."""
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))} ended with {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)
