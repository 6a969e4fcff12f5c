"""Tables of whole suites: expected results beside ours, the fair suite, runs without an answer."""

from __future__ import annotations

import math

from evenroad.research.report.analysis import Failure
from evenroad.research.report.comparisons import SIGNIFICANT
from evenroad.research.report.fair import BY_RULE, REFERENCE, LazyChecks, Pooled
from evenroad.research.report.runs import sampler_place
from evenroad.research.report.tables import Entry, Table, count_range, difference, number, percent
from evenroad.research.report.verdicts import LEVEL, ExpectedTable, Verdict


def expected_table(table: ExpectedTable, verdicts: tuple[Verdict, ...]) -> Table:
    """Return expected and our success rates and numbers of milestones, with a mark where they differ."""
    counts = sorted({each.expected.n for each in verdicts})
    rows: dict[tuple[str, str, str], dict[int, Verdict]] = {}
    for each in verdicts:
        expected = each.expected
        key = (expected.problem, expected.sampler, expected.rule)
        rows.setdefault(key, {})[expected.n] = each
    header = ["problem", "sampler", "connection", "runs", "V is"]
    for n in counts:
        header += [f"SR N = {n}", "V"]
    return Table(
        name=f"expected-{table.name}",
        title=f"{table.title} beside ours: expected / ours",
        header=tuple(header),
        rows=tuple(_expected_row(by_count, counts) for by_count in rows.values()),
        labels=3,
        notes=(
            f"{table.source}. {table.about}",
            f"{verdict_counts(verdicts)}. Two-sample Fisher tests on the counts at {LEVEL:g}, Holm's correction over"
            " all cells of this table that can be tested; a mark (≠) is a cell that differs."
            " SR in percent; V is the mean number of milestones, ours counted as the source counts.",
            *_source_notes(verdicts),
            *_few_sets(verdicts),
        ),
    )


def verdict_counts(verdicts: tuple[Verdict, ...]) -> str:
    """Return how many cells agree, differ and were not run, as a phrase."""
    words = [each.word for each in verdicts]
    return ", ".join(
        f"{words.count(word)} {label}"
        for word, label in (
            ("agrees", "agree"),
            ("differs", "differ"),
            ("no count", "without a count to test"),
            ("not run", "not run"),
        )
        if word in words
    )


def _expected_row(by_count: dict[int, Verdict], counts: list[int]) -> tuple[Entry, ...]:
    first = next(iter(by_count.values())).expected
    ours = {each.ours.runs for each in by_count.values() if each.ours is not None}
    runs = f"{first.runs or '?'} / {'–' if not ours else max(ours)}"
    names = (first.problem, first.sampler, first.rule, runs, first.v_definition)
    entries = [Entry(name) for name in names]
    for n in counts:
        entries += (
            _expected_pair(by_count[n]) if n in by_count else [Entry("–", "faint"), Entry("–", "faint")]
        )
    return tuple(entries)


def _expected_pair(each: Verdict) -> list[Entry]:
    expected = "–" if math.isnan(each.expected.success) else f"{each.expected.success:g}"
    if each.ours is None:
        return [Entry(f"{expected} / –", "faint"), Entry(f"{number(each.expected.v)} / –", "faint")]
    mark = {"differs": "differs", "no count": "faint"}.get(each.word, "")
    return [
        Entry(f"{expected} / {percent(each.ours.rate)}", mark),
        Entry(f"{number(each.expected.v)} / {number(each.our_v)}"),
    ]


def _few_sets(verdicts: tuple[Verdict, ...]) -> tuple[str, ...]:
    rows = dict.fromkeys(
        f"{each.expected.problem} {each.expected.sampler} ({len(each.ours.sets)} sets at N = {each.expected.n})"
        for each in verdicts
        if each.ours is not None and each.ours.units.kind == "sets" and each.word == "differs"
    )
    if not rows:
        return ()
    return (f"{', '.join(rows)}: our runs of one set are not independent, so the mark is set too readily.",)


def _source_notes(verdicts: tuple[Verdict, ...]) -> tuple[str, ...]:
    rows: dict[str, list[str]] = {}
    for each in verdicts:
        row = f"{each.expected.problem} {each.expected.sampler}"
        names = rows.setdefault(each.expected.note, [])
        if each.expected.note and row not in names:
            names.append(row)
    return tuple(f"{', '.join(names)}: {note}." for note, names in rows.items() if note)


