from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints, Ints32

States: TypeAlias = npt.NDArray[np.int8]

class Graph:
    """Undirected edges by node: fixed ones, and links of one query beside them.  It never changes."""

    def __init__(self, nodes: int, edges: Ints32) -> None: ...
    @property
    def nodes(self) -> int: ...
    def with_links(self, nodes: int, links: Ints32, numbered_from: int) -> Graph: ...

def shortest_path(
    graph: Graph, costs: tuple[Ints, Ints], states: tuple[States, States], start: int, goals: Ints
) -> tuple[Ints32, Ints32]: ...
def best_offers(graph: Graph, node: int, weights: Ints, cost: Ints, stage: States) -> tuple[Ints32, Ints32]: ...
def join(label: Ints32, edges: Ints32) -> None: ...
def grow(
    edges: Ints32,
    states: tuple[States, States],
    trees: tuple[States, Ints32, Floats],
    asked: Ints32,
    most: int,
) -> tuple[int, Ints32, Ints32]: ...
def k_nearest(points: Floats, period: Floats, k: int, earlier: bool) -> Ints32: ...
def pairs_within(points: Floats, period: Floats, radius: float) -> Ints32: ...
def distances_from(points: Floats, period: Floats, point: Floats) -> Floats: ...
def k_smallest(distances: Floats, usable: Bools, k: int, radius: float) -> Ints32: ...
def spread_order(
    set: tuple[Floats, Floats],
    preference: Floats,
    count: int,
    seen: tuple[Ints, Ints],
    serving: tuple[float, float],
) -> Ints: ...
