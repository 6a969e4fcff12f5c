from typing import Literal

from evenroad._arrays import Floats, Ints

CLEARANCES: tuple[float, float]

class CompiledChecks:
    counts: tuple[int, int, int]
    def __init__(
        self, addresses: tuple[int, int, int, int], resolution: float, wider: dict[float, int]
    ) -> None: ...

class Trees:
    path: Floats
    goal: int
    sizes: tuple[int, int]
    trees: tuple[tuple[Floats, Ints], tuple[Floats, Ints]]
    def __init__(self, checks: CompiledChecks, ends: Floats, samples: Floats, steps: Floats) -> None: ...
    def grow(self, most_motions: int, batches: int) -> Literal["paused", "spent", "not free", "solved"]: ...

class Tree:
    nodes: tuple[Floats, Ints]
    def __init__(self, period: Floats) -> None: ...
    def add(self, q: Floats, parent: int) -> int: ...
    def nearest(self, q: Floats) -> int: ...
    def remove_branch(self, node: int) -> None: ...

def shorten(
    checks: CompiledChecks, path: Floats, pairs: Floats, most_shortcuts: int
) -> tuple[Floats, int]: ...
def smooth(
    checks: CompiledChecks, path: Floats, guides: tuple[Floats, Floats], most_batches: int, proved: bool
) -> tuple[Floats | None, int]: ...
def prove_or_bend(
    checks: CompiledChecks, path: Floats, margin: float, directions: Floats
) -> Floats | None: ...
