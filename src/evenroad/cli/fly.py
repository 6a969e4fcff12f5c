"""``evenroad fly SCENE``: a flight of a ball among the obstacles of a scene."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._checks import counted, require_positive
from evenroad._terminal import print_table
from evenroad.cli.options import Positional
from evenroad.cli.outputs import require_output
from evenroad.errors import InvalidValue
from evenroad.flight.flight_world import FlightWorld
from evenroad.flight.state import State
from evenroad.planning.plan import plan
from evenroad.scenes.scene_file import find_scene, load_scene


@dataclass(frozen=True, kw_only=True)
class Fly:
    """Plan a flight of a ball with limits of speed and acceleration, all of it proved free.

    Start and goal are x y z, or x y z and the three velocities along these.
    It writes the states (.csv), the coefficients of the polynomials (.json) and a picture from above (.png).
    Example: evenroad fly forest.yaml --start 0 0 2 --goal 18 0 2 --speed 6 --acceleration 8
    """

    scene: Positional[Path]
    """The file or name of a scene."""
    start: tuple[str, ...]
    """Where it begins: x y z, or x y z vx vy vz [m, m/s]."""
    goal: tuple[str, ...]
    """Where it ends, in the same way."""
    speed: float
    """Largest speed along each axis [m/s]."""
    acceleration: float
    """Largest acceleration along each axis [m/s^2]."""
    radius: float = 0.25
    """Radius of the ball [m]."""
    time: float = 5.0
    """Largest time for the plan [s]."""
    step: float = 0.01
    """Time between two states of the .csv [s]."""
    seed: int = 0
    """Another seed gives another flight."""
    out: Path | None = None
    """Name of the files.  Default: that of the scene in the current folder, with -flight."""
    no_picture: bool = False
    """Write no picture."""
    json: bool = False
    """Print the answer as JSON, not as a table."""

    def run(self) -> int:
        """Plan, write, report; return 0 when solved, else 1."""
        start, goal = _state("start", self.start), _state("goal", self.goal)
        step, seconds = require_positive("step", self.step), require_positive("time", self.time)
        inputs = [find_scene(self.scene)]
        if self.out is not None and not self.out.name:
            raise InvalidValue(f"--out must end with a file name, got {str(self.out)!r}")
        stem = Path(f"{self.scene.stem}-flight") if self.out is None else self.out.with_suffix("")
        files = [stem.with_name(f"{stem.name}.{suffix}") for suffix in ("csv", "json", "png")]
        files = files[:2] if self.no_picture else files
        for file in files:
            require_output(f"--out {stem}", file, inputs)
        world = FlightWorld(load_scene(self.scene), self.radius, speed=self.speed, acceleration=self.acceleration)
        result = plan(world, start, goal, seconds=seconds, rng=self.seed)
        rows = [("status", f"{result.status}: {result.message}")]
        said: dict[str, object] = {"status": str(result.status), "message": result.message, "seconds": result.seconds}
        if result.path is not None:
            flight = result.trajectory(step=step)
            flight.save(files[0])
            flight.save(files[1])
            assert result.gap is not None, "there is a path"
            said |= {"duration": flight.duration, "proof": flight.proof, "gap": result.gap}
            rows += [
                ("flight", f"{flight.duration:.4g} s in {counted(len(flight.pieces), 'polynomial piece')}"),
                ("proof", "certified: the ball touches nothing at any instant"),
                ("at most", f"{100.0 * result.gap:.1f} % longer than the quickest flight"),
            ]
        else:
            files = files[2:]
        if not self.no_picture:
            result.plot(files[-1])
        rows += [("took", f"{1e3 * result.seconds:.1f} ms"), ("files", ", ".join(map(str, files)) or "none")]
        if self.json:
            print(json.dumps(said | {"files": [str(file) for file in files]}, indent=2))
        else:
            print_table(rows)
        return 0 if result.solved else 1


def _state(name: str, words: tuple[str, ...]) -> State:
    """Return the state that three or six words say."""
    text = " ".join(words)
    try:
        numbers = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    if len(numbers) not in (3, 6) or not np.isfinite(numbers).all():
        raise InvalidValue(f"--{name} must be three or six finite numbers, x y z vx vy vz, got {text!r}")
    return State(numbers[:3], numbers[3:] or (0.0, 0.0, 0.0))  # type: ignore[arg-type]
