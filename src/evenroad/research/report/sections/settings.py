"""Tables of one setting: success, differences from a reference, spread over the sets of a pool."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from evenroad.research.bench.samplers import SAMPLERS, why_not
from evenroad.research.problems import PROBLEMS
from evenroad.research.report.analysis import Analysis
from evenroad.research.report.cells import Cell
from evenroad.research.report.comparisons import REFERENCES, SIGNIFICANT, Comparison
from evenroad.research.report.runs import Setting
from evenroad.research.report.tables import (
    NOTHING,
    Entry,
    Table,
    change_entry,
    count_range,
    percent,
    row,
    with_interval,
)
from evenroad.research.statistics.resampling import UNKNOWN_INTERVAL
from evenroad.research.statistics.units import FEW_UNITS, spread_over_sets


def pool_notes(cells: Iterable[Cell]) -> tuple[str, ...]:
    """Return a sentence on the samplers whose runs permute the coordinates of a pool's sets, if there are any."""
    samplers = ", ".join(dict.fromkeys(cell.sampler for cell in cells if cell.pool_given))
    said = "the intervals hold for the sets of the pool; every run permutes the coordinates of one of them."
    return (f"{samplers}: {said}",) if samplers else ()


def success_table(analysis: Analysis, setting: Setting, name: str) -> Table:
    """Return the success rates of one setting, with intervals, and the N at which a sampler reaches 90 %."""
    cells = {(cell.sampler, cell.n): cell for cell in analysis.cells_of(setting)}
    counts = sorted({n for _, n in cells})
    reasons: dict[str, str] = {}
    rows = []
    for sampler in analysis.runs.samplers:
        mine = [cells[sampler, n] for n in counts if (sampler, n) in cells]
        entries = [_success_entry(cells.get((sampler, n)), setting, sampler, n, reasons) for n in counts]
        if mine:
            runs = count_range([cell.runs for cell in mine])
            rows.append(row(sampler, runs, *entries, str(analysis.needed[setting, sampler])))
        elif any(entry.text == "no set" for entry in entries):
            rows.append(row(sampler, 0, *entries, NOTHING))
    notes = [_interval_note(cells.values()), *pool_notes(cells.values())]
    if any(each[-1].text.endswith(UNKNOWN_INTERVAL) for each in rows):
        notes.append(
            f"{UNKNOWN_INTERVAL}: fewer than {FEW_UNITS} runs or sets at some N; too few for an interval."
        )
    notes += [f"No set: {reason}." for reason in reasons.values()]
    if failed := sum(cell.failures for cell in cells.values()):
        notes.append(f"{failed} failed runs count as not solved.")
    header = ("sampler", "runs", *(f"N = {n}" for n in counts), "N for 90 %")
    return Table(name, f"{setting}: success [%]", header, rows, notes=notes)


def _success_entry(
    cell: Cell | None, setting: Setting, sampler: str, n: int, reasons: dict[str, str]
) -> Entry:
    """Return what stands in the table; why a sampler has no set is kept in `reasons`."""
    if cell is not None:
        failed = f" ({cell.failures} failed)" if cell.failures else ""
        return Entry(with_interval(cell.rate, cell.interval) + failed)
    if setting.problem in PROBLEMS and sampler in SAMPLERS:
        reason = why_not(sampler, n, PROBLEMS[setting.problem].set_dim)
        if reason:
            reasons.setdefault(sampler, reason)
            return Entry("no set", "faint")
    return Entry("not run", "faint")


def _interval_note(cells: Iterable[Cell]) -> str:
    samplers: dict[str, dict[str, None]] = {}
    for cell in cells:
        samplers.setdefault(cell.interval.kind, {})[cell.sampler] = None
    kinds = "; ".join(
        f"{kind} ({', '.join(names)})" if len(samplers) > 1 else kind for kind, names in samplers.items()
    )
    return f"95 % intervals: {kinds}."


def paired_tables(analysis: Analysis, setting: Setting, name: str) -> tuple[Table, ...]:
    """Return a table of differences for each reference sampler that the setting has."""
    mine = [each for each in analysis.comparisons if each.cell.setting == setting]
    tested = sum(each.is_tested for each in mine)
    against = {reference: [each for each in mine if each.reference == reference] for reference in REFERENCES}
    return tuple(
        _paired_table(found, reference, f"{name}-from-{reference.replace(' ', '-')}", str(setting), tested)
        for reference, found in against.items()
        if found
    )


def _paired_table(found: Sequence[Comparison], reference: str, name: str, setting: str, family: int) -> Table:
    by_place = {(each.cell.sampler, each.cell.n): each for each in found}
    counts = sorted({n for _, n in by_place})
    samplers = dict.fromkeys(each.cell.sampler for each in found)
    tests = sorted({each.test for each in found if each.is_tested})
    return Table(
        name=name,
        title=f"{setting}: difference from {reference} [points]",
        header=("sampler", *(f"N = {n}" for n in counts)),
        rows=[
            row(sampler, *(_comparison_entry(by_place.get((sampler, n))) for n in counts))
            for sampler in samplers
        ],
        notes=(
            f"Over the same runs. Marked: p < {SIGNIFICANT:g} after Holm's correction over the {family} comparisons of"
            f" this setting that were tested; {', '.join(tests) or 'none here'}. Intervals: 95 %, not corrected.",
            *_untested(found),
            *pool_notes(each.cell for each in found),
        ),
    )


def _untested(found: Iterable[Comparison]) -> list[str]:
    counts: dict[tuple[str, str], list[str]] = {}
    for each in found:
        if not each.is_tested:
            counts.setdefault((each.test, each.cell.sampler), []).append(str(each.cell.n))
    return [f"{sampler}, N = {', '.join(ns)}: {test}." for (test, sampler), ns in counts.items()]


def _comparison_entry(each: Comparison | None) -> Entry:
    return NOTHING if each is None else change_entry(each.difference, each.interval, each.significant)


def spread_table(analysis: Analysis, setting: Setting, name: str) -> Table | None:
    """Return the spread of success over the sets of each pool; None where no set was drawn twice."""
    rows = []
    for cell in analysis.cells_of(setting):
        if len(cell.sets) >= 2 and cell.sets.runs.max() >= 2:
            spread = spread_over_sets(cell.sets.solved, cell.sets.runs)
            rows.append(row(cell.sampler, cell.n, len(cell.sets), cell.runs, *map(percent, spread)))
    if not rows:
        return None
    return Table(
        name=name,
        title=f"{setting}: success of single sets [%]",
        header=("family", "N", "sets", "runs", "mean", "lowest", "highest", "sd", "sd by chance"),
        rows=rows,
        notes=(
            "sd by chance: what equally good sets would show with so few runs each. A larger sd means that some sets"
            " suit this problem better than others.",
        ),
    )
