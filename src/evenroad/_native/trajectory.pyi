from evenroad._arrays import Floats

def fastest(
    path: tuple[Floats, Floats, Floats, Floats, Floats],
    stops: Floats,
    velocity: Floats,
    acceleration: Floats,
    within: tuple[Floats, float, float, tuple[Floats, Floats, Floats, Floats, Floats, Floats] | None],
) -> tuple[Floats, Floats, Floats, Floats]: ...
def states(
    path: tuple[Floats, Floats, Floats, Floats, Floats], law: tuple[Floats, Floats, Floats, Floats], t: Floats
) -> tuple[Floats, Floats, Floats]: ...
def largest_shares(
    path: tuple[Floats, Floats, Floats, Floats, Floats],
    law: tuple[Floats, Floats, Floats, Floats],
    velocity: Floats,
    acceleration: Floats,
    samples: int,
) -> tuple[float, float]: ...
def drive(
    path: tuple[Floats, Floats, Floats, Floats, Floats],
    law: tuple[Floats, Floats, Floats, Floats],
    waypoints: Floats,
    most: tuple[Floats, Floats],
    t: Floats,
    stride: int,
) -> tuple[Floats, Floats, Floats, Floats, float, float]: ...
def timed(
    waypoints: Floats, deviation: Floats, most: tuple[Floats, Floats, float], steps: tuple[float, int]
) -> tuple[Floats, Floats, Floats, Floats, Floats, int, float, float, tuple[float, float]]: ...
def rounded(waypoints: Floats, deviation: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats, Floats]: ...
def averages(
    path: tuple[Floats, Floats, Floats, Floats, Floats],
    law: tuple[Floats, Floats, Floats, Floats],
    window: float,
    t: Floats,
) -> tuple[Floats, Floats, Floats]: ...
def largest_share(rows: Floats, most: Floats, of_steps: bool = False) -> float: ...
def distances_to(waypoints: Floats, points: Floats) -> Floats: ...
