from typing import Literal

from evenroad._arrays import Bools, Floats, Ints

class MovingLinks:
    def __init__(self, dim: int, coordinates: Ints, parents: Ints, slides: Bools, rows: Floats) -> None: ...

class TorqueLimits:
    def __init__(self, links: MovingLinks, efforts: Floats, gravity: Floats) -> None: ...
    def torques(self, q: Floats, velocity: Floats, acceleration: Floats) -> Floats: ...

class TipLimits:
    def __init__(self, links: MovingLinks, link: int, point: Floats, speed: float, acceleration: float) -> None: ...

class FurtherLimits:
    def __init__(self, torque: TorqueLimits | None, tip: TipLimits | None) -> None: ...

class JointLimits:
    velocity: Floats
    acceleration: Floats
    deceleration: Floats
    def __init__(self, velocity: Floats, acceleration: Floats, deceleration: Floats) -> None: ...

class PathLimits:
    """Limits along a path: the square of the speed, speeds at both ends, and a share of further limits."""

    def __init__(self, highest: float, start: float, goal: float, further: FurtherLimits, share: float) -> None: ...

class RoundedPath:
    """A sequence of straight lines and arcs (Kunz and Stilman 2012, section IV).

    Piece i reaches from length ``starts[i]`` to ``starts[i + 1]``.  It is a line from ``origin[i]`` along ``along[i]``
    where the curvature ``bend[i]`` is 0, else an arc of radius ``1 / bend[i]`` about ``origin[i]``, from the direction
    ``out[i]`` towards ``along[i]``.  `corners`, (p - 2,), are the lengths at the inner waypoints, `stops` those at
    which the direction jumps.
    """

    starts: Floats
    origin: Floats
    out: Floats
    along: Floats
    bend: Floats
    corners: Floats
    stops: Floats
    length: float

class TimeLaw:
    times: Floats
    lengths: Floats
    speeds: Floats
    accelerations: Floats
    def __init__(self, times: Floats, lengths: Floats, speeds: Floats, accelerations: Floats) -> None: ...

class States:
    positions: Floats
    velocities: Floats
    accelerations: Floats

class Shares:
    velocity: float
    acceleration: float

class FurtherShares:
    torque: float
    tip_speed: float
    tip_acceleration: float

class Timed:
    """The outcome of a trajectory: states at its steps, their lengths along the path, and measures."""

    outcome: Literal["made", "too long", "too heavy", "too fast", "not within"]
    positions: Floats
    velocities: Floats
    accelerations: Floats
    lengths: Floats
    corners: Floats
    deviations: Floats
    stops: int
    duration: float
    deviation: float
    highest: Shares
    further: FurtherShares
    is_slower_at_start: bool

def fastest(path: RoundedPath, most: JointLimits, within: PathLimits) -> TimeLaw | None: ...
def further_shares(limits: FurtherLimits, q: Floats, velocity: Floats, acceleration: Floats) -> FurtherShares: ...
def states(path: RoundedPath, law: TimeLaw, t: Floats) -> States: ...
def largest_shares(path: RoundedPath, law: TimeLaw, most: JointLimits, samples: int) -> Shares: ...
def timed(
    waypoints: Floats, deviation: Floats, most: JointLimits, within: PathLimits, step: float, most_steps: int
) -> Timed: ...
def rounded(waypoints: Floats, deviation: Floats) -> RoundedPath:
    """Round the corners of a path, (p, dim), p >= 2, no two waypoints in a row equal.

    The arc at waypoint i passes it within ``deviation[i]``, (p,), and replaces at most half of both motions.  A
    `deviation` of 0 is a stop at the corner.
    """

def bends_of(waypoints: Floats, same: float) -> Ints: ...
def averages(path: RoundedPath, law: TimeLaw, window: float, t: Floats) -> States: ...
def largest_share(rows: Floats, most: Floats, of_steps: bool = False) -> float: ...
def distances_to(waypoints: Floats, points: Floats) -> Floats: ...
