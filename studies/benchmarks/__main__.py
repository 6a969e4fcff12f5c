"""Run every benchmark in turn: ``python -m studies.benchmarks --out out/bench``; each writes OUT/NAME.txt."""

import argparse
import subprocess
import sys
from pathlib import Path

HELPERS = {
    "__init__",
    "__main__",
    "arm_problems",
    "mjcf_truth",
    "robot_truth",
    "rows",
    "sizes",
}
ASKED = {"arm_tables"}
"""They want to be told what to do, or what to read; the pages say how."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/bench"))
    parser.add_argument("--only", nargs="*", help="names of benchmarks; default all")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    names = sorted(path.stem for path in Path(__file__).parent.glob("*.py") if path.stem not in HELPERS | ASKED)
    failed = []
    for name in options.only or names:
        print(f"== {name}", flush=True)
        with open(options.out / f"{name}.txt", "w") as file:
            run = subprocess.Popen(
                [sys.executable, "-u", "-m", f"studies.benchmarks.{name}"],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
            assert run.stdout is not None
            for line in run.stdout:
                print(line, end="", flush=True)
                file.write(line)
        if run.wait():
            failed.append(name)
    print("failed: " + ", ".join(failed) if failed else "all benchmarks ran")
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
