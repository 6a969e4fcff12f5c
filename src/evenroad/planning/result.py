"""PlanResult: a path, or the reason why there is none, with all counts."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._hints import KnowsElsewhere
from evenroad._rows import Rows
from evenroad.collision.validate import MeshCheck
from evenroad.errors import InvalidValue
from evenroad.planning.result_html import as_html
from evenroad.planning.searched import SearchedGraph as SearchedGraph
from evenroad.planning.searched import Stage as Stage
from evenroad.points.pointset import Origin
from evenroad.poses.pose_goal import PoseGoal
from evenroad.roadmap.certificate import Certificate
from evenroad.space.path import path_length, resample
from evenroad.world import BoundsLengths, MeasuresPaths, NamesNearest, World

if TYPE_CHECKING:
    from PIL.Image import Image

    from evenroad.trajectory import Trajectory

_File: TypeAlias = str | os.PathLike[str]
NO_POINTS = Origin(family="none", method="no points")
"""Origin of a result whose planner draws no points."""


class Status(StrEnum):
    """How a query ended.  No path is an answer, not an error."""

    SOLVED = "solved"
    START_INVALID = "start_invalid"
    GOAL_INVALID = "goal_invalid"
    START_OUTSIDE_LIMITS = "start_outside_limits"
    GOAL_OUTSIDE_LIMITS = "goal_outside_limits"
    GOAL_UNREACHABLE = "goal_unreachable"
    NOT_CONNECTED = "not_connected"
    BUDGET_SPENT = "budget_spent"
    MESH_COLLISION = "mesh_collision"
    NOT_CERTIFIED = "not_certified"


@explains_calls
@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class PlanResult(Rows, metaclass=KnowsElsewhere):
    """The answer to one query: true if it is solved, and to NumPy the rows of its path.

    Attributes
    ----------
    status : Status
        ``goal_invalid``: all goals are.  ``start_outside_limits``, ``goal_outside_limits``: outside of the limits of a
        joint or a map; the message says which.  ``goal_unreachable``: no configuration was found for a pose.
        ``mesh_collision``: the path is free in its world, but the robot's meshes touch something.  ``not_certified``: a
        proof was requested, and the path is free only at states tested.
    message : str
        One sentence for people: what happened and, without a path, what to try.
    start, goals : ndarrays, shapes (dim,) and (g, dim)
        Start and goals of the query.
    goal_index : int or None
        Row of the goal that the path ends at; None without a path.
    path : ndarray, shape (p, dim), or None
        Waypoints after shortcutting, from start to goal, in the units of the space.  Continuous joints begin at the
        numbers of the start, and change without jumps; if they end at another turn than the goal's, the message says
        so.
    milestone_path : ndarray, shape (q, dim), or None
        The path before shortcutting, such as the path along the roadmap.
    pieces : ndarray, shape (k, 2), or None
        What a car drives along `path`: curvatures and signed lengths, as of :meth:`evenroad.driving.CarSpace.pieces`.
    proof : str or None
        Kind of proof for the motions of `path`: ``exact`` (no gap, up to rounding), ``certified`` (no gap), or
        ``resolution`` (free at states close together); None without a path.
    cost, milestone_cost : float or None
        Costs of the two paths: lengths in the metric of the space, or the user's edge costs.
    counts : dict of str to int
        ``points`` (N), ``valid`` (milestones known to be valid), ``configurations_checked`` (without those inside
        motions), ``edges_considered``, ``edges_checked``, ``edges_free`` (known to be free),
        ``shortcut_motions``, ``nodes`` (of trees), ``rounds`` (of a planner that improves).  If not connected, also
        ``start_component`` and ``goal_component``: the numbers of milestones that start and goals can reach over nodes
        and edges that are not known to be blocked.
    timings : dict of str to float
        Wall time of each phase [s]: ``validity``, ``neighbours``, ``motions``, ``search``, ``shortcut``.
    origin : Origin
        Origin of the points.
    rule : str
        The connection rule, by name.
    links : int or None
        Number of links of the query; see :func:`plan`.
    planner : str
        Name of the search: ``prm full``, ``prm lazy``, ``prm any`` (some path, not the shortest), ``prm anytime``,
        ``fmt*``, ``trees`` or ``cells``.
    deviation : dict of str to float
        Largest deviations of a path under tip constraints, on fine grids: ``line_m`` and ``line_rad`` from the
        straight lines, ``tilt_rad`` from upright.
    stages : tuple of Stage
        Stages of a plan that grows or improves, with costs over time; else empty.
    certificate : Certificate or None
        Guarantees of the roadmap, if :func:`plan` was called with ``certify``.  If it is `complete` and there is no
        path, no path has a clearance of its `dispersion`.
    roadmap : SearchedGraph or None
        The searched graph; None if start or goal is invalid, and for a reused roadmap.
    meshes : MeshCheck or None
        Result of the check with the meshes of the arm's file, if it has any; not in a plan that was read from a file.
    notes : tuple of str
        Notes, one line each, about what was changed in reading the robot or map, and what seems unusual in them or in
        the scene.
    world : World or None
        World of the query; None in a plan that was read from a file.
    poses : tuple of PoseGoal
        The poses among the goals, of which `goals` has the postures found; empty in a plan that was read from a file.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> round(er.plan(world, (3, 3), (27, 17)).cost, 3)
    27.785
    """

    status: Status
    message: str
    start: Floats
    goals: Floats
    origin: Origin
    rule: str
    links: int | None = None
    planner: str = "prm full"
    goal_index: int | None = None
    path: Floats | None = None
    milestone_path: Floats | None = None
    pieces: Floats | None = None
    proof: str | None = None
    cost: float | None = None
    milestone_cost: float | None = None
    counts: dict[str, int] = field(default_factory=dict)
    timings: dict[str, float] = field(default_factory=dict)
    deviation: dict[str, float] = field(default_factory=dict)
    stages: tuple[Stage, ...] = ()
    certificate: Certificate | None = None
    roadmap: SearchedGraph | None = None
    meshes: MeshCheck | None = None
    notes: tuple[str, ...] = ()
    world: World | None = field(default=None, repr=False)
    poses: tuple[PoseGoal, ...] = field(default=(), repr=False)

    @cached_property
    def clearance(self) -> float | None:
        """Lower bound of the path's distance from all obstacles; None if the world cannot measure it.

        For a disk it is in map units, exact within 1e-3 pixels.  For an arm it is in metres, proved for its `bodies`,
        within 0.1 mm, and at most 1 m.  It includes the clearances of the query and of obstacles, and the padding of
        links.  It is computed on first use; for an arm this takes some milliseconds.
        """
        if self.path is None or not isinstance(self.world, MeasuresPaths):
            return None
        return self.world.path_clearance(self.path)

    @cached_property
    def nearest(self) -> tuple[str, str] | None:
        """The link and the obstacle that come nearest to each other along the path.

        None if all obstacles are farther than 1 m, or the world cannot say.  It is computed on first use.
        """
        if self.path is None or not isinstance(self.world, NamesNearest):
            return None
        return self.world.nearest_along(self.path)

    @cached_property
    def lower_bound(self) -> float | None:
        """Lower bound of the length of every path from the start to a goal, in the units of the space.

        For a disk on a map it is the length of the shortest path through all cells that are not entirely blocked, found
        in some milliseconds on first use.  For a flight it is a time that heeds obstacles, found in about a second.
        Else it is the straight distance to the nearest goal.  None in a plan that was read from a file.
        """
        if self.world is None:
            return None
        if isinstance(self.world, BoundsLengths):
            return self.world.least_length(self.start, self.goals)
        return float(self.world.space.distance(np.broadcast_to(self.start, self.goals.shape), self.goals).min())

    @cached_property
    def gap(self) -> float | None:
        """Largest share by which the path can be longer than the shortest, from `lower_bound`.

        None without a path, and in a plan that was read from a file.
        """
        least = self.lower_bound
        if self.path is None or self.world is None or least is None:
            return None
        length = path_length(self.path, self.world.space)
        return max(length / least - 1.0, 0.0) if least > 0.0 else 0.0 if length == 0.0 else np.inf

    @cached_property
    def free_until(self) -> float | None:
        """Until when a flight is proved free, its rest at the goal included [s]; None of what does not fly."""
        proved = getattr(self.world, "free_until", None)
        return None if self.path is None or proved is None else float(proved(self.path))

    @property
    def solved(self) -> bool:
        """Whether a path was found."""
        return self.status is Status.SOLVED

    def __bool__(self) -> bool:
        return self.solved

    @property
    def _rows(self) -> Floats | None:  # type: ignore[override]
        return self.path

    @property
    def goal(self) -> Floats:
        """The goal that the path ends at, (dim,); without a path the first one."""
        goal: Floats = self.goals[0 if self.goal_index is None else self.goal_index]
        return goal

    @property
    def seconds(self) -> float:
        """Wall time of the query [s]: the sum of `timings`."""
        return sum(self.timings.values())

    @property
    def cusps(self) -> int | None:
        """How often a car changes between forwards and backwards; None of what is no car's path."""
        if self.pieces is None:
            return None
        from evenroad.driving.car_space import cusps_of

        return cusps_of(self.pieces)

    @cached_property
    def length(self) -> float | None:
        """Length of `path` in the metric of the space; None without a path or a world."""
        if self.path is None or self.world is None:
            return None
        return path_length(self.path, self.world.space)

    @cached_property
    def bodies(self) -> str | None:
        """Kinds of bodies that the answer is about, as ``hulls and meshes`` or ``capsules``; None of what is no arm."""
        return getattr(self.world, "bodies", None)

    @property
    def _proved(self) -> str:
        """The kind of proof, and the bodies it is about."""
        return str(self.proof) if self.bodies is None else f"{self.proof} ({self.bodies})"

    def resample(self, step: float) -> Floats:
        """Return states along the path.

        Parameters
        ----------
        step : float
            Largest distance between neighbours, > 0, in the metric of the space.

        Returns
        -------
        ndarray, shape (s, dim)
            States of the path, waypoints included.

        Raises
        ------
        InvalidValue
            If `step` is not a finite number > 0, or there is no path.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> er.plan(world, (3, 3), (27, 17)).resample(0.5).shape
        (57, 2)
        """
        path, world = self._required("resampled")
        return resample(path, world.space, step)[0]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the plan to a file, atomically.

        Parameters
        ----------
        path : str or path-like
            ``.json``, the whole plan; ``.csv``, the waypoints; ``.png``, a picture.

        Raises
        ------
        UnknownName
            For another suffix.
        InvalidValue
            For a ``.csv`` without a path.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     er.plan(world, (3, 3), (27, 17)).save(f"{folder}/plan.json")
        ...     er.io.load_plan(f"{folder}/plan.json")[0].status
        <Status.SOLVED: 'solved'>
        """
        from evenroad.io import save_result

        save_result(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> PlanResult:
        """Return a plan that was saved, without its world, origin and searched graph.

        Parameters
        ----------
        path : str or path-like
            A ``.json`` of :meth:`save` or ``evenroad plan``; :func:`evenroad.io.load_plan` also returns the query.

        Returns
        -------
        PlanResult

        Raises
        ------
        BrokenFile
            If the file is missing, or is no such plan.

        Examples
        --------
        >>> import tempfile
        >>> import numpy as np
        >>> import evenroad as er
        >>> result = er.plan(er.GridMap(np.zeros((20, 30), dtype=bool)).world(2), (3, 3), (27, 17))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     result.save(f"{folder}/plan.json")
        ...     er.PlanResult.load(f"{folder}/plan.json").cost == result.cost
        True
        """
        from evenroad.io import load_plan

        return load_plan(path)[0]

    def plot(self, path: str | os.PathLike[str] | None = None, *, world: World | None = None) -> Image:
        """Return a picture of the plan as a PIL image, which a notebook shows; save it if a file is named.

        Parameters
        ----------
        path : str or path-like, optional
            A ``.png``.
        world : World, optional
            Default: the world of the plan.  Disks on maps and arms can be drawn.

        Returns
        -------
        PIL.Image.Image

        Raises
        ------
        NotAvailable
            If it is another world, or none is known.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> er.plan(world, (3, 3), (27, 17)).plot().mode
        'RGB'
        """
        from evenroad.viz.result import plot_result

        return plot_result(self, path, world)

    def trajectory(self, limits: Any = None, *, speed: float = 1.0, **options: Any) -> Any:
        """Return the path with times; the motion as driven is checked for collisions.

        Parameters
        ----------
        limits : Limits, or the file of a ``joint_limits.yaml``, optional
            Default: those of the robot; in worlds without a robot, `speed` and `acceleration` limit the motion.
        speed : float
            With limits, 0 < speed <= 1: the motion takes ``1 / speed`` times as long as at full speed.  Without limits,
            as on a map: the largest speed along the path, > 0 [map units per second], reached in half a second.
        **options
            Of :func:`evenroad.trajectory.arm_trajectory`; on maps `acceleration`, of cars all `trajectory.DriveLimits`.

        Returns
        -------
        Trajectory or CarTrajectory

        Raises
        ------
        InvalidValue
            If there is no path, or there are no limits; also the errors of :func:`evenroad.trajectory.make_trajectory`.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0)
        Trajectory(5.992 s, 2 joints, 750 states)
        """
        from evenroad.trajectory.of_plan import trajectory_of

        path, world = self._required("driven")
        made = trajectory_of(world, path, limits, speed=speed, pieces=self.pieces, **options)
        set_fields(made, world=world)
        return made

    def certify(
        self,
        file: _File,
        *,
        robot: _File,
        scene: _File | None = None,
        srdf: _File | None = None,
        trajectory: Trajectory | None = None,
        embed: bool = False,
        **packages: _File,
    ) -> None:
        """Write a proof that the path is free, or that there is none, which ``evenroad-verify`` checks by itself.

        Parameters
        ----------
        file, robot, scene, srdf : str or path-like
            The file to write; the robot's file, the scene's file and the SRDF of the plan's world, or names of shipped
            ones.  Without a scene, or where a checker does not read its format, the certificate carries it.
        trajectory, embed : Trajectory, bool
            A trajectory along this path, to be proved in its place; whether the robot's files are carried, too.
        **packages : path-like
            Folders of ROS packages with meshes, by their names, beside those that are found.

        Raises
        ------
        NotAvailable, InvalidValue
            If certificates do not cover the plan, or if there is no proof.

        Examples
        --------
        >>> import evenroad as er, tempfile
        >>> result = er.plan(er.ArmWorld("ur5", "box-reach"), "home", "inside")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     result.certify(f"{folder}/reach.cert", robot="ur5", scene="box-reach")
        """
        from evenroad.certificates.certify import Sources, certify

        sources = Sources.named(robot, scene, srdf, embed=embed, packages=packages)
        if self.path is None and self.status is Status.NOT_CONNECTED and self.world is not None:
            from evenroad.certificates.no_path import certify_no_path

            certify_no_path(self.world, self.start, self.goals, sources, file, self.poses)
            return
        path, world = self._required("certified")
        certify(world, path, sources, file, trajectory=trajectory)

    def _required(self, how: str) -> tuple[Floats, World]:
        """Return path and world, or raise InvalidValue that names the missing one."""
        if self.path is None:
            raise InvalidValue(f"there is no path that could be {how}: {self.message}")
        if self.world is None:
            raise InvalidValue(f"this plan does not know its world, without which it cannot be {how}")
        return self.path, self.world

    def __repr__(self) -> str:
        parts = [str(self.status)]
        if self.path is not None:
            parts += [f"{len(self.path)} waypoints", self._proved]
        if self.cost is not None:
            parts.insert(1, f"cost {self.cost:.4g}")
        took = self.seconds
        parts.append(f"{took:.3g} s" if took >= 1.0 else f"{1e3 * took:.3g} ms")
        return f"{type(self).__name__}({', '.join(parts)})"

    def _repr_html_(self) -> str:
        """Return the HTML that a notebook shows."""
        rows = {"status": f"{self.status}: {self.message}", "planner": self.planner}
        if self.cost is not None:
            rows |= {"cost": f"{self.cost:.6g}", "proved": self._proved}
        rows["time"] = f"{1e3 * self.seconds:.1f} ms"
        return as_html(rows, self.path)
