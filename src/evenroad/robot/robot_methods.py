"""Methods of a robot without a scene: joints, limits, forward and inverse kinematics, samples."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Self

import numpy.typing as npt

from evenroad._above import above
from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._rng import RngLike
from evenroad.geometry.parts import Parts, kinds_in_words
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Capsule

if TYPE_CHECKING:
    from evenroad.robot.pose_goal import PoseGoal
    from evenroad.robot.scene import Scene

Padding = float | Mapping[str, float] | str | os.PathLike[str]
"""What says by how much links are larger: a length of all of them, link -> length, or a file of MoveIt."""


@explains_calls
class RobotMethods:
    """Methods of :class:`evenroad.robot.Robot`."""

    name: str
    links: tuple[str, ...]
    group: tuple[str, ...]
    if TYPE_CHECKING:
        capsules: tuple[Capsule, ...]
        shapes: tuple[Parts, ...]

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The joints that are planned for, in the order of a configuration; another name for `group`."""
        return self.group

    @property
    def dof(self) -> int:
        """Number of values in a configuration."""
        return len(self.group)

    @property
    def limits(self) -> Floats:
        """Lower and upper limit of each joint of the group, (dof, 2) [rad or m]; infinite for continuous ones."""
        limits: Floats = above("Robot.limits")(self)
        return limits

    def configuration(self, q: npt.ArrayLike | Mapping[str, float] | str, scene: Scene | None = None) -> Floats:
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
        row: Floats = above("Robot.configuration")(self, q, scene)
        return row

    def fk(self, q: npt.ArrayLike | Mapping[str, float] | str, link: str = "") -> Pose:
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
        pose: Pose = above("Robot.fk")(self, q, link)
        return pose

    def ik(
        self, pose: Pose | PoseGoal, link: str = "", *, start: npt.ArrayLike | Mapping[str, float] | str = ()
    ) -> Floats:
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
        found: Floats = above("Robot.ik")(self, pose, link, start)
        return found

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
        drawn: Floats = above("Robot.random")(self, rng, n)
        return drawn

    def with_padding(self, padding: Padding) -> Self:
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
        padded: Self = above("Robot.with_padding")(self, padding)
        return padded

    @property
    def bodies(self) -> str:
        """The kinds of bodies that decide what touches an obstacle: ``capsules``, or as ``hulls, meshes and capsules``.

        A link without shapes of its own is its capsules.
        """
        return kinds_in_words(self.shapes, self.capsules)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, {self.dof} joints, {len(self.links)} links)"
