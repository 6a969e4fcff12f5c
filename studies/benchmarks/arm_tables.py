"""The tables and pictures of robot-roadmaps.md and arm-suite.md, of what runs of `evenroad bench arms` solved.

    python -m studies.benchmarks.arm_tables                     # of data/arms_solved.npz alone
    python -m studies.benchmarks.arm_tables here.db there.db    # what these have takes the place of what was kept

Between ``<!-- table NAME -->`` and ``<!-- end -->`` the pages get the table NAME as it stands in the report's
`tables.md`; data/arms.csv and the picture of the UR5 of five joints are written anew.  data/arms_solved.npz keeps
which draw solved which problem, so that a sampler that is run later is paired with all others.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of

from evenroad._arrays import Floats
from evenroad_studies.arms.execute import KEPT
from evenroad_studies.arms.outcomes import Outcomes, Way, outcomes_of, paired, read_outcomes, write_outcomes
from evenroad_studies.arms.results import ALL, HEADER, REFERENCE, TITLES, Line, csv_of, lines_of
from evenroad_studies.arms.scenes import GENERATORS
from evenroad_studies.bench.store import joined, read_rows
from evenroad_studies.report.arms import OTHERS, arm_tables, draw_success, summary_tables
from evenroad_studies.report.tables import Table, as_markdown, row
from evenroad_studies.report.write import csv_text

PAGES = ("robot-roadmaps.md", "arm-suite.md")
PLACE = re.compile(r"(<!-- table (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)

FEW, MANY, K = 64, 256, "10"
"""Milestones of the roadmap, those of the others it is compared with, and neighbours of both."""


def few_table(outcomes: Mapping[Way, Outcomes]) -> Table:
    """Return what few milestones made for a robot solve more than many of others, by robot and generator."""
    ways = {(way.robot, way.n, way.sampler): way for way in outcomes if way.k == K and way.search == KEPT}
    rows = []
    for robot, n, sampler in sorted(ways):
        if (robot, FEW, REFERENCE) not in ways or n != MANY or TITLES.get(sampler, sampler) not in OTHERS:
            continue
        pairs = paired(outcomes[ways[robot, FEW, REFERENCE]], outcomes[ways[robot, n, sampler]])
        shares = 100 * pairs.more / pairs.pairs
        groups = [*(shares[pairs.generator == which] for which in range(len(GENERATORS))), shares]
        rows.append(row(robot, f"{n} of {TITLES.get(sampler, sampler)}", *map(_mean, groups)))
    title = f"success of {FEW} milestones of the roadmap minus that of {MANY} others [percentage points]"
    return Table("arms-few", title, ("robot", "against", *GENERATORS, ALL), rows, labels=2)


def _mean(shares: Floats) -> str:
    """Return the mean over problems and its standard error."""
    if len(shares) < 2:
        return "–"
    return f"{shares.mean():+.1f} ± {shares.std(ddof=1) / np.sqrt(len(shares)):.1f}"


def all_tables(outcomes: Mapping[Way, Outcomes], lines: Sequence[Line]) -> dict[str, Table]:
    """Return every table by its name."""
    made = (few_table(outcomes), *summary_tables(lines), *arm_tables(lines))
    return {table.name: table for table in made}


def with_tables(page: str, tables: Mapping[str, Table]) -> str:
    """Return a page with its tables filled in anew."""

    def filled(match: re.Match[str]) -> str:
        begin, name, end = match.groups()
        if name not in tables:
            raise SystemExit(f"there is no table {name!r}; there are {', '.join(tables)}")
        _, _, rest = as_markdown(tables[name]).partition("\n")
        table = rest.partition("Success [%]")[0].strip().splitlines()
        return "\n".join([begin.strip(), *(_wrapped(line) for line in table), end])

    return PLACE.sub(filled, page)


def _wrapped(line: str) -> str:
    return line if line.startswith("|") else textwrap.fill(line, 118, break_on_hyphens=False)


def main() -> None:
    """Write them."""
    parser = parser_of(__doc__)
    parser.add_argument("stores", type=Path, nargs="*")
    parser.add_argument("--docs", type=Path, default=Path("studies/docs"))
    options = parser.parse_args()
    kept = options.docs / "data" / "arms_solved.npz"
    if not kept.exists() and not options.stores:
        raise SystemExit(f"there is no {kept} yet: name a store")
    outcomes = read_outcomes(kept) if kept.exists() else {}
    new = outcomes_of(joined([read_rows(store) for store in options.stores])) if options.stores else {}
    for way in outcomes.keys() & new.keys():
        if new[way].ran.sum() < outcomes[way].ran.sum():
            raise SystemExit(f"the stores have fewer runs than were kept of {way}")
    outcomes |= new
    lines = lines_of(outcomes)
    tables = all_tables(outcomes, lines)
    pages = {path: with_tables(path.read_text(), tables) for path in (options.docs / name for name in PAGES)}
    if new:
        write_outcomes(kept, outcomes)
    for path, page in pages.items():
        path.write_text(page)
    (options.docs / "data" / "arms.csv").write_bytes(csv_text(" ".join(HEADER), csv_of(lines)))
    draw_success(lines, "ur5-5", "10").savefig(options.docs / "arms_ur5.png", dpi=100)


if __name__ == "__main__":
    main()
