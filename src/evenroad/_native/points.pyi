from evenroad._arrays import Floats

class PairSums:
    sums: Floats
    gradient: Floats

class RieszRows:
    nearest: Floats
    sums: Floats
    pushes: Floats

class Dispersion:
    lower: float
    upper: float
    work: float

def maximum_pair_sums(columns: Floats, ceiling: Floats, slope: Floats, want_gradient: bool) -> PairSums: ...
def distance_pair_sums(
    columns: Floats,
    level: Floats,
    slope: Floats,
    curvature: Floats,
    own: Floats,
    own_slope: Floats,
    want_gradient: bool,
) -> PairSums: ...
def riesz_rows(columns: Floats, s: int, periodic: bool, want_gradient: bool) -> RieszRows: ...
def star_discrepancy(columns: Floats) -> float: ...
def bound_dispersion(
    points: Floats, period: Floats, sides: Floats, lower: float, share: float, most: float
) -> Dispersion: ...
