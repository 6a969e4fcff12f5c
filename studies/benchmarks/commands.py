"""What a command costs when it is warm: processor time of a process of its own, user and system, in the median.

    python -m studies.benchmarks.commands --runs 10
    python -m studies.benchmarks.commands --runs 10 --beside OTHER/.venv/bin/evenroad

Each command runs once before it is timed, in an empty folder.  With `--beside`, another installation's commands are
timed in turn with ours.  Below them stands what Python takes to load the libraries that a plan with its picture needs.
"""

from __future__ import annotations

import os
import resource
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of

COMMANDS = {
    "arm": "plan box-reach --robot ur5 --start home --goal inside",
    "arm, no picture": "plan box-reach --robot ur5 --start home --goal inside --no-picture",
    "map": "plan office.yaml --start 1 2 --goal 8.5 3 --robot-radius 0.25",
    "help": "plan --help",
}
LIBRARIES = {"python": "pass", "+ numpy": "import numpy", "+ yaml, Pillow": "import numpy, yaml, PIL.ImageDraw"}


def seconds(words: list[str], folder: str) -> float:
    """Return the processor's seconds of a process, user and system."""
    # Compiled modules are kept, as on a user's machine.
    surroundings = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, cwd=folder, env=surroundings, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print a row a command."""
    parser = parser_of(__doc__)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--beside", type=Path, help="the command evenroad of another installation")
    given = parser.parse_args()
    timed = {name: [[sys.executable, "-m", "evenroad", *shlex.split(words)]] for name, words in COMMANDS.items()}
    if given.beside is not None:
        for name, words in COMMANDS.items():
            timed[name].append([str(given.beside.absolute()), *shlex.split(words)])
    timed |= {name: [[sys.executable, "-c", code]] for name, code in LIBRARIES.items()}
    with tempfile.TemporaryDirectory() as folder:
        for name, asked in timed.items():
            spent = np.array([[seconds(words, folder) for words in asked] for _ in range(given.runs + 1)])[1:]
            medians = np.median(spent, axis=0)
            ratio = "" if len(medians) == 1 else f"; beside {medians[1]:.3f}, ours {medians[0] / medians[1]:.2f} of it"
            print(f"{name:16} {medians[0]:.3f} s, least {spent[:, 0].min():.3f}{ratio}", flush=True)
    print(f"load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
