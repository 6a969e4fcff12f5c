from evenroad._arrays import Floats

def maximum_pair_sums(
    columns: Floats, ceiling: Floats, slope: Floats, want_gradient: bool
) -> tuple[Floats, Floats]: ...
def distance_pair_sums(
    columns: Floats, pairs: tuple[Floats, Floats, Floats, Floats, Floats], want_gradient: bool
) -> tuple[Floats, Floats]: ...
