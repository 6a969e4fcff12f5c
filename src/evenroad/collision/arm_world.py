"""ArmWorld: a robot among the obstacles of a scene."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad._native.robot import Checker, Contact
from evenroad._native.robot import Scene as NativeScene
from evenroad._shared import once_property
from evenroad._time_limit import require_time_for
from evenroad.collision.coerce import as_robot, as_scene
from evenroad.collision.distance import LEAST, MOST, Distance, Pair
from evenroad.collision.native_scene import native_scene
from evenroad.collision.prepared_robots import Prepared, prepared
from evenroad.collision.robot_tables import PADDING, RobotTables
from evenroad.collision.scene_changes import NumberedScene
from evenroad.collision.scene_notes import scene_notes
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PointCloud
from evenroad.robots.robot import Robot
from evenroad.scenes.changes import Changes
from evenroad.scenes.obstacle import MOST_CLEARANCE
from evenroad.scenes.robot_in_scene import scene_around, within_scene
from evenroad.scenes.scene import Scene, limits_in_words, smaller_scene, without_limits
from evenroad.scenes.states import as_configuration
from evenroad.space import JointSpace
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.joints import SLACK
from evenroad.space.path import resample
from evenroad.world.bisection import require_few_segments
from evenroad.world.clearance import largest_kept
from evenroad.world.one_or_many import OneOrMany, is_one, one_or_many
from evenroad.world.protocol import Apart

VALIDATION_TOLERANCE = 1e-6
"""Distance from contact down to which `ArmWorld.validate` proves a motion free [m]; checks keep about twice that."""


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class ArmWorld(Changes, OneOrMany):
    """The configurations in which a robot touches neither a scene's obstacles nor itself.

    Configurations hold the values of the robot's group, in its order [rad or m].  Links are tested as capsules.  Where
    these touch, convex hulls decide about two links, and the shapes of the robot's file about a link and an obstacle.
    Of a link without any, spheres that cover its capsules do, of at most 1.10 times their radius (`excess`).

    A motion is divided into ``n = ceil(distance / resolution)`` segments and free if all n + 1 ends of segments are.
    What lies between two states is not checked: `validate` proves the motions of a path with no gap.

    Parameters
    ----------
    robot, scene : Robot, Scene; or the names or files that `load_robot` and `load_scene` take
        The robot, and the obstacles around it, by default none.  Where the scene has narrower ranges to plan in, they
        hold for the robot.
    resolution : float
        Largest Euclidean distance between neighbouring states of a motion, > 0 [rad].
    clearance : float
        Least distance from obstacles, >= 0 [m]: bodies are larger by it against obstacles, not against each other.

    Raises
    ------
    InvalidValue
        If a number is invalid, a joint of the group has no finite range, or robot or scene is inconsistent.
    UnknownName
        If the robot or the scene names something that does not exist.

    Examples
    --------
    >>> import evenroad as er
    >>> er.ArmWorld("ur5", "box-reach", clearance=0.005).valid("home")
    True
    """

    robot: Robot
    scene: Scene = field(default_factory=Scene)
    resolution: float = 0.05
    clearance: float = 0.0
    _prepared: Prepared = field(init=False)
    _since: tuple[ArmWorld, Mapping[str, None]] | None = field(init=False, default=None)
    """The world that this one was changed from, and the names of the obstacles that differ."""

    def __post_init__(self) -> None:
        scene = as_scene(self.scene)
        apart = require_positive("clearance", self.clearance, or_zero=True, at_most=MOST_CLEARANCE)
        resolution = require_positive("resolution", self.resolution)
        robot = within_scene(as_robot(self.robot), scene)
        scene = scene_around(robot, scene)
        for held in scene.attached:
            if held.name not in robot.holds:
                raise InvalidValue(
                    f"scene {scene.name!r} attaches {held.name!r}, which the robot does not hold: give the world"
                    " in_scene(robot, scene)"
                )
        if scene.near_ends:
            which = f"scene {scene.name!r} allows contacts near start and goals, which a world does not know"
            raise InvalidValue(f"{which}: plan does, or give it allowed_near_ends(robot, scene, start_and_goals)")
        made = prepared(robot)
        require_few_segments(resolution, made.longest / resolution)
        set_fields(self, robot=robot, scene=scene, resolution=resolution, clearance=apart, _prepared=made)
        _ = self.native_scene  # at once: it refuses obstacles that are too far

    @property
    def space(self) -> JointSpace:
        """The ranges of the group's joints; continuous ones wrap."""
        return self._prepared.space

    @property
    def bounds(self) -> Floats:
        """Low, high and period of each joint, (3, dim); a period of inf where it does not wrap."""
        return self._prepared.bounds

    @property
    def robot_tables(self) -> RobotTables:
        """What checks know of the robot, the same in every scene."""
        return self._prepared.tables

    @property
    def excess(self) -> float:
        """Largest difference of the radii of spheres against obstacles and of their capsules [m]."""
        return max(capsule.cover.radius - capsule.radius for capsule in self.robot_tables.capsules)

    @property
    def spheres(self) -> int:
        """Number of spheres that replace the capsules against obstacles."""
        return sum(len(capsule.cover.positions) for capsule in self.robot_tables.capsules)

    def _row(self, q: object) -> Floats:
        return as_configuration(self.robot, q, self.scene)  # type: ignore[arg-type]

    def __repr__(self) -> str:
        return f"ArmWorld({self.robot!r}, {self.scene!r})"

    @once_property
    def native_scene(self) -> NativeScene:
        """The obstacles as native checks read them."""
        made = self._prepared
        return native_scene(made.native, made.tables, self.robot.links, self.scene, self.clearance)

    @once_property
    def _numbered(self) -> NumberedScene:
        """The native scene with the numbers of its obstacles."""
        return NumberedScene(self.native_scene, self.scene.solid_names, self.scene.table)

    @once_property
    def notes(self) -> tuple[str, ...]:
        """What is unusual in the sizes and meshes of obstacles, or in how far they are."""
        return scene_notes(self.scene, self.robot_tables.reach + self.clearance)

    @once_property
    def checker(self) -> Checker:
        """The native checks of this world."""
        touches_itself = self.robot_tables.fixed_contact is not None
        robot = self._prepared.native
        return Checker(robot, self.native_scene, self.resolution, self.clearance, touches_itself)

    def __reduce__(self) -> tuple[type[ArmWorld], tuple[object, ...]]:
        """Return what a copy is made of: it makes checks of its own."""
        return type(self), (self.robot, self.scene, self.resolution, self.clearance)

    def valid(self, q: Any) -> Any:
        """Return which configurations, (n, dim), are within the limits, up to 1e-5, and touch nothing: (n,).

        Of one configuration, (dim,), joint -> value, or a named state, a bool; `motion_valid`, too.

        Raises InvalidValue if `q` has another shape or an entry that is not finite.
        """
        free = self.checker.valid(q)
        return self._read_and_valid(q) if free is None else free

    @one_or_many
    def _read_and_valid(self, q: Floats) -> Bools:
        """Return the same of what is no array of floats, or not such a one as it should be."""
        return self.checker.valid(as_batch("q", q, self.dim))

    def motion_valid(self, a: Any, b: Any) -> Any:
        """Return which motions, from each row of `a` to that of `b`, two (m, dim) arrays, are free: (m,).

        Raises InvalidValue as `valid`, or if the two differ in length.
        """
        free = self.checker.motion_valid(a, b)
        return self._read_and_motion_valid(a, b) if free is None else free

    @one_or_many
    def _read_and_motion_valid(self, a: Floats, b: Floats) -> Bools:
        return self.checker.motion_valid(*as_batch_pair(a, b, self.dim))

    @once_property
    def roomier(self) -> ArmWorld:
        """The same world with 5 mm more clearance, which paths keep where they can."""
        if self._since is None:
            # What this world has read is not read again: that would take as long as a short plan.
            return self._copy(self.scene, min(self.clearance + 0.005, MOST_CLEARANCE))
        since, changed = self._since
        gone, come = ([name for name in changed if each.scene.table.has(name)] for each in (since, self))
        roomier: ArmWorld = since.roomier
        return roomier._changed(self.scene, gone, come)

    @property
    def bodies(self) -> str:
        """The kinds of bodies that the robot touches obstacles with, see `Robot.bodies`."""
        return self.robot.bodies

    @property
    def proof(self) -> str:
        """``certified``: what `validate` calls free is proved free everywhere between its endpoints."""
        return "certified"

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are proved free: (p - 1,).

        The method is that of :mod:`evenroad.collision.certified`, without gaps.  Motions within some micrometres of
        contact, or that need more than 2^15 intervals, are refused, too.  Raises as `valid`.
        """
        waypoints = as_batch("path", path, self.dim)
        return self.motion_certified(waypoints[:-1], waypoints[1:], VALIDATION_TOLERANCE)

    def motion_certified(self, a: Floats, b: Floats, tolerance: float) -> Bools:
        """Return which motions, from each row of `a` to that of `b`, two (m, dim) arrays, are proved free: (m,).

        Motions nearer than about `tolerance` to contact are not proved, > 0 [m].  Raises as `motion_valid`.
        """
        first, second = as_batch_pair(a, b, self.dim)
        return self.checker.motion_valid(first, second, require_positive("tolerance", tolerance))

    def apart(self, start: Floats, goals: Floats, *, quickly: bool = False) -> Apart | None:
        """Return a proof that no path leads from the start, (dim,), to any goal, (g, dim), or None.

        The first joints alone prove it, in tenths of a second, `quickly` in some milliseconds.  The proof holds for
        bodies inside the robot's true shapes, see :mod:`evenroad.infeasibility.proof`.
        """
        terminals = as_batch("start and goals", np.concatenate([np.atleast_2d(start), goals]), self.dim)
        require_time_for("evenroad.infeasibility.proof")
        # Imported late: few plans need the proof.
        from evenroad.infeasibility.proof import apart

        return apart(self, terminals[0], terminals[1:], quickly=quickly)

    @property
    def margin(self) -> float:
        """Largest distance at which bodies may touch in single precision [m]."""
        clouds = [each.body.radius for each in self.scene.obstacles if isinstance(each.body, PointCloud)]
        reach = self.robot_tables.reach
        # Once for what is added, once more for what rounding may add to that; a pair has two bodies that are larger.
        pairs = 4.0 * PADDING * max(1.0, reach) if self.robot_tables.capsule_pairs else 0.0
        obstacles = 2.0 * (PADDING * max(1.0, reach + self.clearance) + self.native_scene.added)
        return max(obstacles, pairs, 1e-6 * max(clouds, default=0.0))

    def with_bodies(self, robot: Robot, spare: float = 0.0) -> Callable[[Floats], Bools]:
        """Return a function that checks configurations, (n, dim), of a robot with other bodies or another group.

        Obstacles reach less far by what they are to `spare`, or farther where that is less than 0 [m].
        """
        scene = smaller_scene(self.scene, spare) if spare > 0.0 else self.scene
        more = {"robot": robot, "_prepared": prepared(robot)}
        return self._copy(scene, self.clearance + max(-spare, 0.0), **more).valid

    @once_property
    def _measuring(self) -> Checker:
        """The native checks of this world as it is without a clearance, with the obstacles up to 1 m farther."""
        made = self._prepared
        scene = native_scene(made.native, made.tables, self.robot.links, self.scene, MOST)
        return Checker(made.native, scene, self.resolution, 0.0, False)

    @once_property
    def _bare(self) -> ArmWorld:
        """The same world without a clearance of its own."""
        return replace(self, clearance=0.0) if self.clearance else self

    @once_property
    def _unpadded(self) -> ArmWorld:
        """The same world without what is kept away beside contact: no clearance of it or of an obstacle, no padding."""
        kept = {each.name: 0.0 for each in self.scene.obstacles if each.clearance}
        if not (kept or self.robot.padding or self.clearance):
            return self
        bare = replace(self.robot, padding=())
        return replace(self, robot=bare, scene=self.scene.with_clearance(kept), clearance=0.0)

    def distance(self, q: Any) -> Distance:
        """Return how far the robot is from contact, and which two bodies are nearest.

        Bodies are those that the world plans with, without its clearance: capsules, against obstacles the spheres that
        cover them, or what decides in their place.  The distance is never larger than theirs, and some micrometres
        smaller at most; of a world without a clearance it is > 0 exactly where `valid` says so.  Pairs that may touch
        do not count.

        Parameters
        ----------
        q : array_like, shape (n, dim) or (dim,), mapping or str
            Configurations within the limits; a mapping or a named state is one.

        Returns
        -------
        Distance
            ``metres`` and ``pair``, of one configuration or of each.

        Raises
        ------
        InvalidValue
            As `valid`, or if a configuration is outside of the limits.

        Examples
        --------
        >>> import evenroad as er
        >>> er.ArmWorld("ur5", "box-reach").distance("home").pair
        ('forearm_link', 'wrist_2_link')
        """
        batch = as_batch("q", self._row(q)[np.newaxis] if is_one(q) else q, self.space.dim)
        metres, pairs = self._distances(batch)
        bare = self._bare
        if bare.fixed_contact is not None:
            pairs = [bare.fixed_contact] * len(batch)
        if (outside := np.flatnonzero(np.isnan(metres))).size:
            raise InvalidValue(f"q has no distance in row {outside[0]}: {self.explain(batch[outside[0]])}")
        metres = np.where(bare.valid(batch), np.maximum(metres, LEAST), 0.0)
        return Distance(float(metres[0]), pairs[0]) if is_one(q) else Distance(metres, pairs)

    def _distances(self, q: Floats, *, to_itself: bool = True) -> tuple[Floats, list[Pair | None]]:
        """Return the distances of configurations, (n, dim); without `to_itself` those from obstacles alone."""
        metres, nearest = self._measuring.distances(q, MOST, to_itself)
        return metres, [self._names(contact, anew=True) for contact in nearest]

    def obstacle_distances(self, q: Floats) -> Floats:
        """Return lower bounds of the distances from obstacles, 1 m at most [m].

        Parameters
        ----------
        q : ndarray, shape (n, dim)

        Returns
        -------
        float64 ndarray, shape (n,)

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> er.ArmWorld("ur5", "empty").obstacle_distances(np.zeros((2, 6))).round(6).tolist()
        [1.0, 1.0]
        """
        return self._unpadded._distances(q, to_itself=False)[0]

    def nearest_along(self, path: Floats) -> tuple[str, str] | None:
        """Return the link and the obstacle that come nearest to each other along a path, (p, dim); None beyond 1 m."""
        metres, pairs = self._unpadded._distances(resample(path, self.space, self.resolution / 4.0)[0], to_itself=False)
        return pairs[int(metres.argmin())]

    def path_clearance(self, path: Floats) -> float | None:
        """Return the distance to obstacles that a path, (p, dim), is proved to keep, to 0.1 mm [m]; None if none."""
        bare = self._unpadded

        def keeps(distance: float) -> bool:
            return bool(bare._copy(bare.scene, distance).validate(path).all())

        return largest_kept(keeps, self.clearance, MOST_CLEARANCE, 1e-4)

    def _moved(self, poses: Mapping[str, Pose]) -> ArmWorld:
        return self._changed(self.scene._moved(poses), poses, poses)

    def _with(self, obstacles: Sequence[object], allowed: Sequence[tuple[str, str]]) -> ArmWorld:
        added = self.scene._named_new(obstacles)
        scene = self.scene._with(added, allowed)
        return self.within(scene) if allowed else self._changed(scene, (), [each.name for each in added])

    def _without(self, names: Sequence[str]) -> ArmWorld:
        return self._changed(self.scene._without(names), names, ())

    def within(self, scene: Scene) -> ArmWorld:
        """Return the same world with the obstacles of another scene.

        Parameters
        ----------
        scene : Scene
            Its ranges of joints are not looked at.

        Returns
        -------
        ArmWorld

        Raises
        ------
        UnknownName, InvalidValue
            If the scene does not fit the robot.

        Examples
        --------
        >>> import evenroad as er
        >>> er.ArmWorld("ur5", "box-reach").within(er.Scene()).scene.names
        ()
        """
        if scene.padding:
            return replace(self, scene=without_limits(scene))
        world = self._copy(scene_around(self.robot, scene), self.clearance)
        _ = world.native_scene  # at once: it refuses obstacles that are too far
        return world

    def _copy(self, scene: Scene, clearance: float, **more: object) -> ArmWorld:
        """Return a world of the same robot, of a scene and a clearance that fit it: `replace` would read all again."""
        world = object.__new__(type(self))
        same = {name: getattr(self, name) for name in ("robot", "resolution", "_prepared")}
        vars(world).update(same, scene=scene, clearance=clearance, **more)
        return world

    def _changed(self, scene: Scene, gone: Collection[str], come: Collection[str]) -> ArmWorld:
        """Return the same world with a scene in which some obstacles are gone and others have come."""
        robot = self._prepared.native
        numbered = self._numbered.changed(robot, self.robot_tables, scene, gone, come, self.clearance)
        if numbered is None:
            return self.within(scene)
        since, changed = (self, {}) if self._since is None else self._since
        changed = {**changed, **dict.fromkeys(gone), **dict.fromkeys(come)}
        more = dict(native_scene=numbered.native, _numbered=numbered, _since=(since, changed))
        return self._copy(scene, self.clearance, **more)

    def fingerprint(self) -> str:
        """Return a text that is equal for worlds of equal robot, scene, resolution and clearance."""
        more = (self.clearance,) if self.clearance else ()
        return fingerprint_of("arm", self.robot, self.scene, self.resolution, *more)

    def explain(self, q: Floats) -> str:
        """Return, in words, why one configuration, (dim,), is not free: a joint outside its limits, or which bodies
        touch.
        """
        batch = as_batch("q", self._row(q)[np.newaxis], self.dim)
        # To itself: brings wrapping joints into their ranges.
        row = self.space.interpolate(batch, batch, 0.0)[0]
        for name, value, low, high, period in zip(self.robot.group, row, *self.bounds, strict=True):
            if math.isinf(period) and not low - SLACK <= value <= high + SLACK:
                beyond = max(low - value, value - high)
                soft = any(joint.name == name and joint.hard for joint in self.robot.joints)
                limits = limits_in_words(self.scene, name, low, high, "its soft limits" if soft else "its limits")
                return f"joint {name!r} is at {value:g}, {beyond:.3g} outside {limits}"
        if (bodies := self.fixed_contact) is not None and bodies[1] in self.scene.names:
            advice = f"if it stands there, allow it: in the scene, allowed: {{{bodies[1]}: [{bodies[0]}]}}"
            return f"{bodies[0]!r} touches {bodies[1]!r} wherever the joints are; {advice}"
        bodies = bodies or self._touching(row)
        if bodies is None:
            return "it is free"
        if any(self._kept_from(*bodies)):
            plain = self._unpadded
            if not plain.valid(batch)[0]:
                return plain.explain(q)
            apart, (nearest, *_) = plain._distances(batch, to_itself=False)
            if nearest is not None and apart[0] < sum(self._kept_from(*nearest)):
                bodies = nearest
            so_near = f", {apart[0]:.3g} m away" if bodies == nearest else ""
            kept = zip(("clearance", "padding"), self._kept_from(*bodies), strict=True)
            both = " and the ".join(f"{name} {metres:g}" for name, metres in kept if metres)
            return f"{bodies[0]!r} is nearer than the {both} to {bodies[1]!r}{so_near}"
        return f"{bodies[0]!r} touches {bodies[1]!r}"

    def _kept_from(self, link: str, obstacle: str) -> tuple[float, float]:
        """Return by how much an obstacle is kept away from, and by how much a link is padded [m]."""
        wider = sum(each.clearance for each in self.scene.obstacles if each.name == obstacle)
        return self.clearance + wider, dict(self.robot.padding).get(link, 0.0)

    def explain_start(self, q: Floats) -> str:
        """Return, as `explain`, why a robot cannot start from a configuration, (dim,), and for a scan what helps."""
        reason = self.explain(q)
        clouds = (each.name for each in self.scene.obstacles if isinstance(each.body, PointCloud))
        if not any(f" touches {name!r}" in reason for name in clouds):
            return reason
        return (
            f"the robot stands in its scan, {reason}: seen_at, with where it stood, takes its own points out of a"
            " cloud, and cut those of what it holds"
        )

    @cached_property
    def fixed_contact(self) -> tuple[str, str] | None:
        """Two bodies that touch at all values of the joints, or None."""
        return self._names(self.checker.fixed_contact) or self.robot_tables.fixed_contact

    def _touching(self, q: Floats) -> tuple[str, str] | None:
        """Return two bodies that touch at a configuration within the limits."""
        return self._names(self.checker.find_contact(q))

    def _names(self, contact: Contact, *, anew: bool = False) -> tuple[str, str] | None:
        """Return the names of two bodies that touch, None for nothing; or those of a scene made anew."""
        capsules, other = self.robot_tables.capsules, contact.other
        match contact.kind:
            case "nothing":
                return None
            case "itself":
                first, second = self.robot_tables.capsule_pairs[other]
                return capsules[first].link, capsules[second].link
            case "surface":
                return capsules[contact.capsule].link, self.scene.names[other]
        name = self.scene.solid_names[other] if anew else self._numbered.name_of(other)
        return capsules[contact.capsule].link, name
