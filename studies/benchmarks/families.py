"""Both families of random worlds side by side: what `even` solves more than other samplers, and every loss.

    evenroad bench fair --store fair.db
    evenroad bench apart --store apart.db
    python -m studies.benchmarks.families fair.db apart.db
    python -m studies.benchmarks.families --candidates studies/docs/data/which_points.csv --fresh FRESH.csv
    python -m studies.benchmarks.families --cells studies/docs/data/which_points_now.csv

The stores may be parts of a suite; a row says of how many worlds it is.  Differences are in percentage points, paired
by world, with the standard error over worlds; k is the number of neighbours of the rule, and "all" the mean over k.

`--candidates` reads rows of ``points_apart --use reporting``.  In each dimension, with each k and linked as a plan
links, it names the best set there and how far it is ahead of `even`.  A best set of many is ahead by luck as well, so
`--fresh` has the same sets in other worlds: the table is of all worlds together, and the list after it says what became
there of sets that were best in the first worlds.

`--cells` reads such rows, too, and has a line for each family or kind of worlds, dimension and number of points: the
success of `even` and how much more the others solve, with the default number of neighbours.  Rows of different worlds
are pooled.
"""

from __future__ import annotations

import csv
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of

from evenroad._arrays import Floats
from evenroad_studies.bench.rows import Rows, joined
from evenroad_studies.bench.store import read_rows
from evenroad_studies.report.fair import parts_of

KS = (4, 6, 10, 20)
BESIDE = ("sobol scrambled", "lattice", "halton scrambled", "hickernell", "mpmc", "uniform")
BARS = (6, 10, 20)
"""Numbers of neighbours for which `even` is to be the best set or within one standard error of it."""
SPANS = ((2, 4), (5, 10))
"""Dimensions over which kinds of worlds are pooled."""
World = tuple[str, int]
Differences = Mapping[World, Sequence[float]]
"""World -> difference from `even`, for each k."""


def solved_by_world(rows: Rows, sampler: str) -> dict[World, dict[tuple[int, int, int], bool]]:
    """Return for each random world which of its (k, n, run) a sampler solved, by connecting."""
    here = rows.where(rows.sampler.is_in([sampler]) & rows.search.is_in(["connect"]))
    found: dict[World, dict[tuple[int, int, int], bool]] = defaultdict(dict)
    columns = zip(here.instance.tolist(), here.n.tolist(), here.run.tolist(), here.solved.tolist(), strict=True)
    for row, (instance, n, run, solved) in enumerate(columns):
        k = int(here.rule[row].removeprefix("k=").split()[0])
        found[here.problem[row], instance][k, n, run] = solved
    return found


def differences(rows: Rows, sampler: str) -> dict[World, list[float]]:
    """Return by how much `even` solves more of the runs that both have, in points, for each world and k."""
    ours, theirs = solved_by_world(rows, "even"), solved_by_world(rows, sampler)
    gains: dict[World, list[float]] = {}
    for world in ours.keys() & theirs.keys():
        both = ours[world].keys() & theirs[world].keys()
        of_k: dict[int, list[float]] = {k: [] for k in KS}
        for at in both:
            of_k[at[0]].append(100.0 * (ours[world][at] - theirs[world][at]))
        if all(of_k.values()):
            gains[world] = [float(np.mean(of_k[k])) for k in KS]
    return gains


def group_of(problem: str) -> str:
    """Return what a problem is pooled with: family and dimension, or its kind where that has one dimension."""
    kind, dimension, _ = parts_of(problem.removeprefix("apart-"))
    family = "apart" if problem.startswith("apart-") else "fair"
    return f"{family}, d = {dimension.removesuffix('d')}" if dimension != kind else kind


def kind_of(problem: str) -> str:
    """Return the kind of a problem's worlds, with its dimension."""
    kind, dimension, _ = parts_of(problem.removeprefix("apart-"))
    return kind if dimension == kind else f"{kind}, d = {dimension.removesuffix('d')}"


def with_errors(values: Floats) -> list[str]:
    """Return the means of columns of worlds with their standard errors, and of their mean; as texts of a table."""
    every = np.column_stack([values, values.mean(axis=1)])
    errors = every.std(axis=0, ddof=1) / np.sqrt(len(every))
    return [f"{mean:+.1f} ({error:.1f})" for mean, error in zip(every.mean(axis=0), errors, strict=True)]


def pooled(gains: Differences, by: Mapping[World, str]) -> dict[str, Floats]:
    """Return the differences of each group, (worlds, ks), of groups with two worlds or more."""
    groups: dict[str, list[Sequence[float]]] = defaultdict(list)
    for world in sorted(gains):
        groups[by[world]].append(gains[world])
    return {name: np.array(rows) for name, rows in groups.items() if len(rows) > 1}


