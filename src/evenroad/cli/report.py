"""``evenroad report``: from a store of benchmark rows to one page, figures, tables and CSV."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True, kw_only=True)
class Report:
    """Write report.html, PNG figures, CSV, Markdown and LaTeX tables of a store of benchmark results."""

    store: Annotated[Path, tyro.conf.Positional]
    """The store that ``evenroad bench`` wrote; it may still be writing."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """The folder to write into; made where there is none."""
    only: str = ""
    """Names of problems, with commas between them; default: all in the store."""

    def run(self) -> int:
        """Write the report and print its gist."""
        from evenroad.cli.report_table import print_report
        from evenroad.research.bench.store import rescue_file
        from evenroad.research.report import write_report

        problems = [name.strip() for name in self.only.split(",") if name.strip()]
        print_report(write_report(self.store, self.out, only=problems, command=self._command()))
        if rescue_file(self.store).exists():
            print(f"not in it: the rows in {rescue_file(self.store)}, which the next evenroad bench takes in")
        return 0

    def _command(self) -> str:
        words = ["evenroad", "report", str(self.store), "-o", str(self.out)]
        return shlex.join(words + (["--only", self.only] if self.only else []))
