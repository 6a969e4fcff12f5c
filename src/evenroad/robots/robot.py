"""Robot: a kinematic tree, its bodies as capsules, and the joints that are planned for."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._fingerprint import fingerprint_of
from evenroad._hints import KnowsElsewhere
from evenroad._rng import RngLike
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.hulls import Hull, Piece, piece_of
from evenroad.geometry.parts import Parts, kinds_in_words
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Capsule, Shape, without_pose
from evenroad.robots.held import HeldObject, held_parts, inner_of_both
from evenroad.robots.joint import Joint
from evenroad.robots.planes import Plane

if TYPE_CHECKING:
    from evenroad.poses.pose_goal import PoseGoal
    from evenroad.scenes.scene import Scene

ConfigurationLike = str | Mapping[str, float] | npt.ArrayLike
"""A configuration: numbers in the order of the group, joint -> value, or a text as
:func:`evenroad.robot.configuration` takes it."""
Padding = float | Mapping[str, float] | str | os.PathLike[str]
"""Padding of links: one length for all, link -> length, or a file of MoveIt."""


@explains_calls
@dataclass(frozen=True, repr=False)
class Robot(metaclass=KnowsElsewhere):
    """A kinematic tree with bodies; :func:`evenroad.load_robot` makes one of its file.

    Parameters
    ----------
    name, links, joints : str, tuple of str, tuple of Joint
        The root is the first link, and every parent comes before its children; ``joints[i]`` leads to ``links[i + 1]``.
    capsules, pairs : tuple of Capsule, tuple of (str, str)
        The bodies, and the links that are tested against each other.
    group : tuple of str
        Joints that are planned for, in the order of a configuration, none of them fixed or a mimic.
    held, states : mapping of str to float, mapping of str to mapping
        Values of other movable joints [rad or m], by default 0, or the nearest within limits; and named
        configurations: joint -> value, also of joints outside the group.
    hulls : tuple of Hull
        Convex pieces of the links' shapes: where the capsules of two links touch, these decide.
    pairs_given, resting : bool, tuple of (str, str)
        Whether the pairs were given, as by an SRDF; if not, the pairs left out because they always touch.
    holds, planes : tuple of str, tuple of Plane
        Links of held objects, see :meth:`holding`; half spaces that are in every scene.
    inner : tuple of Capsule or None
        Capsules within the links' true shapes, for proofs that there is no path.  None: `capsules` are these shapes.
    shapes, padding : tuple of Parts, tuple of (str, float)
        The links' true shapes: where capsules touch an obstacle, these decide.  A link without any is its capsules.
        By how much links are larger against obstacles [m], see :meth:`with_padding`.

    Examples
    --------
    >>> import evenroad as er
    >>> er.load_robot("ur5")
    Robot('ur5', 6 joints, 8 links)
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    capsules: tuple[Capsule, ...]
    pairs: tuple[tuple[str, str], ...]
    group: tuple[str, ...]
    held: Mapping[str, float] = field(default_factory=dict)
    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    hulls: tuple[Hull, ...] = ()
    pairs_given: bool = True
    resting: tuple[tuple[str, str], ...] = ()
    holds: tuple[str, ...] = ()
    planes: tuple[Plane, ...] = ()
    inner: tuple[Capsule, ...] | None = None
    shapes: tuple[Parts, ...] = ()
    padding: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        # The kernel takes endpoints: those of a capsule with a pose are transformed to its link's frame.
        set_fields(self, capsules=tuple(map(without_pose, self.capsules)))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, {self.dof} joints, {len(self.links)} links)"

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The joints that are planned for, in the order of a configuration; another name for `group`."""
        return self.group

    @property
    def dof(self) -> int:
        """Number of values in a configuration."""
        return len(self.group)

    @cached_property
    def has_soft_limits(self) -> bool:
        """Whether some joint has hard limits around those that are planned within."""
        return any(joint.hard is not None for joint in self.joints)

    @property
    def limits(self) -> Floats:
        """Lower and upper limit of each joint of the group, (dof, 2) [rad or m]; infinite for continuous ones."""
        joints = {joint.name: joint for joint in self.joints}
        return np.array([(joints[name].lower, joints[name].upper) for name in self.group]).reshape(-1, 2)

    @property
    def velocity_limits(self) -> Floats:
        """Largest velocity of each joint of the group, (dof,) [rad/s or m/s]; infinite if the file has none."""
        velocities = {joint.name: joint.velocity for joint in self.joints}
        return np.array([velocities[name] for name in self.group])

    def configuration(self, q: ConfigurationLike, scene: Scene | None = None) -> Floats:
        """Return a configuration as numbers, from numbers, a mapping or a text.

        Parameters
        ----------
        q : array_like, shape (dof,), mapping or str
            Numbers in the order of `joint_names` [rad or m]; joint -> value, where joints that are left out are at 0,
            or the nearest to it within limits; or a text: the name of a state, ``"0,-1.57,..."`` or ``"elbow=1,..."``.
        scene : Scene, optional
            A scene with more named states.

        Returns
        -------
        ndarray, shape (dof,)
            In rad or m.

        Raises
        ------
        InvalidValue
            If it has another number of finite numbers, or a text has a value outside of the limits.
        UnknownName
            If there is no such state or joint.

        Examples
        --------
        >>> import evenroad as er
        >>> er.load_robot("ur5").configuration({"elbow_joint": -1.5}).tolist()
        [0.0, 0.0, -1.5, 0.0, 0.0, 0.0]
        """
        from evenroad.scenes.states import as_configuration

        return as_configuration(self, q, scene)

    def fk(self, q: ConfigurationLike, link: str = "") -> Pose:
        """Return the pose of a link: forward kinematics.

        Parameters
        ----------
        q : array_like, shape (dof,), mapping or str
            A configuration [rad or m].  Joints that a mapping leaves out are at 0, or the nearest to it within limits;
            a text is as :meth:`configuration` takes it.
        link : str
            The link; default: the last one that the group moves.

        Returns
        -------
        Pose
            Pose of the link in the frame of the robot's root link.

        Raises
        ------
        InvalidValue
            If `q` is no configuration, or no link is named and there are several at the end.
        UnknownName
            If there is no such link, joint or state.

        Examples
        --------
        >>> import evenroad as er
        >>> robot = er.load_robot("ur5")
        >>> robot.fk("home", "tool0").matrix[:3, 3].round(2).tolist()
        [0.0, 0.19, 1.0]
        """
        from evenroad.poses.robot_queries import pose_of_link

        return pose_of_link(self, q, link)

    def jacobian(self, q: ConfigurationLike, link: str = "") -> Floats:
        """Return how the pose of a link changes with the joints: the geometric Jacobian in the root link's frame.

        Parameters
        ----------
        q, link : configuration, str
            As for :meth:`fk`.

        Returns
        -------
        ndarray, shape (6, dof)
            Velocity of the link's origin (three rows), then angular velocity, for each joint's velocity of 1.

        Examples
        --------
        >>> import evenroad as er
        >>> er.load_robot("ur5").jacobian("home", "tool0").shape
        (6, 6)
        """
        from evenroad.poses.robot_queries import jacobian_of

        return jacobian_of(self, q, link)

    def ik(self, pose: Pose | PoseGoal, link: str = "", *, start: ConfigurationLike = ()) -> Floats:
        """Return the configurations that bring a link to a pose: inverse kinematics.

        Nothing is tested for collisions; :func:`evenroad.plan` takes poses as goals, and does.

        Parameters
        ----------
        pose : Pose, PoseGoal or array_like, shape (4, 4)
            In the frame of the robot's root link.
        link : str
            The link; default: that of the PoseGoal, else the last one that the group moves.
        start : configuration, optional
            A configuration as `q` of :meth:`fk`.  The nearest to it comes first, and joints that do not move the
            link keep its values.  Default: all joints at 0, or the nearest to it within limits.

        Returns
        -------
        ndarray, shape (n, dof)
            All that were found, within limits, whole turns added; for a redundant arm some.  n is 0 where the pose is
            out of reach.

        Raises
        ------
        InvalidValue
            If `pose` or `start` is none, or no link is named and there are several at the end.
        UnknownName
            If there is no such link.

        Examples
        --------
        >>> import evenroad as er
        >>> robot = er.load_robot("ur5")
        >>> robot.ik(er.Pose((0.4, 0.2, 0.3), rpy=(3.14159, 0, 0)), "tool0").shape[1]
        6
        """
        from evenroad.poses.robot_queries import configurations_at

        return configurations_at(self, pose, link, start)

    def random(self, rng: RngLike = 0, n: int | None = None) -> Floats:
        """Return random configurations within the limits, uniform in each joint; they may be in collision.

        Parameters
        ----------
        rng : int, SeedSequence or Generator
            Seed: equal numbers give equal configurations; a Generator is spawned.
        n : int, optional
            Number of configurations, >= 1.  Default: one, without this axis.

        Returns
        -------
        ndarray, shape (dof,) or (n, dof)
            In rad or m.

        Raises
        ------
        InvalidValue
            If `rng` or `n` is not of that kind, or a joint has no limits.

        Examples
        --------
        >>> import evenroad as er
        >>> er.load_robot("ur5").random(rng=7, n=10).shape
        (10, 6)
        """
        from evenroad.poses.robot_queries import random_configurations

        return random_configurations(self, rng, n)

    def with_padding(self, padding: Padding) -> Robot:
        """Return the robot with links that keep more away from obstacles, as MoveIt's link padding.

        Links are tested against each other as they are, and so is what no joint moves.  The clearance of a world is
        added.

        Parameters
        ----------
        padding : mapping of str to float, float, str or path-like
            Link -> by how much it is larger against obstacles, from 0 to 1 [m]; others keep what they have.  A number
            is that of all links.  Or a YAML file with ``default_robot_padding``, ``default_robot_link_padding``,
            ``default_robot_scale`` and ``default_robot_link_scale``, or some of them, as MoveIt's ``joint_limits.yaml``
            may have them.  A scale s, >= 1, adds (s - 1) times the largest distance of a link's shapes from their
            middle.

        Returns
        -------
        Robot

        Raises
        ------
        UnknownName
            If there is no such link.
        InvalidValue
            If a number is none, or out of its range.
        BrokenFile
            If the file is missing, or says nothing of it.

        Examples
        --------
        >>> import evenroad as er
        >>> robot = er.load_robot("ur5").with_padding({"wrist_3_link": 0.02})
        >>> er.ArmWorld(robot, "box-reach").valid("home")
        True
        """
        from evenroad.loading.padding import with_padding

        return with_padding(self, padding)

    @property
    def bodies(self) -> str:
        """The kinds of bodies that decide what touches an obstacle: ``capsules``, or as ``hulls, meshes and capsules``.

        A link without shapes of its own is its capsules.
        """
        return kinds_in_words(self.shapes, self.capsules)

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of all that decides checks; the names of the robot and its states do not."""
        # These only where there are any: robots without keep the fingerprints that they always had.
        left_out = {"name", "states", "holds", "inner"}
        left_out |= {each for each in ("planes", "shapes", "padding") if not getattr(self, each)}
        return fingerprint_of(*(getattr(self, each.name) for each in fields(self) if each.name not in left_out))

    def with_tool(self, tool: Robot | Sequence[Shape], at: str, *, pose: Pose = IDENTITY, prefix: str = "") -> Robot:
        """Return the robot with a tool fixed to one of its links.

        The group stays the robot's; the tool's joints are held.  Pairs within the robot and within the tool stay; those
        between the two are computed as for a robot without an SRDF.

        Parameters
        ----------
        tool : Robot, Shape or sequence of Shape
            Another robot, or shapes in the frame of a new link ``tool``, to which capsules are fitted.
        at, pose : str, Pose
            The link that carries it, and the pose of the tool's root link in its frame.
        prefix : str
            Prefix of the names of all of the tool's links and joints.

        Returns
        -------
        Robot

        Raises
        ------
        UnknownName
            If the robot has no such link.
        InvalidValue
            If the tool has no body, or a name in common with the robot.

        Examples
        --------
        >>> import evenroad as er
        >>> robot = er.load_robot("ur5")
        >>> robot.with_tool(er.Cylinder(0.03, 0.1, xyz=(0, 0, 0.05)), "tool0").links[-1]
        'tool'
        """
        # Imported late: it makes robots of this class.
        from evenroad.robots.tool import with_tool

        return with_tool(self, tool, at, pose, prefix)

    def holding(
        self, shape: Shape | HeldObject, link: str = "", *, touches: Sequence[str] = (), name: str = "held"
    ) -> Robot:
        """Return the robot with an object in its hand.

        Capsules and a hull are fitted to it, as to the links of a URDF; nothing is sampled, and the robot's own pairs
        stay.  It is tested against all obstacles and against every link that joints move on `link`.

        Parameters
        ----------
        shape : Shape, or HeldObject
            The body, with its pose in the frame of the link that carries it; a HeldObject has the other parameters.
        link : str
            That link.
        touches, name : sequence of str, str
            Links that it may touch, and its name, for allowed contacts of a scene and for messages.

        Raises
        ------
        UnknownName
            If a link does not exist.
        InvalidValue
            If it is no shape that has capsules, or the name is that of a link, as when attached twice.

        Returns
        -------
        Robot

        Examples
        --------
        >>> import evenroad as er
        >>> robot = er.load_robot("ur5")
        >>> robot.holding(er.Box((0.1, 0.1, 0.1), xyz=(0, 0, 0.1)), "tool0", name="can").holds
        ('can',)
        """
        held = shape if isinstance(shape, HeldObject) else HeldObject(name, shape, link, tuple(touches))
        parts = held_parts(self, held, neighbours=not self.pairs_given)
        hulls = () if parts.hull.is_round and not self.hulls else (parts.hull,)
        return replace(
            self,
            links=(*self.links, held.name),
            joints=(*self.joints, parts.joint),
            capsules=(*self.capsules, *parts.capsules),
            pairs=(*self.pairs, *parts.pairs),
            hulls=(*self.hulls, *hulls),
            holds=(*self.holds, held.name),
            inner=inner_of_both(self.inner, self.capsules, parts.inner, parts.capsules),
            # Its own shape decides, also where the links are capsules.
            shapes=(*self.shapes, *parts.shapes),
        )

    def empty_handed(self) -> Robot:
        """Return the robot without what it holds."""
        held = set(self.holds)
        if not held:
            return self
        capsules = tuple(capsule for capsule in self.capsules if capsule.link not in held)
        inner = self.inner and tuple(capsule for capsule in self.inner if capsule.link not in held)
        return replace(
            self,
            links=tuple(link for link in self.links if link not in held),
            joints=tuple(joint for joint in self.joints if joint.child not in held),
            capsules=capsules,
            pairs=tuple(pair for pair in self.pairs if held.isdisjoint(pair)),
            hulls=tuple(hull for hull in self.hulls if hull.link not in held),
            holds=(),
            inner=None if inner == capsules else inner,
            shapes=tuple(each for each in self.shapes if each.link not in held),
        )


def pieces_of(robot: Robot) -> dict[str, list[Piece]]:
    """Return the hulls of every link that has a body; its capsules where it has no hulls."""
    pieces: dict[str, list[Piece]] = {}
    for hull in robot.hulls:
        pieces.setdefault(hull.link, []).append(Piece.solid(hull, hull.points, hull.radius))
    own = set(pieces)
    for capsule in robot.capsules:
        if capsule.link not in own:
            pieces.setdefault(capsule.link, []).append(piece_of(capsule))
    return pieces


def require_robot(robot: object) -> Robot:
    """Return a Robot, or raise InvalidValue: names and files are read by ``load_robot``."""
    if isinstance(robot, Robot):
        return robot
    raise InvalidValue(f"robot must be a Robot, as load_robot(name or file) gives it, got {shown(robot)}")
