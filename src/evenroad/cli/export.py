"""``evenroad export``: a store of benchmark results in the formats of other tools."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True, kw_only=True)
class Export:
    """Write benchmark results for OMPL's Planner Arena."""

    store: Annotated[Path, tyro.conf.Positional]
    """The store that ``evenroad bench`` wrote."""
    arena: bool = False
    """As a Planner Arena database."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """The file to write."""

    def run(self) -> int:
        """Export, and say how much."""
        from evenroad.errors import InvalidValue
        from evenroad.research.bench.arena import write_arena

        if not self.arena:
            raise InvalidValue("say in which format: --arena (for CSV and tables: evenroad report)")
        runs = write_arena(self.store, self.out)
        print(f"{self.out}: {runs} runs; open it with: DATABASE={self.out} plannerarena")
        return 0
