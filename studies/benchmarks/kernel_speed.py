"""Rates of the native kernel, alone or beside another checkout of evenroad, in turn.

    python -m studies.benchmarks.kernel_speed                          # this checkout alone
    python -m studies.benchmarks.kernel_speed --beside OTHER           # its rates, and how many times those of OTHER
    python -m studies.benchmarks.kernel_speed --beside OTHER --arch x86-64-v3        # its build for AVX2 beside OTHER

OTHER is a folder, such as that of `git worktree add ../other a8de9a71`, the last commit whose kernel numba compiled.
Each checkout has a process of its own, which takes the same configurations and motions.  They take turns,
and the shortest processor time of each counts: what else runs on the machine only ever takes away.  `differ` counts
verdicts of configurations and motions that the two give differently.
"""

from __future__ import annotations

import json
import os
import sys
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, partial
from pathlib import Path
from subprocess import PIPE, Popen
from time import process_time
from typing import Any

ROOT = Path(__file__).parents[2]
KINDS = ("UR5", "7 joints", "100 boxes", "balls", "points", "triangles")
RATES = ("configurations", "motions", "proofs")
CALLS = {"one": 1, "none": 0}
"""Calls of a check -> the number of their configurations; they are timed among the boxes of the UR5 alone."""
STATES, MOTIONS, PROOFS, REPEATED = 16_000, 1_000, 200, 2_000


class Measured:
    """What is measured in the world of a kind.  Only names that the other checkout has, too, are imported."""

    def __init__(self, kind: str) -> None:
        import numpy as np
        from studies.benchmarks import arm_speed, frozen
        from tests.robots.kernel_arms import as_balls

        wide = arm_speed.ur5_world("box-reach")
        seven = arm_speed.load_robot("arm7")
        narrow = arm_speed.load_scene("box-reach-narrow")
        makers: dict[str, Callable[[], Any]] = {
            "UR5": lambda: wide,
            "7 joints": lambda: arm_speed.ArmWorld(seven, arm_speed.box_for(seven, narrow)),
            "100 boxes": lambda: arm_speed.ArmWorld(wide.robot, arm_speed.random_boxes()),
            "balls": lambda: arm_speed.ArmWorld(as_balls(wide.robot), wide.scene),
            "points": lambda: next(frozen.surface_worlds("points")),
            "triangles": lambda: next(frozen.surface_worlds("triangles")),
        }
        self.world = makers[kind]()
        self.q = self.world.space.from_cube(np.random.default_rng(0).random((STATES, self.world.space.dim)))
        self.a, self.b = arm_speed.motions(self.world, MOTIONS)

    @cached_property
    def proved(self) -> tuple[Any, Any, Any]:
        """The world that proves, and the ends of motions that it proves."""
        from evenroad.collision.certified import CertifiedWorld

        proving = CertifiedWorld(self.world)
        free = self.world.motion_valid(self.a, self.b)
        a, b = self.a[free], self.b[free]
        kept = proving.motion_valid(a, b)
        return proving, a[kept][:PROOFS], b[kept][:PROOFS]

    def verdicts(self) -> dict[str, str]:
        """Return which configurations and motions are free, as digits."""
        both = {"configurations": self.world.valid(self.q), "motions": self.world.motion_valid(self.a, self.b)}
        return {name: "".join(map(str, free.astype(int))) for name, free in both.items()}

    def task(self, measure: str) -> tuple[int, Callable[[], object]]:
        """Return how many things a measure counts, and what does them."""
        if measure == "configurations":
            return STATES, partial(self.world.valid, self.q)
        if measure == "motions":
            return len(self.a), partial(self.world.motion_valid, self.a, self.b)
        if measure == "proofs":
            world, a, b = self.proved
            return len(a), partial(world.motion_valid, a, b)
        some = self.q[: CALLS[measure]]
        return REPEATED, lambda: [self.world.valid(some) for _ in range(REPEATED)]


def serve() -> None:
    """Answer the requests of a process that compares, one a line."""
    # What else is printed must not come between the answers.
    answers, sys.stdout = sys.stdout, sys.stderr
    measured: Measured | None = None
    tasks: dict[str, tuple[int, Callable[[], object]]] = {}
    for line in sys.stdin:
        request, what = json.loads(line)
        if request == "open":
            measured, tasks = Measured(what), {}
            answer: object = measured.verdicts()
        else:
            assert measured is not None
            if what not in tasks:
                # What is compiled or kept on first use does not count.
                tasks[what] = measured.task(what)
                tasks[what][1]()
            count, do = tasks[what]
            began = process_time()
            do()
            answer = (process_time() - began) / max(count, 1)
        print(json.dumps(answer), file=answers, flush=True)


class Checkout:
    """A process that measures a checkout."""

    def __init__(self, folder: Path, more: Mapping[str, str] | None = None) -> None:
        paths = (folder / "src", folder, folder / "studies" / "src")
        code = f"import runpy; runpy.run_path({str(Path(__file__).resolve())!r})['serve']()"
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, paths))} | dict(more or {})
        self._process = Popen(
            [sys.executable, "-P", "-c", code], stdin=PIPE, stdout=PIPE, text=True, cwd=folder, env=environment
        )

    def answer(self, request: str, what: str) -> Any:
        """Return what the process answers."""
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        print(json.dumps([request, what]), file=stdin, flush=True)
        return json.loads(stdout.readline())

    def end(self) -> None:
        """Let the process end."""
        self._process.communicate()


def compared(checkouts: list[Checkout], measure: str, repeats: int) -> list[float]:
    """Return the shortest time of one thing in each checkout [s]."""
    best = [float("inf")] * len(checkouts)
    for _ in range(repeats):
        for i, each in enumerate(checkouts):
            best[i] = min(best[i], each.answer("time", measure))
    return best


def lines_of(kind: str, checkouts: list[Checkout], options: Namespace) -> Iterator[str]:
    """Yield a line for each measure of a kind of world."""
    verdicts = [each.answer("open", kind) for each in checkouts]
    for measure in (*RATES, *(CALLS if kind == KINDS[0] else ())):
        if options.measure not in measure:
            continue
        seconds = compared(checkouts, measure, options.repeats)
        own = f"{1e6 * seconds[0]:9.2f} us a call" if measure in CALLS else f"{1 / seconds[0]:12,.0f} a second"
        line = f"{kind:10} {measure:15} {own}"
        if len(seconds) > 1:
            line += f"   {seconds[1] / seconds[0]:5.2f} times the other's"
            if measure in verdicts[0]:
                mine, others = (each[measure] for each in verdicts)
                line += f", {sum(map(str.__ne__, mine, others))} of {len(mine)} differ"
        yield line


def main() -> None:
    from studies.benchmarks.rows import parser_of

    parser = parser_of(__doc__)
    parser.add_argument("--beside", type=Path, help="folder of the other checkout")
    parser.add_argument("--arch", help="build of this checkout's kernel, such as x86-64-v3; default: the best")
    parser.add_argument("--kind", default="", help="kinds of worlds whose names have this in them")
    parser.add_argument("--measure", default="", help="measures whose names have this in them")
    parser.add_argument("--repeats", type=int, default=15)
    options = parser.parse_args()
    checkouts = [Checkout(ROOT, {"EVENROAD_ARCH": options.arch} if options.arch else None)]
    if options.beside is not None:
        checkouts.append(Checkout(options.beside.resolve()))
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}", flush=True)
    for kind in KINDS:
        if options.kind in kind:
            for line in lines_of(kind, checkouts, options):
                print(line, flush=True)
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for each in checkouts:
        each.end()


if __name__ == "__main__":
    main()
