from evenroad._arrays import Bools, Floats, Ints

class Footprint:
    """The convex parts of a body, in cells, and disks that decide most checks of it."""

    def __init__(self, corners: Floats, sizes: Ints, cover: Floats, inner: Floats, radii: Floats) -> None: ...

class Steering:
    """How a car steers, in map units: its least turning radius, and what a radian on the spot counts."""

    def __init__(self, radius: float, spot: float, is_reversing: bool, cusp: float) -> None: ...
    def distances(self, a: Floats, b: Floats) -> Floats: ...
    def poses_between(self, a: Floats, b: Floats, shares: Floats) -> Floats: ...
    def pieces_between(self, a: Floats, b: Floats) -> Floats: ...
    def poses_along(self, start: Floats, pieces: Floats, step: float) -> Floats: ...

class Contact:
    """An occupied cell that a footprint overlaps, with which part, and how far [cells]."""

    row: int
    column: int
    part: int
    depth: float

class Obstacles:
    """Polygons on a grid of cells, by the corners of their borders, in cells from the corner of the map.

    `sizes` are the numbers of corners of the borders, `polygons` the polygon of each.  What an odd number of a
    polygon's borders surrounds is in it.  `occupied` are the cells that a polygon touches, `solid` those in one.
    """

    occupied: Bools
    solid: Bools

    def __init__(self, corners: Floats, sizes: Ints, polygons: Ints, rows: int, columns: int) -> None: ...

class SideContact:
    """A side of a polygon that a footprint overlaps, with which part, where, and how far, in map units."""

    polygon: int
    part: int
    x: float
    y: float
    depth: float

class Vehicle:
    """A footprint on a grid map: exact tests of its poses and motions; it never changes."""

    def __init__(self, occupied: Bools, frame: Floats, footprint: Footprint) -> None: ...
    @staticmethod
    def among(obstacles: Obstacles, inner: Bools, frame: Floats, footprint: Footprint) -> Vehicle: ...
    def poses_free(self, q: Floats) -> Bools: ...
    def lines_free(self, a: Floats, b: Floats) -> Bools: ...
    def curves_free(self, steering: Steering, a: Floats, b: Floats) -> Bools: ...
    def pieces_free(self, steering: Steering, start: Floats, pieces: Floats) -> bool: ...
    def gaps(self, q: Floats) -> Floats: ...
    def are_apart(self, start: Floats, goal: Floats, slices: int, most: int) -> bool: ...
    def is_unreachable(self, steering: Steering, start: Floats, goal: Floats, most: int) -> bool: ...
    def is_apart_from(self, start: Floats, middle: Floats, half: Floats, slices: int, most: int) -> bool: ...
    def free_length(self, steering: Steering, start: Floats, pieces: Floats, tolerance: float) -> float: ...
    def contact(self, q: Floats) -> Contact | None: ...
    def side_contact(self, q: Floats) -> SideContact | None: ...

class CarQuery:
    """A search for the path of a car between two free poses, round by round, and what it has checked so far.

    The path is made of pieces, rows (side, signed length): first after shortcuts, then before.
    """

    nodes: int
    poses: int
    motions: int
    shortcuts: int

    def __init__(self, vehicle: Vehicle, steering: Steering, start: Floats, goal: Floats, variant: int) -> None: ...
    def search(self, rounds: int, has_trees: bool = True) -> bool: ...
    def path(self, shortcuts: int) -> tuple[Floats, Floats]: ...
