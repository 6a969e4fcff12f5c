"""What the world of an arm is changed by: each verb returns another world, which shares what stays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

from evenroad._call import explains_calls
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Shape
from evenroad.robot.obstacle import Bodies, Obstacle
from evenroad.robot.scene import Scene

_STAYS = ("robot", "resolution", "clearance", "_space", "bounds", "robot_tables")


@explains_calls
class WorldChanges:
    """The verbs that change the scene of a world; see :class:`evenroad.ArmWorld`."""

    if TYPE_CHECKING:
        scene: Scene

    def moved(self, poses: Mapping[str, Pose]) -> Self:
        """Return the world with obstacles in other poses.

        Parameters
        ----------
        poses : mapping of str to Pose
            Obstacle -> its pose in the frame of the robot's root link.

        Returns
        -------
        ArmWorld

        Raises
        ------
        UnknownName, InvalidValue
            As :meth:`evenroad.Scene.moved`.

        Examples
        --------
        >>> import evenroad as er
        >>> world = er.ArmWorld("ur5", er.Scene([er.Box((0.1, 0.1, 0.1), xyz=(2, 0, 0), name="box")]))
        >>> world.valid("home"), world.moved({"box": er.Pose((0, 0.1, 0.5))}).valid("home")
        (True, False)
        """
        return self.within(self.scene.moved(poses))

    def with_(self, *obstacles: Obstacle | Shape | Bodies, allowed: Sequence[tuple[str, str]] = ()) -> Self:
        """Return the world with more obstacles.

        Parameters
        ----------
        *obstacles : Shape, Obstacle, or sequence of such
            Of new names.
        allowed : sequence of (str, str)
            Contacts that are not tested, (link, obstacle).

        Returns
        -------
        ArmWorld

        Raises
        ------
        UnknownName, InvalidValue
            As :meth:`evenroad.Scene.with_`.

        Examples
        --------
        >>> import evenroad as er
        >>> er.ArmWorld("ur5").with_(er.Sphere(0.2, xyz=(0, 0.1, 0.5))).valid("home")
        False
        """
        return self.within(self.scene.with_(*obstacles, allowed=allowed))

    def without(self, *names: str) -> Self:
        """Return the world without some obstacles.

        Parameters
        ----------
        *names : str
            Of the obstacles.

        Returns
        -------
        ArmWorld

        Raises
        ------
        UnknownName
            If there is no such obstacle.

        Examples
        --------
        >>> import evenroad as er
        >>> er.ArmWorld("ur5", "box-reach").without("box top").scene.names[-1]
        'box back'
        """
        return self.within(self.scene.without(*names))

    def within(self, scene: Scene) -> Self:
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
        world: Any = object.__new__(type(self))
        world.__dict__.update({name: self.__dict__[name] for name in _STAYS}, scene=scene)
        _ = world.native_scene  # at once: it refuses obstacles that are too far
        return world