def line(*cells: object) -> None:
    """Print a row of a table."""
    print("|", " | ".join(map(str, cells)), "|")


def print_gains(rows: Rows) -> None:
    """Print a table with a row for each sampler and group, and then the losses of single kinds of worlds."""
    losses, cells = [], 0
    line("`even` minus", "worlds", "of them", *(f"k = {k}" for k in KS), "all")
    line(":--", ":--", "--:", *["--:"] * 5)
    for sampler in BESIDE:
        gains = differences(rows, sampler)
        groups = pooled(gains, {world: group_of(world[0]) for world in gains})
        for name, values in sorted(groups.items(), key=lambda item: order(item[0])):
            line(sampler, name, len(values), *with_errors(values))
        kinds = pooled(gains, {world: kind_of(world[0]) for world in gains})
        for name, values in kinds.items():
            errors = values.std(axis=0, ddof=1) / np.sqrt(len(values))
            for k, mean, error in zip(KS, values.mean(axis=0), errors, strict=True):
                cells += 1
                if mean < -error < 0.0:
                    losses.append((mean / error, sampler, name, k, f"{mean:+.1f} ({error:.1f})"))
    print(f"\n{len(losses)} of {cells} differences by kind of world and k are below 0 by more than one standard error;")
    print(f"{0.159 * cells:.0f} would be if the sets were equal.  All of two errors or more, the largest first:\n")
    for share, sampler, name, k, text in sorted(losses):
        if share <= -2.0:
            print(f"* {name}, k = {k}: {text} behind {sampler}")


def order(group: str) -> tuple[bool, bool, int, str]:
    """Return the place of a group: families by dimension, then the others."""
    family, _, d = group.partition(", d = ")
    return (not d, family != "apart", int(d or 0), family)


Sets = Mapping[str, list[dict[str, str]]]
"""Name of a set -> its rows over all kinds of worlds, one for each run of ``points_apart``."""


def candidates(paths: Sequence[Path]) -> dict[tuple[str, int], Sets]:
    """Return the rows over all kinds of worlds: (family, dimension) -> sets."""
    found: dict[tuple[str, int], dict[str, list[dict[str, str]]]] = defaultdict(lambda: defaultdict(list))
    for row in reported(paths):
        if row["kind"] == "all":
            found[row["family"], int(row["d"])][row["set"]].append(row)
    return dict(found)


def reported(paths: Sequence[Path]) -> list[dict[str, str]]:
    """Return the rows of CSVs that are of reporting worlds."""
    rows: list[dict[str, str]] = []
    for path in paths:
        with path.open(newline="") as file:
            rows += [row for row in csv.DictReader(file) if row["use"] == "reporting"]
    return rows


def print_kinds(rows: Sequence[Mapping[str, str]]) -> None:
    """Print what `even` solves more than scrambled Sobol points in each kind of world, over dimensions."""
    line("`even` minus Sobol", *(f"d = {low} to {high}, k = {k}" for low, high in SPANS for k in KS))
    line(":--", *["--:"] * len(SPANS) * len(KS))
    for kind in dict.fromkeys(row["kind"] for row in rows if row["kind"] != "all"):
        of_kind = [row for row in rows if row["kind"] == kind and row["set"] == "sobol"]
        spans = [[row for row in of_kind if low <= int(row["d"]) <= high] for low, high in SPANS]
        line(kind, *(gap_text(span, f"plan {k}", -1.0) for span in spans for k in KS))
    print()


def print_beside(sets: Mapping[tuple[str, int], Sets]) -> None:
    """Print what `even` solves more than each other set in both families, over all worlds, linked as a plan links."""
    line("`even` minus", "d", *(f"{family}, k = {k}" for family in ("apart", "fair") for k in BARS))
    line(":--", "--:", *["--:"] * 2 * len(BARS))
    names = dict.fromkeys(name for each in sets.values() for name in each if name != "even")
    for name in names:
        for d in sorted({d for _, d in sets}):
            cells = [
                gap_text(sets.get((family, d), {}).get(name, []), f"plan {k}", -1.0)
                for family in ("apart", "fair")
                for k in BARS
            ]
            if set(cells) != {"–"}:
                line(f"`{name}`", d, *cells)
    print()


def gap_text(rows: Sequence[Mapping[str, str]], column: str, sign: float = 1.0) -> str:
    """Return by how much a set is ahead of `even`, with its error; a dash without rows."""
    if not rows:
        return "–"
    mean, error = over_all(rows, column)
    return f"{sign * mean + 0.0:+.1f} ({error:.1f})"


