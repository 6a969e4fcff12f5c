"""Replanner: paths to one goal that are updated as the robot and the obstacles move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._checks import require_count
from evenroad._rng import RngLike
from evenroad._shared import OwnLock
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.planning.arm_updates import ArmUpdates
from evenroad.planning.read_problem import goal_of_arm
from evenroad.planning.reading import Goal, Reading
from evenroad.planning.result import PlanResult
from evenroad.robots.robot import ConfigurationLike
from evenroad.scenes.obstacle import Bodies
from evenroad.scenes.scene import Scene

if TYPE_CHECKING:
    from evenroad.driving import CarWorld, GoalRegion
    from evenroad.flight import FlightWorld, State
    from evenroad.planning.flight_updates import FlightUpdates
    from evenroad.planning.map_updates import Ahead, ChangedMap, MapUpdates
    from evenroad.world.gridmap import DiskWorld


@explains_calls
class Replanner:
    """A path of an arm, a car or a disk to its goal that is kept while it is free, and planned again when it is not.

    An update takes the arm's configuration and the changes of the scene.  It proves the rest of the last path free in
    the current scene, and shortens it where possible.  If the rest is not free, it plans a new path from the arm's
    configuration.  So every returned path is free in the current scene.

    For a car or a disk the scene is a map: an update takes where the robot is, and its current cells.  For a ball that
    flies it takes the state in motion, and where obstacles are that move, with their velocities.

    Parameters
    ----------
    world : ArmWorld, CarWorld, DiskWorld or FlightWorld
        The robot and its scene or map at the beginning.
    goal : as of :func:`evenroad.plan`
        A configuration, a named state, a pose, or several of them.  A pose stands for all postures that are free in the
        scene of the update.
    motions : int
        Of an arm: largest number of motions that trees check in one update, >= 1.  If no path is found, the next update
        grows other trees.
    rng : int, SeedSequence or Generator
        Seed of the sequences that drive the trees.
    tip, frame : str
        Of an arm: the link that goal poses refer to, and the link whose frame they are in; default: the last link, and
        the root.

    Attributes
    ----------
    world : ArmWorld, CarWorld, DiskWorld or FlightWorld
        The robot and its scene or map at the last update.
    stop : ndarray, shape (2, 6), or None
        Of what flies: the stop from the last state, which is proved; None if it is not.
    path : ndarray, shape (p, dim), or None
        The path of the last update.

    Raises
    ------
    InvalidValue, UnknownName
        If the world is another one, or the goal is not one of these.

    Notes
    -----
    Updates from several threads are answered in sequence.  The same updates give the same paths.

    Examples
    --------
    >>> import evenroad as er
    >>> live = er.Replanner(er.ArmWorld("ur5", "box-reach"), "inside")
    >>> live.update("home").planner
    'trees'
    >>> live.update("home", moved={"box top": er.Pose((0.6, 0, 0.9))}).planner
    'kept'

    A car whose map has changed:

    >>> import numpy as np
    >>> grid = er.GridMap(np.zeros((60, 90), dtype=bool), resolution=0.1)
    >>> car = grid.world(footprint=[(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)], turning_radius=0.5)
    >>> driving = er.Replanner(car, (8, 3, 0))
    >>> driving.update((1, 3, 0)).pieces.tolist()
    [[0.0, 7.0]]
    >>> cells = np.zeros((60, 90), dtype=bool)
    >>> cells[20:40, 50] = True
    >>> driving.ahead((1.5, 3, 0), cells)
    Ahead(free_until=3.19921875, length=6.5)
    >>> driving.update((1.5, 3, 0), cells).planner
    'curves'
    """

    def __init__(
        self,
        world: ArmWorld | CarWorld | DiskWorld | FlightWorld,
        goal: Goal | GoalRegion | State | Sequence[Goal | GoalRegion | State],
        *,
        motions: int = 600,
        rng: RngLike = 0,
        tip: str = "",
        frame: str = "",
    ) -> None:
        self._updates: ArmUpdates | MapUpdates | FlightUpdates
        most = require_count("motions", motions)
        if isinstance(world, ArmWorld):
            self._updates = ArmUpdates(world, goal_of_arm(goal), most, rng, Reading(tip=tip, frame=frame))
        else:
            # Imported late: an arm has no map, and does not fly.
            from evenroad.flight.flight_world import FlightWorld
            from evenroad.planning.flight_updates import FlightUpdates
            from evenroad.planning.map_updates import MapUpdates

            if isinstance(world, FlightWorld):
                self._updates = FlightUpdates(world, goal, rng)
            else:
                self._updates = MapUpdates(world, goal, rng)
        self._lock = OwnLock()

    @property
    def world(self) -> ArmWorld | CarWorld | DiskWorld | FlightWorld:
        """The robot and its scene or map at the last update."""
        return self._updates.world

    @property
    def path(self) -> Floats | None:
        """The path of the last update, (p, dim)."""
        return self._updates.path

    @property
    def stop(self) -> Floats | None:
        """Of what flies: the stop from the state of the last update, (2, 6), if it is proved."""
        return getattr(self._updates, "stop", None)

    def __repr__(self) -> str:
        return f"Replanner({self.world!r}, {self._updates.goals})"

    def update(
        self,
        q: ConfigurationLike | State,
        scene: Scene | ChangedMap | None = None,
        *,
        moved: Mapping[str, Pose] | None = None,
        velocities: Mapping[str, Sequence[float]] | None = None,
        elapsed: float = 0.0,
        added: Bodies = (),
        removed: str | Sequence[str] = (),
    ) -> PlanResult:
        """Return a path from the robot's configuration, free in the current scene, or why there is none.

        Parameters
        ----------
        q : array_like, shape (dim,), mapping or str
            Configuration of the robot, as a start of :func:`evenroad.plan`.
        scene : Scene, optional
            The current scene, in place of that of the last update.  For a car or a disk: its occupied cells, a bool
            array of the map's shape, a :class:`evenroad.GridMap` of the same frame, or a
            :class:`evenroad.PolygonMap`.
        moved : mapping of str to Pose, optional
            Name of an obstacle -> its current pose.
        velocities : mapping of str to 3 floats, optional
            For what flies: name of an obstacle that moves -> its current velocity [m/s].
        elapsed : float
            For what flies: time since the last update, >= 0 [s].  Obstacles that are not in `moved` flew on.
        added : sequence of Shape or Obstacle
            New obstacles.
        removed : sequence of str
            Names of obstacles that are gone; they are removed before others are added or moved.

        Returns
        -------
        PlanResult
            Its `planner` says whether the path is ``kept`` or new, from ``trees``, ``curves`` or ``cells``.  Without a
            path the robot should stop.  The status is ``budget_spent`` if the next update may find one.

        Raises
        ------
        InvalidValue, UnknownName
            If an argument is not one of these; the replanner does not change then.

        Examples
        --------
        >>> import evenroad as er
        >>> live = er.Replanner(er.ArmWorld("ur5"), "home")
        >>> live.update([1, 0, 0, 0, 0, 0], added=[er.Sphere(0.2, xyz=(0, 0.1, 0.9), name="ball")]).status
        <Status.GOAL_INVALID: 'goal_invalid'>
        """
        with self._lock:
            if isinstance(self._updates, ArmUpdates):
                return self._updates.update(q, scene, moved, added, removed)
            # Imported late, as above.
            from evenroad.planning.flight_updates import FlightUpdates

            if isinstance(self._updates, FlightUpdates):
                if scene is not None or added or removed:
                    raise InvalidValue("for what flies obstacles move: give moved and velocities")
                return self._updates.update(q, moved, velocities, elapsed)
            if velocities is not None or elapsed:
                raise InvalidValue("velocities and elapsed are for what flies, in a FlightWorld")
            if moved is not None or added or removed:
                raise InvalidValue("obstacles that are moved, added or removed are an arm's; a map has new cells")
            return self._updates.update(q, scene)

    def ahead(self, q: ConfigurationLike, scene: ChangedMap | None = None) -> Ahead:
        """Return how much of the path that is driven is still free, without planning another one.

        Parameters
        ----------
        q : array_like, shape (dim,)
            Where the car or the disk is.
        scene : optional
            The current map, as of :meth:`update`.

        Returns
        -------
        Ahead
            ``free_until``, the length from the robot on that is proved free, ``length`` of the rest of the path, and
            ``is_free``.

        Raises
        ------
        InvalidValue
            For an arm, or before the first path.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> disk = er.GridMap(np.zeros((40, 90), dtype=bool), resolution=0.1).world(radius=0.3)
        >>> live = er.Replanner(disk, (8, 2))
        >>> live.update((1, 2)).cost
        7.0
        >>> live.ahead((2, 2))
        Ahead(free_until=6.0, length=6.0)
        """
        with self._lock:
            # Imported late, as above.
            from evenroad.planning.map_updates import MapUpdates

            if not isinstance(self._updates, MapUpdates):
                raise InvalidValue("ahead is of cars and disks: the update of others says whether its path is kept")
            return self._updates.ahead(q, scene)
