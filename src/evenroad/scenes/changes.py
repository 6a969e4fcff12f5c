"""The verbs that change a scene, or the scene of a world: each returns another one, which shares what stays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Self

from evenroad._call import explains_calls
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Shape
from evenroad.scenes.obstacle import Bodies, Obstacle


@explains_calls
class Changes:
    """Verbs of :class:`evenroad.Scene` and of :class:`evenroad.ArmWorld`."""

    if TYPE_CHECKING:

        def _moved(self, poses: Mapping[str, Pose]) -> Self: ...

        def _with(self, obstacles: Sequence[object], allowed: Sequence[tuple[str, str]]) -> Self: ...

        def _without(self, names: Sequence[str]) -> Self: ...

    def moved(self, poses: Mapping[str, Pose]) -> Self:
        """Return a scene, or a world, whose named obstacles stand elsewhere: a matter of microseconds.

        Parameters
        ----------
        poses : mapping of str to Pose
            Obstacle -> its pose in the frame of the robot's root link; of a capsule with its axis along z.

        Returns
        -------
        Scene or ArmWorld
            A new one; this one does not change.

        Raises
        ------
        UnknownName
            If a name is that of no obstacle.
        InvalidValue
            If something is no pose.

        Examples
        --------
        >>> import evenroad as er
        >>> scene = er.Scene([er.Box((0.1, 0.1, 0.1), xyz=(2, 0, 0), name="box")])
        >>> scene.moved({"box": er.Pose((0.5, 0, 0.2))}).obstacles[0].xyz
        (0.5, 0.0, 0.2)
        >>> world = er.ArmWorld("ur5", scene)
        >>> world.valid("home"), world.moved({"box": er.Pose((0, 0.1, 0.5))}).valid("home")
        (True, False)
        """
        if not isinstance(poses, Mapping):
            raise InvalidValue(f"poses must be a mapping, obstacle -> Pose, got {shown(poses)}")
        return self._moved(poses)

    def with_(self, *obstacles: Obstacle | Shape | Bodies, allowed: Sequence[tuple[str, str]] = ()) -> Self:
        """Return a scene, or a world, that has these obstacles beside its own.

        Parameters
        ----------
        *obstacles : Shape, Obstacle, or sequence of such
            What is added, each with a name that is not taken.
        allowed : sequence of (str, str)
            Pairs (link, obstacle) that may touch, such as a base and its table.

        Returns
        -------
        Scene or ArmWorld
            The added obstacles come last.

        Raises
        ------
        InvalidValue
            If a name is taken, or something is no shape.
        UnknownName
            If a world's robot has no such link.

        Examples
        --------
        >>> import evenroad as er
        >>> er.load_scene("box-reach").with_(er.Sphere(0.05, xyz=(0.3, 0.3, 0.3), name="ball")).obstacles[-1].name
        'ball'
        >>> er.ArmWorld("ur5").with_(er.Sphere(0.2, xyz=(0, 0.1, 0.5))).valid("home")
        False
        """
        return self._with(obstacles, allowed)

    def without(self, *names: str) -> Self:
        """Return what is left of a scene, or of a world's, when some obstacles are taken away.

        Parameters
        ----------
        *names : str
            Names of those taken away; contacts that were allowed with them are forgotten.

        Returns
        -------
        Scene or ArmWorld
            The others keep their order.

        Raises
        ------
        UnknownName
            If one of them is not there.

        Examples
        --------
        >>> import evenroad as er
        >>> er.Scene([er.Sphere(0.1, name="ball"), er.Sphere(0.2, name="moon")]).without("moon")
        Scene('scene', 1 obstacle: ball)
        >>> er.ArmWorld("ur5", "box-reach").without("box top").scene.names[-1]
        'box back'
        """
        return self._without(names)
