"""Scene: the obstacles around a robot."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Unpack

import numpy.typing as npt

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls, require_options
from evenroad._checks import counted, require_known
from evenroad._fingerprint import fingerprint_of
from evenroad._hints import KnowsElsewhere
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PRIMITIVES, Box
from evenroad.robots.held import HeldObject
from evenroad.scenes.changes import Changes
from evenroad.scenes.obstacle import MARGIN as MARGIN
from evenroad.scenes.obstacle import Bodies, as_obstacles, box_rows, smaller_rows
from evenroad.scenes.obstacle import Cut as Cut
from evenroad.scenes.obstacle import Obstacle as Obstacle
from evenroad.scenes.obstacle import Seen as Seen
from evenroad.scenes.obstacles import Obstacles, Rows, named_twice, obstacles_of
from evenroad.scenes.robot_setup import NO_SETUP, RobotSetup, Said


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Scene(Changes, metaclass=KnowsElsewhere):
    """Obstacles, no two of one name; allowed contacts and named configurations.

    Parameters
    ----------
    obstacles : sequence of Shape or Obstacle, or mapping
        Shapes have their poses in the frame of the robot's root link; without a name of their own they are called
        ``box 0``, ``box 1``, ``sphere 0``.  A mapping says what a scene's file does, see :func:`evenroad.load_scene`,
        and files that it names lie in the current folder; nothing else is given with it but a name.
    name : str
        What the scene is called.
    allowed : frozenset of (str, str)
        Contacts that are not tested, (link, obstacle), e.g. of the base with its table.
    near_ends : frozenset of (str, str, float)
        Contacts, (link, cloud, distance), not tested with points within the distance [m] of the link's body at the
        start or a goal; see :func:`evenroad.robot.allowed_near_ends`.
    setup : RobotSetup
        All that the scene says of its robot, as one value; `said` replaces parts of it.
    **said : mapping
        ``states``: named configurations, joint -> value [rad or m], in which joints that are not planned for are held.
        ``limits``: ranges to plan in, joint -> (lower, upper) [rad or m]; a world keeps to them by itself.
        ``attached``: what the robot holds, a tuple of HeldObject, no two of one name;
        :func:`evenroad.robot.in_scene` takes over both.  ``padding``: link -> by how much it is larger against
        obstacles in worlds of this scene, at least, from 0 to 1 [m].

    Raises
    ------
    InvalidValue
        If two have one name, or something is no shape.

    Examples
    --------
    >>> import evenroad as er
    >>> er.Scene([er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.02), name="table"), er.Sphere(0.1, xyz=(0.5, 0, 0.4))])
    Scene('scene', 2 obstacles: table, sphere 0)
    >>> er.Scene({"obstacles": {"can": {"shape": "cylinder", "radius": 0.03, "length": 0.12, "xyz": [0.4, 0, 0.06]}}})
    Scene('scene', 1 obstacle: can)
    """

    name: str
    obstacles: Sequence[Obstacle]
    allowed: frozenset[tuple[str, str]]
    near_ends: frozenset[tuple[str, str, float]]
    setup: RobotSetup

    def __init__(
        self,
        obstacles: Bodies | Mapping[str, object] = (),
        *,
        name: str = "scene",
        allowed: frozenset[tuple[str, str]] = frozenset(),
        near_ends: frozenset[tuple[str, str, float]] = frozenset(),
        setup: RobotSetup | None = None,
        **said: Unpack[Said],
    ) -> None:
        require_options("Scene", said, Said, ("obstacles", "name", "allowed", "near_ends", "setup"))
        given: dict[str, Any] = {key: value for key, value in said.items() if value is not None}
        setup = setup or RobotSetup()
        setup = replace(setup, **given) if given else setup
        if isinstance(obstacles, Mapping):
            values = {"allowed": allowed, "near_ends": near_ends, **vars(setup)}
            if more := sorted(key for key in values if values[key]):
                raise InvalidValue(
                    f"a scene of a mapping has what the mapping says: put {', '.join(more)} into it, too"
                )
            from evenroad.scenes.scene_file import scene_of

            vars(self).update(vars(scene_of(obstacles, _named(name))))
            return
        known = obstacles if isinstance(obstacles, Obstacles) else None
        all_of_them = obstacles_of(obstacles, name) if known is None else known
        set_fields(self, name=_named(name), obstacles=all_of_them, allowed=allowed, near_ends=near_ends, setup=setup)
        if setup.attached:
            self._require_attached()
        if known is None:
            _require_different(self.name, all_of_them.names)

    @classmethod
    def of_boxes(
        cls,
        size: npt.ArrayLike,
        xyz: npt.ArrayLike,
        *,
        xyzw: npt.ArrayLike | None = None,
        names: Sequence[str] = (),
        name: str = "scene",
        allowed: frozenset[tuple[str, str]] = frozenset(),
    ) -> Scene:
        """Return a scene of many boxes, given as arrays: in a tenth of the time that objects take.

        Parameters
        ----------
        size, xyz : array_like, shape (n, 3)
            Full extents, > 0, and centres in the frame of the robot's root link [m].
        xyzw : array_like, shape (n, 4), optional
            Quaternions of any norm > 0.  Default: the boxes lie along the axes.
        names : sequence of str
            Of the boxes.  Default: ``box 0``, ``box 1``, ...
        name, allowed : str, frozenset of (str, str)
            As of :class:`Scene`.

        Returns
        -------
        Scene

        Raises
        ------
        InvalidValue
            If an array has another shape, or an entry that is not allowed, or two boxes have one name.

        Examples
        --------
        >>> import evenroad as er
        >>> er.Scene.of_boxes([(0.1, 0.1, 0.3), (0.8, 1.2, 0.04)], [(0.5, 0, 0.15), (0.5, 0, -0.02)])
        Scene('scene', 2 obstacles: box 0, box 1)
        """
        rows = box_rows(size, xyz, xyzw)
        texts = tuple(names) if len(names) else _numbered(len(rows))
        if len(texts) != len(rows):
            raise InvalidValue(f"names must be {len(rows)}, one a box, got {len(texts)}")
        if len(names):
            _require_different(name, texts)
        return _scene(_NOTHING_ELSE, name=_named(name), obstacles=Rows(rows, texts), allowed=allowed)

    @property
    def states(self) -> Mapping[str, Mapping[str, float]]:
        """Named configurations, joint -> value [rad or m]."""
        return self.setup.states

    @property
    def limits(self) -> Mapping[str, tuple[float, float]]:
        """Ranges to plan in, joint -> (lower, upper) [rad or m]."""
        return self.setup.limits

    @property
    def attached(self) -> tuple[HeldObject, ...]:
        """What the robot holds."""
        return self.setup.attached

    @property
    def padding(self) -> Mapping[str, float]:
        """Link -> by how much it is larger against obstacles, at least [m]."""
        return self.setup.padding

    @property
    def table(self) -> Obstacles:
        """The obstacles, which also give their names and rows."""
        # Neither an assertion nor a cast: it would take a tenth of the time of a change.
        return self.obstacles  # type: ignore[return-value]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the obstacles."""
        return self.table.names

    @property
    def rows(self) -> Floats:
        """The obstacles but clouds and meshes, (n, 17), as the native kernel takes them.

        Their kind; full extents of a box, or radius and length without caps, and zeros [m]; rotation to the root link's
        frame, row by row; centre in that frame [m]; clearance [m].
        """
        return self.table.rows

    @property
    def surfaces(self) -> tuple[tuple[int, Obstacle], ...]:
        """The clouds and meshes among the obstacles, with their numbers."""
        return self.table.surfaces

    @property
    def solid_names(self) -> tuple[str, ...]:
        """Names of the obstacles but clouds and meshes: those of `rows`."""
        return tuple(each.name for each in self.obstacles if each.row) if self.surfaces else self.names

    def __repr__(self) -> str:
        names = self.names
        listed = ", ".join(names[:3]) + (", ..." if len(names) > 3 else "")
        return f"Scene({self.name!r}, {counted(len(names), 'obstacle')}{': ' if names else ''}{listed})"

    def _require_attached(self) -> None:
        held = [each.name for each in self.attached]
        if twice := named_twice(held):
            raise InvalidValue(f"scene {self.name!r} has something attached twice: {', '.join(twice)}")
        if both := sorted(name for name in held if self.table.has(name)):
            raise InvalidValue(
                f"scene {self.name!r} has {both[0]!r} attached and as an obstacle: a robot that holds it would touch it"
            )

    def _require_known(self, names: Iterable[str]) -> None:
        for name in names:
            if not self.table.has(name):
                require_known(f"obstacle of scene {self.name!r}:", name, self.names)

    def _moved(self, poses: Mapping[str, Pose]) -> Scene:
        self._require_known(poses)
        for name, pose in poses.items():
            if not isinstance(pose, Pose):
                raise InvalidValue(f"the pose of obstacle {name!r} must be a Pose, got {shown(pose)}")
        return _scene(vars(self), obstacles=self.table.moving(poses), setup=self._setup_without(poses))

    def _named_new(self, bodies: Sequence[object]) -> tuple[Obstacle, ...]:
        """Return shapes and obstacles, also lists of such, as obstacles with names that this scene does not have.

        Raises InvalidValue if a name is taken, or something is no shape.
        """
        flat = [each for part in bodies for each in (part if isinstance(part, list | tuple | Obstacles) else [part])]
        added = as_obstacles(flat, self.table.has, self.name)
        names = [each.name for each in added]
        if any(map(self.table.has, names)) or named_twice(names):
            _require_different(self.name, (*self.names, *names))
        return added

    def _with(self, obstacles: Sequence[object], allowed: Sequence[tuple[str, str]]) -> Scene:
        added = self._named_new(obstacles)
        if self.attached and any(each.name == one.name for each in self.attached for one in added):
            return replace(self, obstacles=self.table.adding(added))  # which names the two
        # Its parts fit each other: `replace` would look at them again.
        return _scene(vars(self), obstacles=self.table.adding(added), allowed=self.allowed.union(allowed))

    def _without(self, names: Sequence[str]) -> Scene:
        self._require_known(names)
        allowed = frozenset([each for each in self.allowed if each[1] not in names])
        near_ends = frozenset([each for each in self.near_ends if each[1] not in names])
        parts = {"allowed": allowed, "near_ends": near_ends, "setup": self._setup_without(names)}
        return _scene(vars(self), obstacles=self.table.removing(names), **parts)

    def _setup_without(self, names: Collection[str]) -> RobotSetup:
        """Return what is said of the robot, without the frames of some obstacles."""
        frames = self.setup.frames
        return self.setup if frames is None else replace(self.setup, frames=frames.without(names))

    def with_clearance(self, clearance: Mapping[str, float]) -> Scene:
        """Return the scene with obstacles from which robots keep more away.

        Parameters
        ----------
        clearance : mapping of str to float
            Obstacle -> distance to keep, 0 to 1 [m], beside the clearance of a world and the padding of links.

        Returns
        -------
        Scene

        Raises
        ------
        UnknownName
            If there is no such obstacle.
        InvalidValue
            If a distance is not such a number.

        Examples
        --------
        >>> import evenroad as er
        >>> scene = er.load_scene("box-reach").with_clearance({"box top": 0.01})
        >>> scene.obstacles[scene.names.index("box top")].clearance
        0.01
        """
        if not isinstance(clearance, Mapping):
            raise InvalidValue(f"clearance must be a mapping, obstacle -> metres, got {shown(clearance)}")
        self._require_known(clearance)
        changed = (replace(each, clearance=clearance.get(each.name, each.clearance)) for each in self.obstacles)
        return replace(self, obstacles=Obstacles(changed))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the scene as a file that :func:`evenroad.load_scene` reads; meshes and clouds are files beside it.

        Parameters
        ----------
        path : str or path-like
            A ``.yaml``.

        Raises
        ------
        UnknownName
            For another suffix.
        NotAvailable
            If objects are in the frames of links, as in scenes of MoveIt without a robot.
        BrokenFile
            If a file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> import evenroad as er
        >>> scene = er.Scene([er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.02), name="table")])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     scene.save(f"{folder}/cell.yaml")
        ...     er.load_scene(f"{folder}/cell.yaml").fingerprint() == scene.fingerprint()
        True
        """
        from evenroad.scenes.written import save_scene

        save_scene(self, path)

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of what decides results: obstacles and allowed contacts, in any order."""
        rows = set()
        for each in self.obstacles:
            numbers = (*each.size, *each.xyz, *each.rotation)
            content: tuple[str | float, ...] = (fingerprint_of(each.body),) if each.shape not in PRIMITIVES else ()
            content += (each.clearance,) if each.clearance else ()
            rows.add((each.name, each.shape, *(number + 0.0 for number in numbers), *content))  # -0.0 is 0.0
        frames = self.setup.frames
        placed = () if frames is None else ({*frames.links.items()}, {*frames.joints.items()})
        return fingerprint_of(rows, self.allowed, *sorted(self.near_ends), *placed)


