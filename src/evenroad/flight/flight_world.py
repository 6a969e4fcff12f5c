"""FlightWorld: a ball that flies among the obstacles of a scene, with proofs of its states and motions."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_batch, as_row, counted, require_known, require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad._native.flight import Airspace
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.flight.flight_bodies import FlightBodies, bodies_of
from evenroad.flight.flight_space import FlightSpace, of_axes
from evenroad.geometry.pose import Vector
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import load_scene
from evenroad.space.batch import as_batch_pair
from evenroad.world.one_or_many import OneOrMany, one_or_many

_BEYOND = 100.0
"""Least distance of the default bounds from the obstacles [m]."""
HORIZON = 1000.0
"""Default time up to which obstacles keep their velocities [s]."""
_MOST_OF_BOUND = 2.5
"""Largest lower bound of a time, as a multiple of that without obstacles."""
_WORDS_OF_BOUND = 4_000_000
"""Size of the lattice of a lower bound, in words of eight bytes: found in about half a second."""
_NEAREST = 1e-2
"""Distance up to which an obstacle is named that is in the way, beyond the radius [m]."""


class Movers(NamedTuple):
    """Positions and velocities of the obstacles that move, (m, 3), and the world's tables with these."""

    at: Floats
    to: Floats
    airspace: Airspace
    bodies: FlightBodies
    space: FlightSpace
    made_of: tuple[object, ...]
    """What the tables are of: scene, radius, limits, bounds and velocities."""

    @property
    def positions(self) -> dict[str, list[float]]:
        """Obstacle -> its position."""
        velocities = self.made_of[-1]
        assert isinstance(velocities, Mapping), "the last one"
        return dict(zip(velocities, self.at.tolist(), strict=True))


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class FlightWorld(OneOrMany):
    """A ball with a velocity among obstacles, a double integrator: its acceleration is chosen at every instant.

    A state is x, y, z and the velocities along these; see :class:`evenroad.flight.FlightSpace` for the motion from one
    state to another.  A motion is free only if that is proved for all of it: it consists of parabolas, and a plane
    keeps each part of them away from each obstacle.  A motion that comes within about 1 mm of touching may be refused.

    Parameters
    ----------
    scene : Scene, str or path-like
        The obstacles, or the file or name of a scene: boxes, cylinders, spheres, capsules, meshes and clouds.
    radius : float
        Radius of the ball, > 0 [m].
    speed : float or sequence of 3 floats
        Largest speed along each axis, or along any of them, > 0 [m/s].
    acceleration : float or sequence of 3 floats
        Largest acceleration along each axis, > 0 [m/s^2].
    jerk : None
        Limits of the jerk are not supported yet.
    bounds : sequence of 3 pairs of floats, optional
        Least and largest x, y and z of the middle of the ball [m].  Two equal numbers hold an axis: the flight is then
        planar.  Default: the box around all obstacles, larger by its longest side and 100 m.
    velocities : mapping of str to 3 floats
        Obstacle -> its velocity, of those that move [m/s]; the scene is that of time 0.  Meshes and clouds stay.

    Raises
    ------
    InvalidValue
        If a number is not such a one.
    NotAvailable
        For a limit of the jerk.

    Examples
    --------
    >>> import evenroad as er
    >>> scene = er.Scene([er.Cylinder(0.3, 4.0, xyz=(5, 0, 2), name="tree")])
    >>> world = er.FlightWorld(scene, radius=0.25, speed=6.0, acceleration=8.0)
    >>> result = er.plan(world, er.State((0, 0, 2)), er.State((10, 0.1, 2)))
    >>> result.status, result.proof
    (<Status.SOLVED: 'solved'>, 'certified')
    """

    scene: Scene
    radius: float = 0.25
    speed: Vector | float = field(kw_only=True)
    acceleration: Vector | float = field(kw_only=True)
    jerk: None = field(default=None, kw_only=True)
    bounds: Sequence[Sequence[float]] | None = field(default=None, kw_only=True)
    velocities: Mapping[str, Sequence[float]] = field(default_factory=dict, kw_only=True)
    space: FlightSpace = field(init=False, repr=False)
    airspace: Airspace = field(init=False, repr=False)
    """The obstacles and limits, as compiled code has them."""
    _movers: Movers | None = field(default=None, repr=False, kw_only=True)
    _bodies: FlightBodies = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.jerk is not None:
            raise NotAvailable(f"limits of the jerk are not supported yet: leave jerk out, got {shown(self.jerk)}")
        known, own = self._movers, (self.scene, self.radius, self.speed, self.acceleration, self.bounds)
        if known is not None and all(map(operator.is_, known.made_of, (*own, self.velocities))):
            # Of a world that is the same but for what moved.
            set_fields(self, space=known.space, airspace=known.airspace, _bodies=known.bodies)
            return
        scene = load_scene(self.scene) if isinstance(self.scene, str | os.PathLike) else self.scene
        if not isinstance(scene, Scene):
            raise InvalidValue(f"scene must be a Scene, or the file or name of one, got {shown(self.scene)}")
        radius = require_positive("radius", self.radius, at_most=FARTHEST)
        speed, acceleration = of_axes("speed", self.speed), of_axes("acceleration", self.acceleration)
        bodies = bodies_of(scene)
        low, high = _default_bounds(bodies.box) if self.bounds is None else _as_bounds(self.bounds)
        space = FlightSpace(low, high, speed, acceleration)
        if not isinstance(self.velocities, Mapping):
            raise InvalidValue(f"velocities must be a mapping, obstacle -> velocity, got {shown(self.velocities)}")
        velocities = {name: _as_velocity(name, each) for name, each in self.velocities.items()}
        movers = np.array([_number_of(name, bodies, scene) for name in velocities], dtype=np.int64)
        airspace = Airspace(
            bodies.solids, bodies.triangles, bodies.balls, movers, np.array([low, high]), space.native, radius
        )
        at, to = bodies.solids[movers, 13:16].copy(), np.array([*velocities.values()]).reshape(-1, 3)
        if known is not None and known.made_of[0] is scene:
            flown = known.positions
            at = np.array([flown.get(name, row) for name, row in zip(velocities, at.tolist(), strict=True)]).reshape(
                -1, 3
            )
        airspace = airspace.with_moved(at, to)
        box = tuple(zip(low, high, strict=True))
        set_fields(self, scene=scene, radius=radius, speed=speed, acceleration=acceleration, bounds=box)
        set_fields(self, velocities=velocities, space=space, airspace=airspace, _bodies=bodies)
        made_of = scene, self.radius, self.speed, self.acceleration, self.bounds, self.velocities
        set_fields(self, _movers=Movers(at, to, airspace, bodies, space, made_of))

    def __reduce__(self) -> tuple[object, ...]:
        """Return what a copy is made of, here or in another process: it makes its own tables."""
        made_of = self.scene, self.radius, self.speed, self.acceleration, self.bounds, self.velocities
        return _world_of, (*made_of, self._moving.at)

    @property
    def positions(self) -> dict[str, list[float]]:
        """Positions of the obstacles that move [m]."""
        return self._moving.positions

    @property
    def proof(self) -> str:
        """What a check of a motion shows: ``certified``.

        It is never called free if it is not, but may be refused where it comes within about 1 mm of touching.
        """
        return "certified"

    def __repr__(self) -> str:
        names = self.scene.names
        limits = f"speed {self.speed}, acceleration {self.acceleration}"
        return f"FlightWorld({counted(len(names), 'obstacle')}, radius {self.radius:g}, {limits})"

    @one_or_many
    def valid(self, q: Floats) -> Bools:
        """Return whether the ball is free, within bounds and not too fast in each state, (n, 6): (n,)."""
        states = as_batch("q", q, 6)
        return self.airspace.states_free(states) & self._outside(states)

    @one_or_many
    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return whether the quickest motion from each row of `a` to that of `b` is proved free: two (m, 6) -> (m,)."""
        first, second = as_batch_pair(a, b, 6)
        # A ball that touches no side of a mesh on its way stays outside.
        return self.airspace.motions_free(first, second) & self._outside(first)

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, 6), are proved free when it is flown from time 0 on: (p - 1,)."""
        states = as_batch("path", path, 6)
        return self.airspace.path_free(states) & self._outside(states[:-1])

    def free_until(self, path: Floats, horizon: float = HORIZON) -> float:
        """Return until when a flight is proved free, from time 0 on, with the rest at its last state.

        Parameters
        ----------
        path : array_like, shape (p, 6)
            States, joined by the quickest motions.
        horizon : float
            Time up to which the motions of obstacles are known, >= 0 [s].

        Returns
        -------
        float
            At most the horizon; of a path that ends in motion, at most its duration [s].

        Raises
        ------
        InvalidValue
            If these are not such.

        Examples
        --------
        >>> import evenroad as er
        >>> ball = er.Scene([er.Sphere(0.5, xyz=(9, 0, 1), name="ball")])
        >>> world = er.FlightWorld(ball, speed=6.0, acceleration=8.0, velocities={"ball": (-1, 0, 0)})
        >>> path = er.plan(world, er.State((0, 0, 1)), er.State((0, 3, 1))).path
        >>> world.free_until(path), round(world.free_until([path[0], path[0]]), 2)
        (1000.0, 8.25)
        """
        limit, states = require_positive("horizon", horizon, or_zero=True, at_most=FARTHEST), as_batch("path", path, 6)
        return self.airspace.free_until(states, limit) if self._outside(states[:1]).all() else 0.0

    def least_length(self, start: Floats, goals: Floats) -> float:
        """Return a time that no flight from the start, (6,), to any goal, (g, 6), beats; at most 2.5 times the least.

        It heeds obstacles that stay and are as high as the bounds: see the guide.

        Parameters
        ----------
        start : array_like, shape (6,)
            Where flights begin.
        goals : array_like, shape (g, 6)
            Where they may end.

        Returns
        -------
        float
            That time [s].

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> wall = er.Box((1.0, 8.0, 9.0), xyz=(5, 3.5, 2), name="wall")
        >>> bounds = [(-1, 11), (-9, 9), (1, 3)]
        >>> world = er.FlightWorld(er.Scene([wall]), speed=6.0, acceleration=8.0, bounds=bounds)
        >>> start, goal = er.State((0, 5, 2)), er.State((10, 5, 2))
        >>> round(world.least_length(np.array(start), np.array([goal])), 1)
        2.4
        """
        times = self.space.distance(np.broadcast_to(start, goals.shape), goals)
        begin, least = np.ascontiguousarray(start), math.inf
        for number in np.argsort(times, kind="stable").tolist():
            # Farther goals take longer, whatever is in the way.
            if times[number] >= least:
                break
            most = min(_MOST_OF_BOUND * float(times[number]), least)
            goal = np.ascontiguousarray(goals[number])
            least = min(least, self.airspace.least_time(begin, goal, most, _WORDS_OF_BOUND))
        return least

    def _outside(self, states: Floats) -> Bools:
        """Return for each state, (n, 6), whether the middle of the ball is inside of no closed mesh: (n,)."""
        outside = np.ones(len(states), dtype=bool)
        for solid in self._bodies.inside:
            outside &= ~solid.contains(states[:, :3])
        return outside

    def with_moved(
        self,
        positions: Mapping[str, Sequence[float]],
        velocities: Mapping[str, Sequence[float]],
        elapsed: float = 0.0,
    ) -> FlightWorld:
        """Return the world some time later, with obstacles that moved to other positions or have other velocities.

        Parameters
        ----------
        positions, velocities : mapping of str to 3 floats
            Obstacle -> its position [m] and velocity [m/s]; the others keep their velocity, and flew on.  Only those
            move that the world has `velocities` of, which may be 0.
        elapsed : float
            How much later it is, >= 0 [s].

        Returns
        -------
        FlightWorld
            Its scene is still that of the beginning.

        Raises
        ------
        UnknownName
            For another obstacle.
        InvalidValue
            For numbers that are none.

        Examples
        --------
        >>> import evenroad as er
        >>> ball = er.Scene([er.Sphere(0.5, xyz=(9, 0, 1), name="ball")])
        >>> world = er.FlightWorld(ball, speed=6.0, acceleration=8.0, velocities={"ball": (-1, 0, 0)})
        >>> world.with_moved({}, {}, elapsed=9.0).valid((0, 0, 1, 0, 0, 0))
        False
        """
        elapsed = require_positive("elapsed", elapsed, or_zero=True, at_most=FARTHEST)
        known, movers = tuple(self.velocities), self._moving
        at, to = movers.at + elapsed * movers.to, movers.to.copy()
        for table, given, what in ((at, positions, "position"), (to, velocities, "velocity")):
            for name, value in given.items():
                require_known("obstacle that moves:", name, known)
                table[known.index(name)] = as_row(f"the {what} of {name!r}", value, 3, within=FARTHEST)
        changed = {**self.velocities, **{name: _as_velocity(name, each) for name, each in velocities.items()}}
        made_of = *movers.made_of[:-1], changed
        movers = movers._replace(at=at, to=to, airspace=self.airspace.with_moved(at, to), made_of=made_of)
        return replace(self, velocities=changed, _movers=movers)

    @property
    def _moving(self) -> Movers:
        assert self._movers is not None, "it is set when the world is made"
        return self._movers

    def explain(self, q: Floats) -> str:
        """Return, in words, why a state, (6,), is not free: a limit, or the obstacle that is touched."""
        state = as_batch("q", [q], 6)
        low, high = self.space.box
        for name, value, least, most in zip(self.space.names, state[0], low, high, strict=True):
            if not least <= value <= most:
                return f"{name} must be from {least:.6g} to {most:.6g}, got {value:.6g}"
        for solid in self._bodies.inside:
            if solid.contains(state[:, :3])[0]:
                return f"it is inside of {solid.name!r}"
        found = self.airspace.nearest(state[0, :3].copy(), self.radius + _NEAREST)
        if found.body < 0 or self.airspace.states_free(state)[0]:
            return "nothing touches"
        by = f"its middle is {found.distance:.3g} m away and its radius {self.radius:g} m"
        return f"the ball touches {self._bodies.name_of(found.body)!r}: {by}"

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of obstacles, ball and limits: equal for worlds of equal results."""
        return fingerprint_of(
            *("flight", self.scene.fingerprint(), self.radius, self.speed, self.acceleration, self.bounds),
            self.velocities,
            self._moving.at,
        )


def _world_of(
    scene: Scene,
    radius: float,
    speed: Vector,
    acceleration: Vector,
    bounds: Sequence[Sequence[float]],
    velocities: Mapping[str, Vector],
    at: Floats,
) -> FlightWorld:
    world = FlightWorld(scene, radius, speed=speed, acceleration=acceleration, bounds=bounds, velocities=velocities)
    return world.with_moved(dict(zip(velocities, at.tolist(), strict=True)), {})


def _as_velocity(name: str, value: Sequence[float]) -> Vector:
    x, y, z = as_row(f"the velocity of {name!r}", value, 3, within=FARTHEST)
    return x, y, z


def _number_of(name: str, bodies: FlightBodies, scene: Scene) -> int:
    """Return the row of an obstacle that may move."""
    require_known(f"obstacle of scene {scene.name!r}:", name, scene.names)
    if name not in bodies.names[: len(bodies.solids)]:
        raise InvalidValue(f"a mesh or a cloud cannot move, but {name!r} has a velocity")
    return bodies.names.index(name)


def _as_bounds(bounds: Sequence[Sequence[float]]) -> tuple[Vector, Vector]:
    """Return the corners of bounds that are given as pairs."""
    wanted = "bounds must be three pairs of finite numbers, (least, largest) of x, y and z"
    try:
        pairs = [as_row("bounds", pair, 2, within=FARTHEST) for pair in bounds]
    except (TypeError, InvalidValue):
        pairs = []
    if len(pairs) != 3 or any(least > most for least, most in pairs):
        raise InvalidValue(f"{wanted}, got {shown(bounds)}")
    (x, right), (y, back), (z, top) = pairs
    return (x, y, z), (right, back, top)


def _default_bounds(box: Floats) -> tuple[Vector, Vector]:
    beyond = _BEYOND + float((box[1] - box[0]).max())
    low, high = np.clip(box + np.array([[-beyond], [beyond]]), -FARTHEST, FARTHEST).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])