def fair_table(grouping: str, found: tuple[Pooled, ...], rules: str) -> Table:
    """Return each sampler's difference from uniform, pooled over random worlds; groups down, samplers across.

    Parameters
    ----------
    grouping : str
        What the groups are.
    found : tuple of Pooled
    rules : str
        The connection rules that are pooled.
    """
    samplers = sorted({each.sampler for each in found}, key=sampler_place)
    groups = list(dict.fromkeys(each.group for each in found))
    by_place = {(each.group, each.sampler): each for each in found}
    rows = []
    for group in groups:
        mine = [by_place[group, sampler] for sampler in samplers if (group, sampler) in by_place]
        widest = max(mine, key=lambda each: each.pairs)
        worlds = count_range(tuple(each.instances for each in mine))
        rows.append(
            (
                Entry(group),
                Entry(worlds),
                Entry(percent(widest.reference_rate)),
                *(_gain_entry(by_place.get((group, sampler))) for sampler in samplers),
            )
        )
    over = "" if grouping == BY_RULE else f", over {rules}"
    return Table(
        name=f"fair-by-{grouping}",
        title=f"Fair suite by {grouping}{over}: difference from {REFERENCE} [points]",
        header=(grouping, "worlds", f"{REFERENCE} [%]", *samplers),
        rows=tuple(rows),
        notes=(
            "Every world, start and goal is random; a sampler is compared with uniform in the same worlds, over those"
            " runs that it has a set for. 95 % intervals and tests are over worlds, or over the sets of a pool where"
            " that is wider; how many sets there were stands behind the interval. From 5 dimensions on it is given the"
            " pool's sets, as coordinates are permuted anew in every run."
            f" Marked: p < {SIGNIFICANT:g} after Holm's correction over this table.",
        ),
    )


def lazy_table(found: tuple[LazyChecks, ...]) -> Table:
    """Return the motions that the lazy search checks, beside those of the search that only connects."""
    rules = ", ".join(dict.fromkeys(each.rule for each in found))
    rows = tuple(
        (
            Entry(each.sampler),
            Entry(str(each.instances)),
            Entry(str(each.pairs)),
            Entry(number(each.connect)),
            Entry(number(each.lazy)),
            Entry(f"{each.lazy / each.connect:.2f} [{each.ratio.low:.2f}, {each.ratio.high:.2f}]"),
        )
        for each in found
    )
    return Table(
        name="fair-lazy",
        title=f"Fair suite, {rules}: motions checked by the lazy search and by connecting",
        header=("sampler", "worlds", "roadmaps", "connect", "lazy", "lazy / connect"),
        rows=rows,
        notes=(
            "Means on the same roadmaps. The lazy search finds the shortest path, checking only what may lie on it;"
            " connecting says only whether there is a path. 95 % intervals resample worlds.",
        ),
    )


def _gain_entry(each: Pooled | None) -> Entry:
    if each is None:
        return Entry("no set", "faint")
    change = each.rate - each.reference_rate
    mark = ("better" if change > 0 else "worse") if each.significant else ""
    sets = f" ({each.sets} sets)" if each.sets else ""
    return Entry(difference(change, each.interval) + sets, mark)


FAILURES_SHOWN = 40


def failure_table(found: tuple[Failure, ...]) -> Table:
    """Return the failures that are alike counted together; the rest beyond 40 kinds as a number."""
    rows = tuple(
        (
            Entry(each.problem),
            Entry(each.sampler),
            Entry(each.rule),
            Entry(each.status),
            Entry(each.message or "–"),
            Entry(str(each.runs)),
        )
        for each in found[:FAILURES_SHOWN]
    )
    rest = found[FAILURES_SHOWN:]
    left_out = (f"{len(rest)} more kinds, {sum(each.runs for each in rest)} runs.",) if rest else ()
    return Table(
        name="failures-by-kind",
        title="Runs that gave no answer",
        header=("problem", "sampler", "rule", "status", "last line of the error", "runs"),
        rows=rows,
        labels=5,
        notes=("They are counted as runs that were not solved.", *left_out),
    )
