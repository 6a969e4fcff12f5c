"""Tables of expected results beside ours, laid out as the paper's Table 1."""

from __future__ import annotations

import math

from evenroad.research.report.expected import ExpectedTable
from evenroad.research.report.tables import Entry, Table
from evenroad.research.report.text import number, percent
from evenroad.research.report.verdicts import LEVEL, Verdict


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
        rows=tuple(_row(by_count, counts) for by_count in rows.values()),
        labels=3,
        notes=(
            f"{table.source}. {table.about}",
            f"{verdict_counts(verdicts)}. Two-sample Fisher tests on the counts at {LEVEL:g}, Holm's correction over"
            " all cells of this table that can be tested; a mark (≠) is a cell that differs."
            " SR in percent; V is the mean number of milestones, ours counted as the source counts.",
            *_notes(verdicts),
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


def _row(by_count: dict[int, Verdict], counts: list[int]) -> tuple[Entry, ...]:
    first = next(iter(by_count.values())).expected
    ours = {each.ours.runs for each in by_count.values() if each.ours is not None}
    runs = f"{first.runs or '?'} / {'–' if not ours else max(ours)}"
    names = (first.problem, first.sampler, first.rule, runs, first.v_definition)
    entries = [Entry(name) for name in names]
    for n in counts:
        entries += _pair(by_count[n]) if n in by_count else [Entry("–", "faint"), Entry("–", "faint")]
    return tuple(entries)


def _pair(each: Verdict) -> list[Entry]:
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


def _notes(verdicts: tuple[Verdict, ...]) -> tuple[str, ...]:
    rows: dict[str, list[str]] = {}
    for each in verdicts:
        row = f"{each.expected.problem} {each.expected.sampler}"
        names = rows.setdefault(each.expected.note, [])
        if each.expected.note and row not in names:
            names.append(row)
    return tuple(f"{', '.join(names)}: {note}." for note, names in rows.items() if note)
