"""``evenroad points``: a point set of any sampler, n and d as a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from evenroad._checks import require_known
from evenroad._files import require_writable_folder
from evenroad.cli.sampler import SamplerOptions, draw_points
from evenroad.errors import shown
from evenroad.points.npz import write_points


@dataclass(frozen=True, kw_only=True)
class Points(SamplerOptions):
    """Write points that fill the unit cube evenly, as samples for a planner such as PRM.

    Example: evenroad points -n 512 -d 6 -o set.npy
    """

    n: Annotated[int, "-n"]
    """Number of points."""
    d: Annotated[int, "-d"]
    """Number of coordinates of each point, such as the joints of an arm."""
    out: Annotated[Path, "-o"]
    """The file to write: .npy and .csv hold the array, .npz also says how it was made."""

    def run(self) -> int:
        """Find or make the set, and write it."""
        kind = f"kind of file {shown(str(self.out))}: suffix"
        require_known(kind, self.out.suffix, (".npz", ".npy", ".csv"))
        require_writable_folder(self.out)
        points = draw_points(self, self.n, self.d)
        write_points(points, self.out)
        print(f"{self.out}: {points.n} points in d={points.d}, {points.origin}, hash {points.hash[:12]}")
        return 0
