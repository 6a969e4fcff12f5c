from evenroad._arrays import Floats

def squared_speeds(
    curve: tuple[Floats, Floats, Floats, Floats, Floats], ceiling: Floats, acceleration: Floats
) -> Floats: ...
