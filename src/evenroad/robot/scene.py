"""Scene: the obstacles around a robot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import count
from struct import Struct
from typing import Any, TypeAlias

from evenroad._above import above
from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad._checks import counted, require_known, require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose, Vector
from evenroad.geometry.rotation import NO_ROTATION
from evenroad.geometry.shapes import PRIMITIVES, Capsule, Mesh, PointCloud, Shape, along_z, shape_of
from evenroad.robot.held import HeldObject

MARGIN = 0.02
"""Default distance from the robot up to which points of a scan belong to it [m]."""


_ROW = Struct("16d")
_NUMBERS = {kind: number for number, kind in enumerate(PRIMITIVES)}


@dataclass(frozen=True)
class Seen:
    """Configuration of a robot when a cloud was recorded, as :func:`evenroad.robot.configuration` takes it, and a
    margin [m].

    Balls of the cloud within the margin of its bodies belong to the robot; :func:`evenroad.robot.without_robot` removes
    them.
    """

    at: str
    margin: float = MARGIN

    def __post_init__(self) -> None:
        require_positive("the margin of a scan", self.margin, or_zero=True)


@dataclass(frozen=True)
class Cut:
    """An attached object that is removed from a cloud, since the camera saw it where it is grasped.

    Balls of the cloud whose centres come within `grow` [m], >= 0, of the `attached` object of that name are removed,
    with the robot standing `at`, as :func:`evenroad.robot.configuration` takes it.
    """

    attached: str
    at: str
    grow: float = MARGIN

    def __post_init__(self) -> None:
        require_positive("by how much a cut grows", self.grow, or_zero=True)


@dataclass(frozen=True, repr=False)
class Obstacle:
    """A body that does not move, by a name that is unique in its scene.

    `body` is a box, sphere, cylinder, capsule, mesh, or cloud of radius > 0, with its pose in the frame of the robot's
    root link; others, and what is fixed to a link, are refused (InvalidValue).  `cell` says whether it is part of the
    fixed cell, the same for every task of this installation; `seen`, where the robot stands that is in a cloud itself;
    `cuts`, what else is taken out of the cloud.
    """

    name: str
    body: Shape
    cell: bool = False
    seen: Seen | None = None
    cuts: tuple[Cut, ...] = ()
    row: bytes = field(init=False, repr=False, compare=False)
    """Sixteen doubles for native code, see ``kernel/native_scene.py``; none for clouds and meshes."""

    def __post_init__(self) -> None:
        body = along_z(self.body) if isinstance(self.body, Capsule) else self.body
        kinds = (*PRIMITIVES, PointCloud.kind, Mesh.kind)
        if getattr(body, "kind", None) not in kinds:
            raise InvalidValue(f"obstacle {self.name!r} must be one of {', '.join(kinds)}, got a {body}")
        if isinstance(body, Mesh):
            # Read now: a file may change, or be gone, before its triangles are used.
            body = replace(body, source=body.triangles, scale=(1.0, 1.0, 1.0))
        if body.link:
            raise InvalidValue(f"obstacle {self.name!r} must be fixed to the world, not to a link, got {body.link!r}")
        # Now rather than for every world: an obstacle is in many scenes.
        size, row = (*body.size, 0.0, 0.0)[:3], b""
        if body.kind in PRIMITIVES:
            row = _ROW.pack(_NUMBERS[body.kind], *size, *body.pose.rotation, *body.pose.xyz)
        set_fields(self, body=body, row=row)

    @classmethod
    def of(
        cls,
        name: str,
        kind: str,
        size: Sequence[float],
        xyz: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] = NO_ROTATION,
        cell: bool = False,
    ) -> Obstacle:
        """Return an obstacle by its dimensions (:func:`evenroad.geometry.shape_of`), origin [m] and rotation (9,).

        Raises UnknownName if there is no such shape; InvalidValue, which names the obstacle, if a dimension is not a
        finite number > 0, or the rotation is none.
        """
        try:
            return cls(name, shape_of(kind, size, Pose(xyz, rotation)), cell)
        except InvalidValue as error:
            raise InvalidValue(f"obstacle {name!r}: {error}") from None

    def __repr__(self) -> str:
        return f"Obstacle({self.name!r}, {self.body!r})"

    def at(self, pose: Pose) -> Obstacle:
        """Return the obstacle in another pose."""
        return replace(self, body=replace(self.body, pose=pose))

    @property
    def shape(self) -> str:
        """Kind of its body: ``box``, ``sphere``, ``cylinder``, ``capsule``, ``cloud`` or ``mesh``."""
        return self.body.kind

    @property
    def size(self) -> tuple[float, ...]:
        """Dimensions of its body, as :func:`evenroad.geometry.shape_of` takes them [m]."""
        return self.body.size

    @property
    def xyz(self) -> Vector:
        """Its middle in the frame of the robot's root link [m]."""
        return self.body.pose.xyz

    @property
    def rotation(self) -> tuple[float, ...]:
        """From the body's frame to that of the robot's root link, (9,) row by row."""
        return self.body.pose.rotation


