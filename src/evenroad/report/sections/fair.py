"""Tables of the fair suite, one a grouping."""

from __future__ import annotations

from evenroad.report.comparisons import SIGNIFICANT
from evenroad.report.fair import REFERENCE, Pooled
from evenroad.report.palette import sampler_place
from evenroad.report.tables import Entry, Table
from evenroad.report.text import count_range, difference, percent


def fair_table(grouping: str, found: tuple[Pooled, ...]) -> Table:
    """Return each sampler's difference from uniform, pooled over random worlds; groups down, samplers across."""
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
                *(_entry(by_place.get((group, sampler))) for sampler in samplers),
            )
        )
    return Table(
        name=f"fair-by-{grouping}",
        title=f"Fair suite by {grouping}: difference from {REFERENCE} [points]",
        header=(grouping, "worlds", f"{REFERENCE} [%]", *samplers),
        rows=tuple(rows),
        notes=(
            "Every world, start and goal is random; a sampler is compared with uniform in the same worlds, over those"
            " runs that it has a set for. 95 % intervals and tests resample worlds."
            f" Marked: p < {SIGNIFICANT:g} after Holm's correction over this table.",
        ),
    )


def _entry(each: Pooled | None) -> Entry:
    if each is None:
        return Entry("no set", "faint")
    change = each.rate - each.reference_rate
    mark = ("better" if change > 0 else "worse") if each.significant else ""
    return Entry(difference(change, each.interval), mark)
