"""``--trajectory`` and ``--timed`` of plans on maps: the path of a disk or a car with times."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

from evenroad.cli.options import Repeatable
from evenroad.errors import InvalidValue

if TYPE_CHECKING:
    from evenroad.planning.result import PlanResult
    from evenroad.trajectory.formats import Saved

_WHAT = ("trajectory", "timed")


@dataclass(frozen=True, kw_only=True)
class MapTimes:
    """Options of times on a map."""

    trajectory: Repeatable[tuple[Path, ...]] = ()
    """Write a trajectory: .csv, .json, .yaml (ROS 2 nav_msgs/Path) or .mcap (the same as a bag).  You can give several.
    """
    timed: bool = False
    """Give the path its times, which OUT.json keeps for evenroad view; so does --trajectory."""
    speed: float = 1.0
    """With times: largest speed, > 0, in map units per second."""
    acceleration: float | None = None
    """With times: largest acceleration, > 0 (default: full speed after half a second)."""
    deviation: float = 0.05
    """With times: largest deviation from the path, >= 0, where corners are rounded; 0 stops at each."""
    step: float = 0.008
    """With times: time between two states in seconds, > 0."""

    def require_times(self, inputs: Iterable[Path], outputs: Iterable[Path]) -> None:
        """Raise InvalidValue for options that would fail after planning, or overwrite an input or another result."""
        of_times = [each for each in fields(self) if each.name in _names(type(self))]
        if not (self.trajectory or self.timed):
            for each in of_times:
                if getattr(self, each.name) != each.default:
                    raise InvalidValue(f"--{each.name.replace('_', '-')} goes with --trajectory or --timed only")
            return
        # Imported late: the help needs no numpy, and plans without times need no SciPy.
        from evenroad._checks import require_positive
        from evenroad.cli.outputs import require_output
        from evenroad.trajectory.formats import CAR_WRITERS, format_of

        for each in of_times:
            if (value := getattr(self, each.name)) is not None:
                require_positive(each.name, value, or_zero=each.name == "deviation")
        results = {output.resolve() for output in outputs}
        for file in self.trajectory:
            format_of(file, CAR_WRITERS)
            require_output("--trajectory", file, inputs)
            if file.resolve() in results:
                raise InvalidValue(f"--trajectory {file} is a file of another result of this plan; name another one")
            results.add(file.resolve())

    def with_times(
        self, result: PlanResult, source: Mapping[str, object]
    ) -> tuple[list[tuple[str, str]], dict[str, object]]:
        """Write the trajectory of a solved plan, with its `source`; return rows for the table, and its record."""
        if not (self.trajectory or self.timed):
            return [], {}
        for file in self.trajectory:
            file.unlink(missing_ok=True)
        if not result.solved or result.path is None:
            return [], {"trajectory": None}
        if (result.path == result.path[0]).all():
            return [("trajectory", "none: the start is the goal")], {"trajectory": None}
        from evenroad.trajectory.formats import record_of, save_trajectories

        given = {name: getattr(self, name) for name in _names(type(self))}
        made = result.trajectory(**{name: value for name, value in given.items() if value is not None})
        save_trajectories(self.trajectory, replace(made, source=source))
        same = {name: getattr(made, name) for name in ("duration", "deviation", "stops", "proof")}
        record = {
            "files": [str(file) for file in self.trajectory],
            **same,
            "states": record_of(replace(made, world=None)),
        }
        said = [("trajectory", about(made))]
        return said + ([("", ", ".join(map(str, self.trajectory)))] if self.trajectory else []), {"trajectory": record}


@dataclass(frozen=True, kw_only=True)
class CarTimes(MapTimes):
    """Options of times of a car."""

    lateral: float | None = None
    """With times: largest acceleration across the path in turns, > 0 (default: --acceleration)."""
    curvature_rate: float | None = None
    """With times: largest change of the curvature in a second, > 0; jumps become clothoids or stops."""
    angular_speed: float | None = None
    """With times: largest speed of turns, > 0, in radians per second."""
    angular_acceleration: float | None = None
    """With times: largest acceleration of turns, > 0."""


def _names(kind: type) -> list[str]:
    """Return the names of the options that go with times."""
    there = {each.name for each in fields(CarTimes)} & {each.name for each in fields(kind)}
    return sorted(there - {*_WHAT})


def about(made: Saved) -> str:
    """Return a trajectory in one line."""
    counts = [f"{number} {what}" for what in ("blends", "stops") if (number := getattr(made, what, 0))]
    return "; ".join([f"{made.duration:.3f} s", f"{made.deviation:.2g} off the path", *counts, made.proof])
