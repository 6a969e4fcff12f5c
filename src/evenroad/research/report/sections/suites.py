"""Tables of whole suites: expected results beside ours, the fair suite, runs without an answer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain

from evenroad.research.report.analysis import Failure
from evenroad.research.report.comparisons import SIGNIFICANT
from evenroad.research.report.fair import BY_RULE, REFERENCE, LazyChecks, Pooled
from evenroad.research.report.runs import sampler_place
from evenroad.research.report.tables import (
    NOTHING,
    Entry,
    Row,
    Table,
    change_entry,
    count_range,
    number,
    percent,
    row,
)
from evenroad.research.report.verdicts import LEVEL, ExpectedTable, Verdict


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
            f"{verdict_counts(verdicts)}. Fisher's exact test compares the counts of each cell, at {LEVEL:g} after"
            " Holm's correction over all cells of this table with counts; ≠ marks the cells that differ."
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
