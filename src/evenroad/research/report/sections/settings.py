"""Tables of one setting: success, differences from a reference, spread over the sets of a pool."""

from __future__ import annotations

from collections.abc import Iterable

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
from evenroad.research.statistics import FEW_UNITS, UNKNOWN_INTERVAL, spread_over_sets


def pool_notes(cells: Iterable[Cell]) -> tuple[str, ...]:
    """Return a sentence on the samplers whose runs permute the coordinates of a pool's sets, if there are any."""
    samplers = ", ".join(dict.fromkeys(cell.sampler for cell in cells if cell.pool_given))
    said = "the intervals hold for the sets of the pool; every run permutes the coordinates of one of them."
    return (f"{samplers}: {said}",) if samplers else ()


def success_table(analysis: Analysis, setting: Setting, name: str) -> Table:
    """Return the success rates of one setting, with intervals, and the N at which a sampler reaches 90 %."""
    cells = {(cell.sampler, cell.n): cell for cell in analysis.cells_of(setting)}
    counts = sorted({n for _, n in cells})
    reasons: dict[str, list[str]] = {}
    rows = []
    for sampler in analysis.runs.samplers:
        mine = tuple(cells[sampler, n] for n in counts if (sampler, n) in cells)
        entries = [_success_entry(cells.get((sampler, n)), setting, sampler, n, reasons) for n in counts]
        if mine:
            runs = count_range(tuple(cell.runs for cell in mine))
            rows.append(row(sampler, runs, *entries, str(analysis.needed[setting, sampler])))
        elif any(entry.text == "no set" for entry in entries):
            rows.append(row(sampler, 0, *entries, NOTHING))
    return Table(
        name=name,
        title=f"{setting}: success [%]",
        header=("sampler", "runs", *(f"N = {n}" for n in counts), "N for 90 %"),
        rows=tuple(rows),
        notes=(
            _intervals(tuple(cells.values())),
            *pool_notes(cells.values()),
            *_unsure([each[-1] for each in rows]),
            *_why_no_set(reasons),
            *_failures(tuple(cells.values())),
        ),
    )


def _success_entry(
    cell: Cell | None, setting: Setting, sampler: str, n: int, reasons: dict[str, list[str]]
) -> Entry:
    if cell is not None:
        failed = f" ({cell.failures} failed)" if cell.failures else ""
        return Entry(with_interval(cell.rate, cell.interval) + failed)
    if setting.problem in PROBLEMS and sampler in SAMPLERS:
        reason = why_not(sampler, n, PROBLEMS[setting.problem].set_dim)
        if reason:
            reasons.setdefault(sampler, []).append(reason)
            return Entry("no set", "faint")
    return Entry("not run", "faint")


def _intervals(cells: tuple[Cell, ...]) -> str:
    samplers: dict[str, dict[str, None]] = {}
    for cell in cells:
        samplers.setdefault(cell.interval.kind, {})[cell.sampler] = None
    kinds = "; ".join(
        f"{kind} ({', '.join(names)})" if len(samplers) > 1 else kind for kind, names in samplers.items()
    )
    return f"95 % intervals: {kinds}."


def _unsure(needed: list[Entry]) -> tuple[str, ...]:
    if not any(entry.text.endswith(UNKNOWN_INTERVAL) for entry in needed):
        return ()
    return (f"{UNKNOWN_INTERVAL}: fewer than {FEW_UNITS} runs or sets at some N; too few for an interval.",)


def _why_no_set(reasons: dict[str, list[str]]) -> tuple[str, ...]:
    return tuple(f"No set: {found[0]}." for found in reasons.values())


def _failures(cells: tuple[Cell, ...]) -> tuple[str, ...]:
    failed = sum(cell.failures for cell in cells)
    return (f"{failed} failed runs count as not solved.",) if failed else ()


def paired_tables(analysis: Analysis, setting: Setting, name: str) -> tuple[Table, ...]:
    """Return a table of differences for each reference sampler that the setting has."""
    mine = [each for each in analysis.comparisons if each.cell.setting == setting]
    tables = []
    for reference in REFERENCES:
        against = [each for each in mine if each.reference == reference]
        if against:
            slug = f"{name}-from-{reference.replace(' ', '-')}"
            tested = sum(each.is_tested for each in mine)
            tables.append(_paired_table(against, reference, slug, str(setting), tested))
    return tuple(tables)


def _paired_table(found: list[Comparison], reference: str, name: str, setting: str, family: int) -> Table:
    by_place = {(each.cell.sampler, each.cell.n): each for each in found}
    counts = sorted({n for _, n in by_place})
    samplers = list(dict.fromkeys(each.cell.sampler for each in found))
    rows = tuple(
        row(sampler, *(_comparison_entry(by_place.get((sampler, n))) for n in counts)) for sampler in samplers
    )
    tests = sorted({each.test for each in found if each.is_tested})
    return Table(
        name=name,
        title=f"{setting}: difference from {reference} [points]",
        header=("sampler", *(f"N = {n}" for n in counts)),
        rows=rows,
        notes=(
            f"Over the same runs. Marked: p < {SIGNIFICANT:g} after Holm's correction over the {family} comparisons of"
            f" this setting that were tested; {', '.join(tests) or 'none here'}. Intervals: 95 %, not corrected.",
            *_untested(found),
            *pool_notes(each.cell for each in found),
        ),
    )


def _untested(found: list[Comparison]) -> tuple[str, ...]:
    counts: dict[tuple[str, str], list[str]] = {}
    for each in found:
        if not each.is_tested:
            counts.setdefault((each.test, each.cell.sampler), []).append(str(each.cell.n))
    return tuple(f"{sampler}, N = {', '.join(counts[test, sampler])}: {test}." for test, sampler in counts)


def _comparison_entry(each: Comparison | None) -> Entry:
    return NOTHING if each is None else change_entry(each.difference, each.interval, each.significant)


def spread_table(analysis: Analysis, setting: Setting, name: str) -> Table | None:
    """Return the spread of success over the sets of each pool; None where no set was drawn twice."""
    rows = []
    for cell in analysis.cells_of(setting):
        if len(cell.sets) < 2 or cell.sets.runs.max() < 2:
            continue
        spread = spread_over_sets(cell.sets.solved, cell.sets.runs)
        shares = (spread.mean, spread.lowest, spread.highest, spread.sd, spread.sd_by_chance)
        rows.append(row(cell.sampler, cell.n, spread.sets, cell.runs, *map(percent, shares)))
    if not rows:
        return None
    return Table(
        name=name,
        title=f"{setting}: success of single sets [%]",
        header=("family", "N", "sets", "runs", "mean", "lowest", "highest", "sd", "sd by chance"),
        rows=tuple(rows),
        notes=(
            "sd by chance: what equally good sets would show with so few runs each. A larger sd means that some sets"
            " suit this problem better than others.",
        ),
    )
