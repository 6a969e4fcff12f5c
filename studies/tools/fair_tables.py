"""The tables of the fair suite in docs/results.md, in Markdown, out of a store and what `evenroad report` made of it.

    evenroad report fair.db -o fair
    python studies/tools/fair_tables.py fair.db fair/fair.csv --write studies/docs/results.md

Three tables say what samplers gain on uniform points: by kind of world, by dimension, by k.  A fourth has the bar of
`even`: its difference from scrambled Sobol, in percentage points, with a standard error paired by world.  `--write`
puts each in the place of the table with the same first column heading and columns.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from evenroad_studies.bench.store import read_rows
from evenroad_studies.report.fair import parts_of

NAMES = {
    "halton paper-blocks": "Halton, the paper's blocks",
    "halton scrambled": "Halton, scrambled",
    "sobol paper-blocks": "Sobol, the paper's blocks",
    "sobol scrambled": "Sobol, scrambled",
    "lattice": "A_d* lattice",
    "mpmc": "`mpmc`",
    "hickernell": "`hickernell`",
    "even": "**`even`**",
}
RULES = tuple(f"k={k} symmetrised" for k in (4, 6, 10, 20))
TABLES = (
    (
        ("all", "balls", "boxes", "mazes", "SE(2)", "SE(3)"),
        ("all/all", *(f"generator/{kind}" for kind in ("balls", "boxes", "maze", "se2", "se3"))),
        tuple(NAMES),
    ),
    (
        ("d = 2", "3", "5", "7", "10"),
        tuple(f"dimension/{d}d" for d in (2, 3, 5, 7, 10)),
        ("halton scrambled", "sobol scrambled", "lattice", "mpmc", "hickernell", "even"),
    ),
    (
        ("k = 4", "6", "10", "20"),
        tuple(f"rule/{rule}, connect" for rule in RULES),
        ("sobol scrambled", "hickernell", "even"),
    ),
)


def main() -> None:
    """Print the tables, and write them where asked to."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("store", type=Path)
    parser.add_argument("csv", type=Path)
    parser.add_argument("--write", type=Path)
    options = parser.parse_args()
    with open(options.csv, newline="") as file:
        pooled = {(f"{row['pooled_by']}/{row['group']}", row["sampler"]): row for row in csv.DictReader(file)}
    tables = [gains(pooled, *table) for table in TABLES] + [beside_sobol(options.store)]
    print("\n\n".join("\n".join(table) for table in tables))
    if options.write:
        page = options.write.read_text()
        for table in tables:
            page = replaced(page, table)
        options.write.write_text(page)


def gains(
    pooled: dict[tuple[str, str], dict[str, str]],
    heads: tuple[str, ...],
    groups: tuple[str, ...],
    samplers: tuple[str, ...],
) -> list[str]:
    """Return the lines of one table of gains on uniform points, with 95 % intervals."""
    uniform = [f"{100 * float(pooled[group, 'sobol scrambled']['uniform_success']):.1f}" for group in groups]
    lines = [("points above uniform", *heads), ("---",) * (1 + len(heads)), ("uniform itself, %", *uniform)]
    for sampler in samplers:
        entries = []
        for group in groups:
            row = pooled.get((group, sampler))
            if row is None:
                entries.append("no set")
                continue
            gain, low, high = (100 * float(row[name]) for name in ("difference", "low", "high"))
            entries.append(f"{gain:+.1f} [{low:.0f}, {high:.0f}]".replace("-0]", "0]").replace("[-0,", "[0,"))
        lines.append((NAMES[sampler], *entries))
    return [f"| {' | '.join(line)} |".replace("| --- ", "|---").replace("--- |", "---|") for line in lines]


def beside_sobol(store: Path) -> list[str]:
    """Return the lines of the table of `even` minus scrambled Sobol, by kind of world and by k."""
    rows = read_rows(store)
    rows = rows.where(rows.search.is_in(["connect"]) & rows.sampler.is_in(["even", "sobol scrambled"]))
    kinds = {name: parts_of(name)[0] for name in rows.problem.present()}
    dimensions = {name: parts_of(name)[1] for name in kinds}
    chosen = {
        **{
            text: [p for p in kinds if kinds[p] == kind]
            for kind, text in (("maze", "mazes"), ("se2", "SE(2)"), ("se3", "SE(3)"))
        },
        **{
            f"{kind}, d = {d}": [p for p in kinds if kinds[p] == kind and dimensions[p] == f"{d}d"]
            for kind in ("balls", "boxes")
            for d in (2, 3, 5, 7, 10)
        },
        "all": list(kinds),
    }
    lines = [("`even` - Sobol", "k = 4", "6", "10", "20", "all four"), (":--", *(("--:",) * 5))]
    for text, problems in chosen.items():
        here = rows.problem.is_in(problems)
        entries = [
            paired(rows, here & rows.rule.is_in(rules)) for rules in (*([rule] for rule in RULES), RULES)
        ]
        lines.append((text, *entries))
    return [f"| {' | '.join(line)} |" for line in lines]


def paired(rows, here) -> str:  # type: ignore[no-untyped-def]
    """Return a difference in points, with the standard error of its mean over worlds; a dash if there is none."""
    if not here.any():
        return "–"
    world = np.stack([rows.problem.codes[here].astype(np.int64), rows.instance[here]])
    _, unit = np.unique(world, axis=1, return_inverse=True)
    sign = np.where(rows.sampler.is_in(["even"])[here], 1.0, -1.0)
    sums = np.bincount(unit.ravel(), weights=sign * rows.solved[here])
    pairs = np.bincount(unit.ravel()) / 2.0
    mean = sums.sum() / pairs.sum()
    error = np.sqrt(np.sum((sums - mean * pairs) ** 2)) / pairs.sum()
    return f"{100 * mean:+.1f} ({100 * error:.1f})"


def replaced(page: str, table: Iterable[str]) -> str:
    """Return the page with the table in the place of the one that has the same heading."""
    lines, new = page.split("\n"), list(table)
    starts = [i for i, line in enumerate(lines) if line == new[0]]
    if len(starts) != 1:
        raise SystemExit(f"the page has {len(starts)} tables with the heading {new[0]}")
    end = starts[0]
    while lines[end].startswith("|"):
        end += 1
    return "\n".join([*lines[: starts[0]], *new, *lines[end:]])


if __name__ == "__main__":
    main()
