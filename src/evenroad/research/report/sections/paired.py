"""Paired comparisons of one question: differences from a reference, samplers down and samples across."""

from __future__ import annotations

from evenroad.research.report.analysis import Analysis
from evenroad.research.report.comparisons import REFERENCES, SIGNIFICANT, Comparison
from evenroad.research.report.runs import Question
from evenroad.research.report.sections.notes import pool_notes
from evenroad.research.report.tables import Entry, Table
from evenroad.research.report.text import difference


def paired_tables(analysis: Analysis, question: Question, name: str) -> tuple[Table, ...]:
    """Return a table a reference that the question has."""
    mine = [each for each in analysis.comparisons if each.cell.question == question]
    tables = []
    for reference in REFERENCES:
        against = [each for each in mine if each.reference == reference]
        if against:
            slug = f"{name}-from-{reference.replace(' ', '-')}"
            tested = sum(each.is_tested for each in mine)
            tables.append(_table(against, reference, slug, str(question), tested))
    return tuple(tables)


def _table(found: list[Comparison], reference: str, name: str, question: str, family: int) -> Table:
    by_place = {(each.cell.sampler, each.cell.n): each for each in found}
    counts = sorted({n for _, n in by_place})
    samplers = list(dict.fromkeys(each.cell.sampler for each in found))
    rows = tuple(
        (Entry(sampler), *(comparison_entry(by_place.get((sampler, n))) for n in counts))
        for sampler in samplers
    )
    tests = sorted({each.test for each in found if each.is_tested})
    return Table(
        name=name,
        title=f"{question}: difference from {reference} [points]",
        header=("sampler", *(f"N = {n}" for n in counts)),
        rows=rows,
        notes=(
            f"On the same runs. Marked: p < {SIGNIFICANT:g} after Holm's correction over the {family} comparisons of"
            f" this question that were tested; {', '.join(tests) or 'none here'}. Intervals are 95 %, each for itself.",
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


def comparison_entry(each: Comparison | None) -> Entry:
    """Write one comparison, marked where the corrected test tells the two apart."""
    if each is None:
        return Entry("–", "faint")
    mark = ("better" if each.difference > 0 else "worse") if each.significant else ""
    return Entry(difference(each.difference, each.interval), mark)
