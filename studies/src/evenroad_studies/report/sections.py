"""Tables of a report: of one setting, of whole suites, of runs without an answer."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import chain

from evenroad_studies.bench.samplers import SAMPLERS, why_not
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.report.analysis import VERDICT_LEVEL, Analysis, ExpectedTable, Failure, Verdict
from evenroad_studies.report.cells import Cell
from evenroad_studies.report.comparisons import REFERENCES, SIGNIFICANT, Comparison
from evenroad_studies.report.fair import BY_RULE, REFERENCE, LazyChecks, Pooled
from evenroad_studies.report.runs import Setting, sampler_place
from evenroad_studies.report.tables import (
    NOTHING,
    Entry,
    Row,
    Table,
    change_entry,
    count_range,
    number,
    percent,
    row,
    with_interval,
)
from evenroad_studies.statistics.resampling import UNKNOWN_INTERVAL
from evenroad_studies.statistics.units import FEW_UNITS, spread_over_sets


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
        few = f"fewer than {FEW_UNITS} runs or sets at some N; too few for an interval."
        notes.append(f"{UNKNOWN_INTERVAL}: {few}")
    notes += [f"No set: {reason}." for reason in reasons.values()]
    if failed := sum(cell.failures for cell in cells.values()):
        notes.append(f"{failed} failed runs count as not solved.")
    header = ("sampler", "runs", *(f"N = {n}" for n in counts), "N for 90 %")
    return Table(name, f"{setting}: success [%]", header, rows, notes=notes)


def _success_entry(cell: Cell | None, setting: Setting, sampler: str, n: int, why: dict[str, str]) -> Entry:
    """Return what stands in the table; why a sampler has no set is kept in `why`."""
    if cell is not None:
        failed = f" ({cell.failures} failed)" if cell.failures else ""
        return Entry(with_interval(cell.rate, cell.interval) + failed)
    if setting.problem in PROBLEMS and sampler in SAMPLERS:
        reason = why_not(sampler, n, PROBLEMS[setting.problem].set_dim)
        if reason:
            why.setdefault(sampler, reason)
            return Entry("no set", "faint")
    return Entry("not run", "faint")


def _interval_note(cells: Iterable[Cell]) -> str:
    samplers: dict[str, dict[str, None]] = {}
    for cell in cells:
        samplers.setdefault(cell.interval.kind, {})[cell.sampler] = None
    several = [f"{kind} ({', '.join(names)})" for kind, names in samplers.items()]
    return f"95 % intervals: {'; '.join(several if len(several) > 1 else samplers)}."


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
        rows=[row(sampler, *(_comparison_entry(by_place.get((sampler, n))) for n in counts)) for sampler in samplers],
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


def expected_table(table: ExpectedTable, verdicts: Sequence[Verdict]) -> Table:
    """Return the table of expected and our success rates and numbers of milestones; marked where they differ."""
    counts = sorted({each.expected.n for each in verdicts})
    rows: dict[tuple[str, str, str], dict[int, Verdict]] = {}
    for each in verdicts:
        expected = each.expected
        rows.setdefault((expected.problem, expected.sampler, expected.rule), {})[expected.n] = each
    pairs = ((f"SR N = {n}", "V") for n in counts)
    return Table(
        name=f"expected-{table.name}",
        title=f"{table.title} beside ours: expected / ours",
        header=("problem", "sampler", "connection", "runs", "V is", *chain(*pairs)),
        rows=[_expected_row(by_count, counts) for by_count in rows.values()],
        labels=3,
        notes=(
            f"{table.source}. {table.about}",
            f"{verdict_counts(verdicts)}. Fisher's exact test compares the counts of each cell, at {VERDICT_LEVEL:g}"
            " after Holm's correction over all cells of this table with counts; ≠ marks the cells that differ."
            " SR: success rate in percent. V: mean number of milestones, ours counted as the source counts.",
            *_source_notes(verdicts),
            *_few_sets(verdicts),
        ),
    )


def verdict_counts(verdicts: Sequence[Verdict]) -> str:
    """Say how many cells agree, differ, have no count and were not run."""
    labels = {
        "agrees": "agree",
        "differs": "differ",
        "no count": "without a count to test",
        "not run": "not run",
    }
    words = [each.word for each in verdicts]
    return ", ".join(f"{words.count(word)} {label}" for word, label in labels.items() if word in words)


def _expected_row(by_count: dict[int, Verdict], counts: Sequence[int]) -> Row:
    first = next(iter(by_count.values())).expected
    ours = max((each.ours.runs for each in by_count.values() if each.ours is not None), default="–")
    pairs = [_expected_pair(by_count[n]) if n in by_count else (NOTHING, NOTHING) for n in counts]
    named = (first.problem, first.sampler, first.rule, f"{first.runs or '?'} / {ours}", first.v_definition)
    return row(*named, *chain(*pairs))


def _expected_pair(each: Verdict) -> tuple[Entry, Entry]:
    expected = "–" if math.isnan(each.expected.success) else f"{each.expected.success:g}"
    v = number(each.expected.v)
    if each.ours is None:
        return Entry(f"{expected} / –", "faint"), Entry(f"{v} / –", "faint")
    mark = {"differs": "differs", "no count": "faint"}.get(each.word, "")
    return Entry(f"{expected} / {percent(each.ours.rate)}", mark), Entry(f"{v} / {number(each.our_v)}")


def _few_sets(verdicts: Sequence[Verdict]) -> list[str]:
    rows = dict.fromkeys(
        f"{each.expected.problem} {each.expected.sampler} ({len(each.ours.sets)} sets at N = {each.expected.n})"
        for each in verdicts
        if each.ours is not None and each.ours.units.kind == "sets" and each.word == "differs"
    )
    said = "our runs share these sets and are not independent; the test marks too readily."
    return [f"{', '.join(rows)}: {said}"] if rows else []


def _source_notes(verdicts: Sequence[Verdict]) -> list[str]:
    names: dict[str, dict[str, None]] = {}
    for expected in (each.expected for each in verdicts):
        names.setdefault(expected.note, {})[f"{expected.problem} {expected.sampler}"] = None
    return [f"{', '.join(rows)}: {note}." for note, rows in names.items() if note]


def fair_table(grouping: str, found: Sequence[Pooled], rules: str) -> Table:
    """Return the differences from uniform, pooled over random worlds and over connection `rules`.

    A row is a group (a generator, a dimension, ... as `grouping` says), a column a sampler.
    """
    samplers = sorted({each.sampler for each in found}, key=sampler_place)
    by_place = {(each.group, each.sampler): each for each in found}
    rows = []
    for group in dict.fromkeys(each.group for each in found):
        mine = [by_place[group, sampler] for sampler in samplers if (group, sampler) in by_place]
        widest = max(mine, key=lambda each: each.pairs)
        worlds = count_range([each.instances for each in mine])
        gains = [_gain_entry(by_place.get((group, sampler))) for sampler in samplers]
        rows.append(row(group, worlds, percent(widest.reference_rate), *gains))
    over = "" if grouping == BY_RULE else f", over {rules}"
    return Table(
        name=f"fair-by-{grouping}",
        title=f"Fair suite by {grouping}{over}: difference from {REFERENCE} [points]",
        header=(grouping, "worlds", f"{REFERENCE} [%]", *samplers),
        rows=rows,
        notes=(
            "Every world, start and goal is random. A sampler is compared with uniform in the same worlds, over the"
            " runs that it has a set for. Intervals (95 %) and tests are over worlds; for a pool of sets in fewer than"
            " 5 dimensions they are over its sets where that is wider. The number of sets stands behind the interval."
            " From 5 dimensions on every run permutes the coordinates of a set, and the interval holds for the sets of"
            f" the pool. Marked: p < {SIGNIFICANT:g} after Holm's correction over this table.",
        ),
    )


def _gain_entry(each: Pooled | None) -> Entry:
    if each is None:
        return Entry("no set", "faint")
    sets = f" ({each.sets} sets)" if each.sets else ""
    return change_entry(each.difference, each.interval, each.significant, after=sets)


def lazy_table(found: Sequence[LazyChecks]) -> Table:
    """Return the numbers of motions that the lazy search and the connecting search check."""
    rules = ", ".join(dict.fromkeys(each.rule for each in found))
    rows = [
        row(
            *(each.sampler, each.instances, each.pairs, number(each.connect), number(each.lazy)),
            f"{each.lazy / each.connect:.2f} [{each.ratio.low:.2f}, {each.ratio.high:.2f}]",
        )
        for each in found
    ]
    return Table(
        name="fair-lazy",
        title=f"Fair suite, {rules}: motions checked by the lazy search and by connecting",
        header=("sampler", "worlds", "roadmaps", "connect", "lazy", "lazy / connect"),
        rows=rows,
        notes=(
            "Means over the same roadmaps. The lazy search finds the shortest path and checks only motions that may"
            " lie on it; connecting only finds out whether there is a path. Intervals (95 %) resample worlds.",
        ),
    )


FAILURES_SHOWN = 40


def failure_table(found: Sequence[Failure]) -> Table:
    """Return the kinds of failures with their numbers of runs; beyond 40 kinds only how many more there are."""
    shown, rest = found[:FAILURES_SHOWN], found[FAILURES_SHOWN:]
    left_out = (f"{len(rest)} more kinds, {sum(each.runs for each in rest)} runs.",) if rest else ()
    return Table(
        name="failures-by-kind",
        title="Runs that gave no answer",
        header=("problem", "sampler", "rule", "status", "last line of the error", "runs"),
        rows=[row(*each._replace(message=each.message or "–")) for each in shown],
        labels=5,
        notes=("These runs count as not solved.", *left_out),
    )
