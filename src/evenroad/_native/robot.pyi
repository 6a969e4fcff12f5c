from collections.abc import Mapping, Sequence
from typing import overload

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

def closed_parts(vertices: Floats, triangles: Ints) -> tuple[Bools, bool, Bools, Bools]: ...
def pieces_within(triangles: Floats, first: Bools, reach: float, longest: float) -> tuple[Floats, Bools]: ...
def winding_at(point: Floats, triangles: Floats, turned: bool) -> int: ...
def box_rows(size: object, xyz: object, xyzw: object) -> Floats | None: ...

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
        surfaces: list[tuple[Surface, int, Bools]],
        around: Surface | None,
        clearance: float,
    ) -> None: ...
    def changed(
        self, robot: Robot, gone: Ints, obstacles: Floats, numbers: Ints, tested: Bools, clearance: float
    ) -> Scene | None: ...

class Checker:
    fixed_contact: tuple[str, int, int]
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
    def distances(self, q: Floats, most: float, to_itself: bool) -> tuple[Floats, Ints]: ...
    def find_contact(self, q: Floats) -> tuple[str, int, int]: ...

class Keeps:
    def __init__(
        self, chains: list[Chain], constraints: list[tuple[int, int, int, float, Floats]], limits: Floats
    ) -> None: ...
    def shares(self, q: Floats) -> Floats: ...
    def residuals(self, q: Floats) -> Floats: ...
    def derivative(self, q: Floats) -> Floats: ...
    def project(
        self, q: Floats, aim: float, enough: float, steps: int, longest: float
    ) -> tuple[Floats, npt.NDArray[np.uint8]]: ...
    def walk(
        self, begins: Floats, directions: Floats, scale: Floats, how: tuple[float, float, float, float, int, float]
    ) -> tuple[Floats, Ints]: ...
    def refine(
        self,
        paths: Floats,
        counts: Ints,
        pieces: int,
        scale: Floats,
        how: tuple[float, float, float, float, int, float],
    ) -> tuple[Floats, Ints]: ...

class Chain:
    def __init__(self, coordinates: Ints, slides: Bools, rows: Floats, dim: int) -> None: ...
    def tip_poses(self, q: Floats) -> Floats: ...
    def derivatives(self, q: Floats) -> Floats: ...
    def reach(self, q: Floats, task: Floats, limits: Floats, steps: int, enough: int) -> tuple[Floats, Floats]: ...
    def reach_all(
        self,
        known: tuple[Floats, Floats, Floats],
        pick: tuple[int, int, int],
        tasks: Floats,
        limits: Floats,
        turns: tuple[Bools, Floats],
        apart: float,
        effort: tuple[int, int],
    ) -> tuple[Floats, Ints, Floats, Floats]: ...
    def follow(
        self, q: Floats, towards: Floats, task: Floats, poses: Floats, limits: Floats, steps: int, longest: float
    ) -> Floats: ...
