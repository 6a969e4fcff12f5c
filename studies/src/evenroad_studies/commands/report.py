"""``evenroad report`` and ``evenroad export``: a store of benchmark rows as one page, or for OMPL's Planner Arena."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from evenroad._terminal import WIDTH, print_table, table_width
from evenroad.cli.options import Positional
from evenroad_studies import report
from evenroad_studies.bench.arena import write_arena
from evenroad_studies.bench.store import rescue_file
from evenroad_studies.report.analysis import Analysis
from evenroad_studies.report.comparisons import REFERENCES
from evenroad_studies.report.fair import is_fair, pooled_rules
from evenroad_studies.report.runs import Setting
from evenroad_studies.report.sections import verdict_counts
from evenroad_studies.report.streamed import write_cells
from evenroad_studies.report.tables import difference


@dataclass(frozen=True, kw_only=True)
class Report:
    """Write report.html, PNG figures, CSV, Markdown and LaTeX tables of a store of benchmark results.

    Example: evenroad report results.db -o report
    """

    store: Positional[Path]
    """The store that evenroad bench wrote; it may still be writing."""
    out: Annotated[Path, "-o"]
    """The folder to write into; made where there is none."""
    only: str = ""
    """Names of problems, with commas between them; default: all in the store."""
    cells: bool = False
    """Write cells.csv alone: runs, success and interval of each cell, a problem at a time, for stores of any size."""

    def run(self) -> int:
        """Write the report and print its gist."""
        if self.cells:
            table = self.out / "cells.csv"
            self.out.mkdir(parents=True, exist_ok=True)
            print(f"{table}: {write_cells(self.store, table)} runs")
            return 0
        problems = [name.strip() for name in self.only.split(",") if name.strip()]
        words = ["evenroad", "report", str(self.store), "-o", str(self.out)]
        command = shlex.join(words + (["--only", self.only] if self.only else []))
        _print_report(report.write_report(self.store, self.out, only=problems, command=command))
        if rescue_file(self.store).exists():
            print(f"not in it: the rows in {rescue_file(self.store)}, which the next evenroad bench takes in")
        return 0


def _print_report(written: report.Report) -> None:
    """Print how many samples each problem takes, the verdicts, the fair suite in short, and where the page is."""
    analysis = written.analysis
    settings = [setting for setting in analysis.runs.settings if not is_fair(setting)]
    if settings:
        _print_needed(analysis, settings)
    if "all" in analysis.pooled:
        _print_fair(analysis)
    for table, verdicts in analysis.verdicts.values():
        print(f"{table.title}: {verdict_counts(verdicts)}")
    failed = sum(each.runs for each in analysis.failures)
    if failed:
        print(f"{failed} runs gave no answer; they are listed on the page")
    print(f"{written.files[0]} and {len(written.files) - 1} more files")


def _print_needed(analysis: Analysis, settings: list[Setting]) -> None:
    # In a narrow terminal every row stays on its line, and the numbers of runs are left to the page.
    columns = ("runs",) * (table_width() >= WIDTH) + REFERENCES
    rows = []
    for setting in settings:
        needed = [analysis.needed.get((setting, sampler)) for sampler in REFERENCES]
        numbers = ["–" if each is None or not each.has_interval else each.short for each in needed]
        if columns[0] == "runs":
            numbers.insert(0, str(sum(cell.runs for cell in analysis.cells_of(setting))))
        rows.append((setting.problem, setting.rule, *numbers, _fewest(analysis, setting)))
    headings = ("problem", "rule", *(name.replace(" ", "\n") for name in columns), "fewest")
    print_table(rows, headings, "Samples for 90 % success", right=range(2, 2 + len(columns)), gap=1)


def _fewest(analysis: Analysis, setting: Setting) -> str:
    """Name the sampler that needs the fewest samples, of those that have an interval and cells for every N."""
    tried: dict[str, set[int]] = {}
    for cell in analysis.cells_of(setting):
        tried.setdefault(cell.sampler, set()).add(cell.n)
    every = set().union(*tried.values())
    mine = [
        (needed, sampler)
        for (asked, sampler), needed in analysis.needed.items()
        if asked == setting and needed.has_interval and tried[sampler] == every
    ]
    if not mine:
        return "–"
    best = min((needed for needed, _ in mine), key=lambda needed: needed.estimate)
    if best.estimate == float("inf"):
        return "none reached it"
    names = [sampler for needed, sampler in mine if needed.estimate == best.estimate]
    return f"{best.short}: {names[0] if len(names) == 1 else f'{len(names)} samplers'}"


def _print_fair(analysis: Analysis) -> None:
    rows = [
        (each.sampler, str(each.instances), str(each.pairs), difference(each.difference, each.interval))
        for each in analysis.pooled["all"]
    ]
    title = f"Fair suite, {pooled_rules(analysis.runs.settings)}: success minus uniform's [points]"
    print_table(rows, ("sampler", "worlds", "runs", "difference"), title, right=(1, 2, 3))


@dataclass(frozen=True, kw_only=True)
class Export:
    """Write benchmark results for OMPL's Planner Arena (CSV and tables: evenroad report)."""

    store: Positional[Path]
    """The store that evenroad bench wrote."""
    arena: bool = False
    """As a Planner Arena database; the one format there is, so it need not be said."""
    out: Annotated[Path, "-o"]
    """The file to write."""

    def run(self) -> int:
        """Export, and say how much."""
        runs = write_arena(self.store, self.out)
        print(f"{self.out}: {runs} runs; open it with: DATABASE={self.out} plannerarena")
        return 0