def print_best(here: Mapping[tuple[str, int], Sets], there: Mapping[tuple[str, int], Sets]) -> None:
    """Print in each family, dimension and k the best set and how far it is ahead of `even`; then, what luck does."""
    both = {
        at: {name: rows + there.get(at, {}).get(name, []) for name, rows in sets.items()} for at, sets in here.items()
    }
    line("d", *(f"{family}, k = {k}" for family in ("apart", "fair") for k in BARS))
    line("--:", *[":--"] * 2 * len(BARS))
    gaps, again = [], []
    for d in sorted({d for _, d in here}):
        cells = []
        for family in ("apart", "fair"):
            for column in (f"plan {k}" for k in BARS):
                sets = both.get((family, d))
                if sets is None:
                    cells.append("–")
                    continue
                best = best_of(sets, column)
                gaps.append(over_all(sets[best], column))
                cells.append(f"`{best}`" if best == "even" else f"`{best}` {gap_text(sets[best], column)}")
                first = best_of(here[family, d], column)
                fresh = there.get((family, d), {}).get(first, [])
                if first != "even" and fresh:
                    text = gap_text(here[family, d][first], column)
                    again.append(
                        (over_all(fresh, column)[0], f"{family}, d = {d}, {column}, `{first}`: {text}", fresh, column)
                    )
        line(d, *cells)
    ahead = sum(mean > error for mean, error in gaps)
    print(f"\n{ahead} of {len(gaps)} best sets are ahead of `even` by more than one standard error.")
    behind = sum(mean <= 0.0 for mean, *_ in again)
    print(f"Of {len(again)} sets that were best in the first worlds, {behind} are not ahead in the others:\n")
    for _, text, fresh, column in again:
        print(f"* {text}, then {gap_text(fresh, column)}")


OTHERS = ("sobol", "uniform", "halton")
"""What stands beside `even` in each cell."""


def print_cells(rows: Sequence[Mapping[str, str]]) -> None:
    """Print the success of `even` in each cell, and how much more other sets solve, and what is ahead of it."""
    cells: dict[tuple[str, int, str], dict[str, list[Mapping[str, str]]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        # In these families a cell holds worlds of all kinds; elsewhere each kind is a cell of its own.
        mixed = row["family"] in ("apart", "fair")
        if (row["kind"] == "all") == mixed:
            name = row["family"] if mixed else row["kind"]
            cells[name, int(row["d"]), row["n"].split()[len(row["n"].split()) // 2]][row["set"]].append(row)
    line("worlds", "d", "N", "number", "`even`, %", *OTHERS)
    line(":--", *["--:"] * 7)
    leads: dict[str, list[list[tuple[float, float]]]] = defaultdict(list)
    for (name, d, n), sets in sorted(cells.items(), key=lambda cell: (cell[0][0], cell[0][1], int(cell[0][2]))):
        column = f"plan {10 if d < 6 else 20}"
        here = sets["even"]
        worlds = [int(row["worlds"]) for row in here]
        solved = np.average([float(row[column]) for row in here], weights=worlds)
        line(name, d, n, sum(worlds), f"{solved:.1f}", *(gap_text(sets[other], column) for other in OTHERS))
        leads[name].append([over_all(sets[other], column) for other in OTHERS])
    for name, each in leads.items():
        means, errors = np.moveaxis(np.array(each), 2, 0)
        texts = zip(means.mean(axis=0), np.sqrt((errors**2).sum(axis=0)) / len(each), strict=True)
        line(f"{name}, mean", "", "", "", "", *(f"{mean:+.1f} ({error:.1f})" for mean, error in texts))


def best_of(sets: Sets, column: str) -> str:
    """Return the set that solves most, `even` where others do as well."""
    return max(sets, key=lambda name: (over_all(sets[name], column)[0], name == "even"))


def over_all(rows: Sequence[Mapping[str, str]], column: str) -> tuple[float, float]:
    """Return the mean difference of runs over different worlds, with its standard error."""
    worlds = np.array([float(row["worlds"]) for row in rows])
    means, errors = (np.array([float(row[f"{column} {of}"]) for row in rows]) for of in ("more", "error"))
    share = worlds / worlds.sum()
    return float(share @ means), float(np.sqrt(share**2 @ errors**2))


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("stores", type=Path, nargs="*", help="of the suites fair and apart")
    parser.add_argument("--candidates", type=Path, help="CSV of points_apart, reporting worlds")
    parser.add_argument("--fresh", type=Path, nargs="*", default=[], help="the same, of other worlds")
    parser.add_argument("--cells", type=Path, nargs="*", default=[], help="CSVs of points_apart, reporting worlds")
    options = parser.parse_args()
    if options.cells:
        print_cells(reported(options.cells))
    if options.stores:
        print_gains(joined([read_rows(store) for store in options.stores]))
    if options.candidates:
        paths = [options.candidates, *options.fresh]
        print_beside(candidates(paths))
        print_kinds(reported(paths))
        print_best(candidates([options.candidates]), candidates(options.fresh))


if __name__ == "__main__":
    main()
