from evenroad._arrays import Bools, Floats, Ints

Links = tuple[Ints, Ints, Bools, Floats]

class TorqueLimits:
    def __init__(self, links: Links, efforts: Floats, gravity: Floats) -> None: ...
    def torques(self, q: Floats, velocity: Floats, acceleration: Floats) -> Floats: ...

class TipLimits:
    def __init__(self, links: Links, dim: int, link: int, point: Floats, speed: float, acceleration: float) -> None: ...

Most = tuple[Floats, Floats, Floats]
Within = tuple[float, float, float, tuple[TorqueLimits | None, TipLimits | None], float]

def fastest(
    path: tuple[Floats, Floats, Floats, Floats, Floats],
    stops: Floats,
    most: Most,
    within: Within,
) -> tuple[Floats, Floats, Floats, Floats] | None: ...
def further_shares(
    limits: tuple[TorqueLimits | None, TipLimits | None], q: Floats, velocity: Floats, acceleration: Floats
) -> tuple[float, float, float]: ...
def states(
    path: tuple[Floats, Floats, Floats, Floats, Floats], law: tuple[Floats, Floats, Floats, Floats], t: Floats
) -> tuple[Floats, Floats, Floats]: ...
def largest_shares(
    path: tuple[Floats, Floats, Floats, Floats, Floats],
    law: tuple[Floats, Floats, Floats, Floats],
    most: Most,
    samples: int,
) -> tuple[float, float]: ...
def timed(
    waypoints: Floats, deviation: Floats, most: Most, within: Within, steps: tuple[float, int]
) -> tuple[
    str,
    tuple[Floats, Floats, Floats],
    Floats,
    Floats,
    int,
    float,
    float,
    tuple[float, float],
    tuple[float, float, float],
    bool,
    Floats,
]: ...
def rounded(waypoints: Floats, deviation: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats, Floats]: ...
def bends_of(waypoints: Floats, same: float) -> Ints: ...
def averages(
    path: tuple[Floats, Floats, Floats, Floats, Floats],
    law: tuple[Floats, Floats, Floats, Floats],
    window: float,
    t: Floats,
) -> tuple[Floats, Floats, Floats]: ...
def largest_share(rows: Floats, most: Floats, of_steps: bool = False) -> float: ...
def distances_to(waypoints: Floats, points: Floats) -> Floats: ...
