"""What a plan says of its search: the searched graph, and stages with their costs over time."""

from __future__ import annotations

from dataclasses import dataclass, field

from evenroad._arrays import Floats, Ints32


@dataclass(frozen=True, eq=False)
class SearchedGraph:
    """The milestones and motions known to be free in one query, for pictures.

    `configurations`, (v, dim), are `milestones` ones not known to be invalid, then the start, then the goals; `edges`,
    (m, 2), are free motions, as pairs of rows, smaller first.
    """

    configurations: Floats
    edges: Ints32
    milestones: int


@dataclass(frozen=True)
class Stage:
    """One stage of a plan that grows, or a round of one that improves in which a better path was found.

    `points` is the number of points so far, and `valid` the number of valid ones; in a round these are the nodes of all
    trees.  `edges_checked` motions were checked up to its end, `seconds` after the query began (not compared).  `cost`
    is that of the stage's path along the roadmap, or of a round's path after shortcutting; None without a path.
    """

    points: int
    valid: int
    edges_checked: int
    cost: float | None
    seconds: float = field(default=0.0, compare=False)
