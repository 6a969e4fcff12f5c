from evenroad._arrays import Bools, Floats, Ints

class Limits:
    """Largest speed and acceleration of each axis, (3,) each, and the quickest motions within them."""

    def __init__(self, speed: Floats, acceleration: Floats) -> None: ...
    def least_times(self, a: Floats, b: Floats) -> Floats: ...
    def states_between(self, a: Floats, b: Floats, shares: Floats) -> Floats: ...
    def pieces_along(self, path: Floats) -> Floats: ...

class Nearest:
    """The nearest body, -1 for none, and the distance of a position from it [m]."""

    distance: float
    body: int

class Airspace:
    """Where a ball may fly: among bodies, within bounds and limits; it never changes.

    Solids are rows of 17 numbers as of a scene, `triangles` rows of nine coordinates and a rounding, `balls` rows of a
    centre and a radius.  Bodies are numbered in this order.  `movers` are numbers of solids that may move, `bounds` two
    corners.
    """

    def __init__(
        self,
        solids: Floats,
        triangles: Floats,
        balls: Floats,
        movers: Ints,
        bounds: Floats,
        limits: Limits,
        radius: float,
    ) -> None: ...
    def states_free(self, q: Floats) -> Bools: ...
    def motions_free(self, a: Floats, b: Floats) -> Bools: ...
    def with_moved(self, positions: Floats, velocities: Floats) -> Airspace: ...
    def path_free(self, path: Floats) -> Bools: ...
    def free_until(self, path: Floats, horizon: float) -> float: ...
    def follow(self, path: Floats, elapsed: float, here: Floats) -> Floats: ...
    def stop(self, here: Floats) -> Floats: ...
    def nearest(self, at: Floats, most: float) -> Nearest: ...

class FlightQuery:
    """A search for a path between two free states: rounds of two trees, then shortcuts in time."""

    path: Floats
    nodes: int
    motions: int
    shortcuts: int

    def __init__(self, airspace: Airspace, start: Floats, goal: Floats, variant: int) -> None: ...
    def search(self, rounds: int) -> bool: ...
    def shorten(self, tries: int) -> Floats: ...
