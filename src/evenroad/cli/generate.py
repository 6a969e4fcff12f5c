"""``evenroad generate``: a data set of problems with timed, proved paths, for learning."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from evenroad._checks import counted, require_count, require_extra
from evenroad._files import require_writable_folder
from evenroad._terminal import progress_shown
from evenroad.cli.options import Positional
from evenroad.datasets.dask_cluster import dask_workers
from evenroad.datasets.folder import CARD, make_parts, merge, write_card
from evenroad.datasets.part import Format, Request
from evenroad.datasets.queries import sources_of
from evenroad.datasets.workers import interrupt_between_steps, processes
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.loading.load import load_robot


@dataclass(frozen=True, kw_only=True)
class Generate:
    """Make a data set of problems of an arm, with paths that are proved free and timed, for learning.

    A problem is a scene, a start and a goal.  The same command resumes an interrupted run, and makes damaged files
    again.

    Example: evenroad generate shelf boxes --robot ur5 --count 1000 -o problems
    """

    scenes: Positional[tuple[str, ...]]
    """Generators of random scenes (shelf, clutter, tight, boxes, cage), files of scenes, or folders of these; with
    --merge the folders of shards."""
    robot: str = "ur5"
    """The arm: a name or a file."""
    count: float = 10_000
    """Number of problems, such as 1e6."""
    out: Annotated[Path, "-o"]
    """The folder of the set; made if its parent exists."""
    seed: int = 0
    """Seed of everything random; file i depends on it and on i alone."""
    rows: int = 1000
    """Number of problems of a file."""
    per_scene: int = 16
    """Number of problems in a scene."""
    format: Format = "parquet"
    """Kind of the files; each needs the extra of its name."""
    shard: str = "0/1"
    """i/n: make only the files number i, i + n, i + 2 n ..., so that n machines share a set, i from 0 to n - 1."""
    merge: bool = False
    """Gather the files of shards into one set, with a _card.json that describes it."""
    jobs: int | None = None
    """Number of processes (default: one a processor)."""
    scheduler: str | None = None
    """Address of a Dask scheduler whose workers make the files, tcp://host:port (extra [dask])."""

    def run(self) -> int:
        """Make the missing files, and report; return 0 if none is missing now, else 1."""
        self._make_folder()
        if self.merge:
            request = merge([Path(each) for each in self.scenes], self.out)
            made = 0
        else:
            request, shard = self._request(), self._shard()
            if self.jobs is not None and self.scheduler is not None:
                raise InvalidValue("--jobs does not go with --scheduler, whose workers are counted there")
            workers = processes(self.jobs) if self.scheduler is None else dask_workers(self.scheduler)
            with interrupt_between_steps() as check, progress_shown(f"{request.count} problems") as shown_as:

                def report(done: int, parts: int) -> None:
                    check()
                    shown_as(done, parts)

                made = make_parts(request, self.out, shard, workers, report)
        there = write_card(request, self.out)
        whole = there == request.parts
        state = f"complete, {CARD} says what it is" if whole else f"{request.parts - there} are missing"
        print(f"{self.out}: {counted(made, 'file')} made, {there} of {counted(request.parts, 'file')} there; {state}")
        return 0 if whole or self.shard != "0/1" else 1

    def _request(self) -> Request:
        count = int(self.count) if self.count == int(self.count) else self.count
        require_count("count", count)
        for name in ("rows", "per_scene"):
            require_count(name, getattr(self, name))
        require_count("seed", self.seed, 0)
        require_extra(*(("pyarrow", "parquet") if self.format == "parquet" else ("h5py", "hdf5")), "generate")
        load_robot(self.robot)
        sources = sources_of(self.scenes)
        return Request(self.robot, sources, int(count), self.seed, self.rows, self.per_scene, self.format)

    def _shard(self) -> tuple[int, int]:
        found = re.fullmatch(r"(\d+)/(\d+)", self.shard)
        if found is None or not int(found[1]) < int(found[2]):
            raise InvalidValue(f"--shard must be i/n with i from 0 to n - 1, got {shown(self.shard)}")
        return int(found[1]), int(found[2])

    def _make_folder(self) -> None:
        if self.out.exists() and not self.out.is_dir():
            raise BrokenFile(f"cannot write a set into {self.out}: it is not a folder")
        if not self.out.exists():
            require_writable_folder(self.out)
            self.out.mkdir()
