"""Success tables: one a question, samplers down and numbers of samples across."""

from __future__ import annotations

from evenroad.research.bench.samplers import SAMPLERS, why_not
from evenroad.research.problems import PROBLEMS
from evenroad.research.report.analysis import Analysis
from evenroad.research.report.cells import Cell
from evenroad.research.report.runs import Question
from evenroad.research.report.sections.notes import pool_notes
from evenroad.research.report.tables import Entry, Table
from evenroad.research.report.text import count_range, with_interval
from evenroad.research.statistics import FEW_UNITS, UNKNOWN_INTERVAL


def success_table(analysis: Analysis, question: Question, name: str) -> Table:
    """Return the success rates of one question with intervals, and the samples that each sampler needs for 90 %."""
    cells = {(cell.sampler, cell.n): cell for cell in analysis.cells_of(question)}
    counts = sorted({n for _, n in cells})
    reasons: dict[str, list[str]] = {}
    rows = []
    for sampler in analysis.runs.samplers:
        mine = tuple(cells[sampler, n] for n in counts if (sampler, n) in cells)
        entries = [_entry(cells.get((sampler, n)), question, sampler, n, reasons) for n in counts]
        if mine:
            needed = str(analysis.needed[question, sampler])
            rows.append(
                (
                    Entry(sampler),
                    Entry(count_range(tuple(cell.runs for cell in mine))),
                    *entries,
                    Entry(needed),
                )
            )
        elif any(entry.text == "no set" for entry in entries):
            rows.append((Entry(sampler), Entry("0"), *entries, Entry("–", "faint")))
    return Table(
        name=name,
        title=f"{question}: success [%]",
        header=("sampler", "runs", *(f"N = {n}" for n in counts), "N for 90 %"),
        rows=tuple(rows),
        notes=(
            _intervals(tuple(cells.values())),
            *pool_notes(cells.values()),
            *_unsure([row[-1] for row in rows]),
            *_why(reasons),
            *_failures(tuple(cells.values())),
        ),
    )


def _entry(
    cell: Cell | None, question: Question, sampler: str, n: int, reasons: dict[str, list[str]]
) -> Entry:
    if cell is not None:
        failed = f" ({cell.failures} failed)" if cell.failures else ""
        return Entry(with_interval(cell.rate, cell.interval) + failed)
    if question.problem in PROBLEMS and sampler in SAMPLERS:
        reason = why_not(sampler, n, PROBLEMS[question.problem].set_dim)
        if reason:
            reasons.setdefault(sampler, []).append(reason)
            return Entry("no set", "faint")
    return Entry("not run", "faint")


def _intervals(cells: tuple[Cell, ...]) -> str:
    samplers: dict[str, list[str]] = {}
    for cell in cells:
        names = samplers.setdefault(cell.interval.kind, [])
        if cell.sampler not in names:
            names.append(cell.sampler)
    kinds = "; ".join(
        f"{kind} ({', '.join(names)})" if len(samplers) > 1 else kind for kind, names in samplers.items()
    )
    return f"95 % intervals: {kinds}."


def _unsure(needed: list[Entry]) -> tuple[str, ...]:
    if not any(entry.text.endswith(UNKNOWN_INTERVAL) for entry in needed):
        return ()
    return (
        f"{UNKNOWN_INTERVAL}: fewer than {FEW_UNITS} runs, or sets, at some N are too few for an interval.",
    )


def _why(reasons: dict[str, list[str]]) -> tuple[str, ...]:
    return tuple(f"No set: {found[0]}." for found in reasons.values())


def _failures(cells: tuple[Cell, ...]) -> tuple[str, ...]:
    failed = sum(cell.failures for cell in cells)
    return (f"{failed} failed runs are counted as not solved.",) if failed else ()
