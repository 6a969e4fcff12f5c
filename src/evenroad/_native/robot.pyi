from collections.abc import Mapping, Sequence
from typing import Literal, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints

Arrays = Mapping[str, npt.NDArray[np.generic]]

class Robot:
    def __init__(
        self,
        frames: Arrays,
        bodies: Arrays,
        capsules: Arrays,
        pairs: Arrays,
        hulls: Arrays,
        shapes: Arrays,
        limits: Arrays,
    ) -> None: ...

class HullTrees:
    def __init__(self, first_part: Ints, first_point: Ints, points: Floats, widths: Floats) -> None: ...
    def ball(self, body: int) -> Floats: ...
    def contacts(self, first: int, second: int, poses: Floats) -> Ints: ...

class Surface:
    def __init__(
        self, corners: Floats, radius: float, solid: Floats, turned: bool, reach: float, first: Bools, closed: Bools
    ) -> None: ...
    @staticmethod
    def of_cloud(
        points: Floats, rotation: Floats, xyz: Floats, radius: float, clearance: float, reach: float
    ) -> Surface | None: ...
    @staticmethod
    def around(surfaces: Sequence[Surface | None]) -> Surface: ...

class ClosedParts:
    """Which triangles bound solids, must be flipped, and are the first of their part, (t,) each."""

    closed: Bools
    turned: Bools
    first: Bools
    oriented: bool

def closed_parts(vertices: Floats, triangles: Ints) -> ClosedParts: ...
def pieces_within(triangles: Floats, first: Bools, reach: float, longest: float) -> tuple[Floats, Bools]: ...
def winding_at(point: Floats, triangles: Floats, turned: bool) -> int: ...
def primitive_rows(entries: dict[str, object]) -> Floats | None: ...
def shape_rows(shapes: tuple[object, ...], types: tuple[type, ...]) -> Floats | None: ...
def are_usual(rows: Floats, plane: Floats, reach: float, large: float, huge: float, tiny: float) -> bool: ...
def box_rows(size: object, xyz: object, xyzw: object) -> Floats | None: ...

class SurfaceObstacle:
    def __init__(self, surface: Surface, number: int, tested: Bools) -> None: ...

class Scene:
    added: float
    changes: int
    too_far: int
    surfaces: int
    def __init__(
        self,
        robot: Robot,
        obstacles: Floats,
        tested: Bools,
        surfaces: list[SurfaceObstacle],
        around: Surface | None,
        clearance: float,
    ) -> None: ...
    def changed(
        self, robot: Robot, gone: Ints, obstacles: Floats, numbers: Ints, tested: Bools, clearance: float
    ) -> Scene | None: ...

class Contact:
    """A contact: a capsule and an obstacle of the scene or one of its surfaces, or the number of a pair of capsules."""

    kind: Literal["nothing", "obstacle", "surface", "itself"]
    capsule: int
    other: int

class Checker:
    fixed_contact: Contact
    def __init__(
        self, robot: Robot, scene: Scene, resolution: float, clearance: float, touches_itself: bool
    ) -> None: ...
    @overload
    def valid(self, q: Floats) -> Bools: ...
    @overload
    def valid(self, q: object) -> Bools | bool | None: ...
    @overload
    def motion_valid(self, a: Floats, b: Floats, tolerance: float = 0.0) -> Bools: ...
    @overload
    def motion_valid(self, a: object, b: object, tolerance: float = 0.0) -> Bools | bool | None: ...
    def distances(self, q: Floats, most: float, to_itself: bool) -> tuple[Floats, list[Contact]]: ...
    def find_contact(self, q: Floats) -> Contact: ...

KeepKind: TypeAlias = Literal["linear", "box", "circle", "together", "joints"]

class Keep:
    def __init__(self, kind: KeepKind, first: int, second: int, limit: float, numbers: Floats) -> None: ...

class Projecting:
    def __init__(self, aim: float, enough: float, steps: int, longest: float) -> None: ...

class Walking:
    def __init__(self, scale: Floats, step: float, jump: float, projecting: Projecting) -> None: ...

class Keeps:
    def __init__(self, chains: list[Chain], constraints: list[Keep], limits: Floats) -> None: ...
    def shares(self, q: Floats) -> Floats: ...
    def residuals(self, q: Floats) -> Floats: ...
    def derivative(self, q: Floats) -> Floats: ...
    def project(self, q: Floats, how: Projecting) -> tuple[Floats, Bools]: ...
    def walk(self, begins: Floats, directions: Floats, how: Walking) -> tuple[Floats, Ints]: ...
    def refine(self, paths: Floats, counts: Ints, pieces: int, how: Walking) -> tuple[Floats, Ints]: ...

class Beginnings:
    """Configurations at which solutions begin: `start`, and those of the nearest tips among `known`.

    These are one in `every` from number `first` to below `last`.
    """

    def __init__(self, start: Floats, known: Floats, tips: Floats, first: int, last: int, every: int) -> None: ...

class Postures:
    """Coordinates that a whole turn leaves in the same posture, their bounds, and the extent of one posture."""

    def __init__(self, turns: Bools, bounds: Floats, same: float) -> None: ...

class Solutions:
    """Postures of all tasks, the task of each, the configuration nearest to each task, and its squared error."""

    q: Floats
    task: Ints
    nearest: Floats
    missing: Floats

class Chain:
    def __init__(self, coordinates: Ints, slides: Bools, rows: Floats, dim: int) -> None: ...
    def tip_poses(self, q: Floats) -> Floats: ...
    def derivatives(self, q: Floats) -> Floats: ...
    def reach(self, q: Floats, task: Floats, limits: Floats, steps: int, enough: int) -> tuple[Floats, Floats]: ...
    def reach_all(
        self,
        beginnings: Beginnings,
        tasks: Floats,
        limits: Floats,
        postures: Postures,
        steps: int,
        enough: int,
    ) -> Solutions: ...
    def follow(
        self, q: Floats, towards: Floats, task: Floats, poses: Floats, limits: Floats, steps: int, longest: float
    ) -> Floats: ...
