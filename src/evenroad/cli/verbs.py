"""Parses the command line, runs one verb, and turns our errors into one line and exit code 2."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Annotated, Any, Union

import tyro

from evenroad import __version__
from evenroad.cli.bench import Bench
from evenroad.cli.demo import Demo
from evenroad.cli.export import Export
from evenroad.cli.measure import Measure
from evenroad.cli.plan import PlanDisk, plan_type
from evenroad.cli.points import Points
from evenroad.cli.report import Report
from evenroad.cli.robot import Robot
from evenroad.cli.train import Train
from evenroad.errors import EvenroadError

DONE = 0
BAD_INPUT = 2

LONGEST = 600
"""Most characters of an error: input that was pasted by mistake is not shown in full."""

VERBS = {
    "plan": PlanDisk,
    "points": Points,
    "measure": Measure,
    "train": Train,
    "bench": Bench,
    "report": Report,
    "robot": Robot,
    "export": Export,
    "demo": Demo,
}

DESCRIPTION = f"""evenroad {__version__}: point sets that make sampling-based motion planners need fewer samples.

Exit codes: 0 solved / done, 1 any other answer (no path), 2 bad input, 130 interrupted.
"""


def run(arguments: Sequence[str]) -> int:
    """Run the verb that the arguments ask for and return the exit code."""
    if list(arguments) == ["--version"]:
        print(f"evenroad {__version__}")
        return 0
    try:
        code: int = _parse(list(arguments)).run()
        sys.stdout.flush()
        return code
    except EvenroadError as error:
        print(f"evenroad: error: {_in_one_line(str(error))}", file=sys.stderr)
        return BAD_INPUT
    except MemoryError as error:
        print(f"evenroad: error: not enough memory: {_in_one_line(str(error))}", file=sys.stderr)
        return BAD_INPUT
    except BrokenPipeError:
        # The reader of our output has gone, as `head` does; what is left of the output goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except OSError as error:
        print(f"evenroad: error: {_in_one_line(str(error))}", file=sys.stderr)
        return BAD_INPUT


def _parse(arguments: list[str]) -> Any:
    """Return the verb with its options; with none, or options that cannot be read, tyro says so and exits."""
    verbs: dict[str, Any] = dict(VERBS)
    if arguments[:1] == ["plan"]:
        verbs["plan"] = plan_type(arguments)
    kinds = tuple(
        Annotated[kind, tyro.conf.subcommand(name, prefix_name=False)] for name, kind in verbs.items()
    )
    any_of: Any = Union[kinds]  # noqa: UP007
    return tyro.cli(
        any_of,
        prog="evenroad",
        description=DESCRIPTION,
        args=arguments or ["--help"],
        config=(tyro.conf.OmitArgPrefixes, tyro.conf.FlagCreatePairsOff),
    )


def _in_one_line(text: str) -> str:
    """Return a text in one line, without its middle where it is too long: what is wrong, and what is allowed, stay."""
    line = " ".join(text.split())
    if len(line) <= LONGEST:
        return line
    return f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"