_NOTHING_ELSE: dict[str, object] = {"near_ends": frozenset(), "setup": NO_SETUP}


def _scene(values: Mapping[str, object], **more: object) -> Scene:
    """Return a scene of fields that fit each other: it is made in a tenth of the time of one that looks at them."""
    scene = object.__new__(Scene)
    vars(scene).update(values, **more)
    return scene


def smaller_scene(scene: Scene, by: float) -> Scene:
    """Return a scene for checks alone: obstacles are smaller by a distance [m], without clouds and meshes."""
    rows, left = smaller_rows(scene.rows, by)
    solid = [name for number, name in enumerate(scene.names) if number not in dict(scene.surfaces)]
    names = tuple(name for name, is_left in zip(solid, left.tolist(), strict=True) if is_left)
    allowed = frozenset(each for each in scene.allowed if each[1] in names)
    return _scene(_NOTHING_ELSE, name=scene.name, obstacles=Rows(rows, names), allowed=allowed)


def without_limits(scene: Scene) -> Scene:
    """Return a scene without ranges to plan in."""
    return replace(scene, setup=replace(scene.setup, limits={}))


@lru_cache(maxsize=8)
def _numbered(count: int) -> tuple[str, ...]:
    """Return the names of boxes that have none."""
    return tuple([f"{Box.kind} {i}" for i in range(count)])


def _named(name: object) -> str:
    """Return the name of a scene, or raise InvalidValue."""
    if not isinstance(name, str):
        raise InvalidValue(f"the name of a scene must be a text, got {shown(name)}")
    return name


def _require_different(scene: str, names: Sequence[str]) -> None:
    """Raise InvalidValue if two obstacles have one name: what may touch the one would be allowed to touch the other."""
    if twice := named_twice(names):
        raise InvalidValue(f"obstacles of scene {scene!r} must have names of their own, twice: {twice}")


def limits_in_words(scene: Scene | None, joint: str, lower: float, upper: float, whose: str = "its limits") -> str:
    """Return what to call the limits of a joint: those of the scene where it has one of them, else `whose`."""
    if scene is not None and {lower, upper}.intersection(scene.limits.get(joint, ())):
        whose = f"the limits of scene {scene.name!r}"
    return f"{whose} [{lower:.6g}, {upper:.6g}]"
