"""``evenroad export``: a store of benchmark results as a Planner Arena database."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from evenroad.research.bench.arena import write_arena


@dataclass(frozen=True, kw_only=True)
class Export:
    """Write benchmark results for OMPL's Planner Arena (CSV and tables: evenroad report)."""

    store: tyro.conf.Positional[Path]
    """The store that ``evenroad bench`` wrote."""
    arena: bool = False
    """As a Planner Arena database; the one format there is, so it need not be said."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """The file to write."""

    def run(self) -> int:
        """Export, and say how much."""
        runs = write_arena(self.store, self.out)
        print(f"{self.out}: {runs} runs; open it with: DATABASE={self.out} plannerarena")
        return 0