Bodies: TypeAlias = "Sequence[Obstacle | Shape]"


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Scene:
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
    states : mapping
        Named configurations, joint -> value [rad or m], in which joints that are not planned for are held.
    limits : mapping
        Ranges to plan in, joint -> (lower, upper) [rad or m]; a world keeps to them by itself.
    attached : tuple of HeldObject
        What the robot holds, no two of one name; :func:`evenroad.robot.in_scene` takes over both.
    near_ends : frozenset of (str, str, float)
        Contacts, (link, cloud, distance), not tested with points within the distance [m] of the link's body at the
        start or a goal; see :func:`evenroad.robot.allowed_near_ends`.

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
    obstacles: tuple[Obstacle, ...]
    allowed: frozenset[tuple[str, str]]
    states: Mapping[str, Mapping[str, float]]
    limits: Mapping[str, tuple[float, float]]
    attached: tuple[HeldObject, ...]
    near_ends: frozenset[tuple[str, str, float]]

    def __init__(
        self,
        obstacles: Bodies | Mapping[str, Any] = (),
        *,
        name: str = "scene",
        allowed: frozenset[tuple[str, str]] = frozenset(),
        states: Mapping[str, Mapping[str, float]] | None = None,
        limits: Mapping[str, tuple[float, float]] | None = None,
        attached: tuple[HeldObject, ...] = (),
        near_ends: frozenset[tuple[str, str, float]] = frozenset(),
    ) -> None:
        if not isinstance(name, str):
            raise InvalidValue(f"the name of a scene must be a text, got {shown(name)}")
        values: dict[str, Any] = dict(allowed=allowed, attached=attached, near_ends=near_ends)
        values |= {"states": {} if states is None else states, "limits": {} if limits is None else limits}
        if isinstance(obstacles, Mapping):
            if more := sorted(key for key in values if values[key]):
                raise InvalidValue(
                    f"a scene of a mapping has what the mapping says: put {', '.join(more)} into it, too"
                )
            scene = above("Scene")(obstacles, name)
            set_fields(self, **{each.name: getattr(scene, each.name) for each in fields(scene)})
            return
        set_fields(self, name=name, obstacles=_as_obstacles(obstacles, (), name), **values)
        self._require_names()

    def __repr__(self) -> str:
        names = [obstacle.name for obstacle in self.obstacles]
        listed = ", ".join(names[:3]) + (", ..." if len(names) > 3 else "")
        return f"Scene({self.name!r}, {counted(len(names), 'obstacle')}{': ' if names else ''}{listed})"

    def _require_names(self) -> None:
        held = [each.name for each in self.attached]
        if len(set(held)) < len(held):
            twice = sorted({name for name in held if held.count(name) > 1})
            raise InvalidValue(f"scene {self.name!r} has something attached twice: {', '.join(twice)}")
        names = [obstacle.name for obstacle in self.obstacles]
        if both := sorted(set(held) & set(names)):
            raise InvalidValue(
                f"scene {self.name!r} has {both[0]!r} attached and as an obstacle: a robot that holds it would touch it"
            )
        if len(set(names)) < len(names):
            # What is allowed to touch the one would be allowed to touch the other.
            twice = sorted({name for name in names if names.count(name) > 1})
            raise InvalidValue(f"obstacles of scene {self.name!r} must have names of their own, twice: {twice}")

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of what decides results: obstacles and allowed contacts, in any order."""
        rows = set()
        for each in self.obstacles:
            numbers = (*each.size, *each.xyz, *each.rotation)
            content = (fingerprint_of(each.body),) if each.shape not in PRIMITIVES else ()
            rows.add((each.name, each.shape, *(number + 0.0 for number in numbers), *content))  # -0.0 is 0.0
        return fingerprint_of(rows, self.allowed, *sorted(self.near_ends))

    def with_(self, *obstacles: Obstacle | Shape | Bodies, allowed: Sequence[tuple[str, str]] = ()) -> Scene:
        """Return the scene with more obstacles, and more contacts left untested.

        Parameters
        ----------
        *obstacles : Shape, Obstacle, or sequence of such
            Of new names.
        allowed : sequence of (str, str)
            Contacts that are not tested, (link, obstacle).

        Returns
        -------
        Scene

        Raises
        ------
        InvalidValue
            As :class:`Scene`.

        Examples
        --------
        >>> import evenroad as er
        >>> er.load_scene("box-reach").with_(er.Sphere(0.05, xyz=(0.3, 0.3, 0.3), name="ball")).obstacles[-1].name
        'ball'
        """
        more: list[object] = []
        for each in obstacles:
            more += each if isinstance(each, list | tuple) else [each]
        added = _as_obstacles(more, self.obstacles, self.name)
        return replace(self, obstacles=(*self.obstacles, *added), allowed=self.allowed.union(allowed))

    def without(self, *names: str) -> Scene:
        """Return the scene without some obstacles, and without what was allowed to touch them.

        Parameters
        ----------
        *names : str
            Of the obstacles.

        Returns
        -------
        Scene

        Raises
        ------
        UnknownName
            If there is no such obstacle.

        Examples
        --------
        >>> import evenroad as er
        >>> er.Scene([er.Sphere(0.1, name="ball"), er.Sphere(0.2, name="moon")]).without("moon")
        Scene('scene', 1 obstacle: ball)
        """
        known = [obstacle.name for obstacle in self.obstacles]
        for name in names:
            require_known(f"obstacle of scene {self.name!r}:", name, known)
        return replace(
            self,
            obstacles=tuple(obstacle for obstacle in self.obstacles if obstacle.name not in names),
            allowed=frozenset((link, name) for link, name in self.allowed if name not in names),
            near_ends=frozenset(each for each in self.near_ends if each[1] not in names),
        )


def _as_obstacles(bodies: object, others: Sequence[Obstacle], scene: str) -> tuple[Obstacle, ...]:
    """Return shapes and obstacles as obstacles; a shape without a name gets one that neither they nor `others` have."""
    if isinstance(bodies, Shape | Obstacle):
        bodies = [bodies]
    if isinstance(bodies, str) or not isinstance(bodies, Iterable):
        hint = "a scene is read from its file by load_scene, and its name is name=..."
        raise InvalidValue(f"obstacles of scene {scene!r} must be a list of shapes, got {shown(bodies)}; {hint}")
    listed = tuple(bodies)
    for each in listed:
        if not isinstance(each, Shape | Obstacle):
            raise InvalidValue(
                f"obstacles of scene {scene!r} must be shapes, as er.Box((x, y, z), xyz=...), got {shown(each)}"
            )
    if all(isinstance(each, Obstacle) for each in listed):
        return listed
    taken = {each.name for each in (*listed, *others)}
    obstacles = []
    for each in listed:
        if isinstance(each, Shape):
            name = each.name or next(text for k in count() if (text := f"{each.kind} {k}") not in taken)
            taken.add(name)
            each = Obstacle(name, each)
        obstacles.append(each)
    return tuple(obstacles)


def limits_in_words(scene: Scene | None, joint: str, lower: float, upper: float) -> str:
    """Return what to call the limits of a joint: those of the scene where it has one of them, else its own."""
    whose = "its limits"
    if scene is not None and {lower, upper}.intersection(scene.limits.get(joint, ())):
        whose = f"the limits of scene {scene.name!r}"
    return f"{whose} [{lower:.6g}, {upper:.6g}]"
