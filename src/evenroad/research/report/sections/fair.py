"""Tables of the fair suite: one a grouping, and the checks of the lazy search."""

from __future__ import annotations

from evenroad.research.report.comparisons import SIGNIFICANT
from evenroad.research.report.fair import REFERENCE, Pooled
from evenroad.research.report.fair_names import BY_RULE
from evenroad.research.report.lazy import LazyChecks
from evenroad.research.report.palette import sampler_place
from evenroad.research.report.tables import Entry, Table
from evenroad.research.report.text import count_range, difference, number, percent


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
                *(_entry(by_place.get((group, sampler))) for sampler in samplers),
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


def _entry(each: Pooled | None) -> Entry:
    if each is None:
        return Entry("no set", "faint")
    change = each.rate - each.reference_rate
    mark = ("better" if change > 0 else "worse") if each.significant else ""
    sets = f" ({each.sets} sets)" if each.sets else ""
    return Entry(difference(change, each.interval) + sets, mark)
