"""The tables of results.md, from the files that `evenroad report` writes of the suites `paper` and `fair`.

    evenroad report paper.db -o paper
    evenroad report fair.db -o fair
    python -m studies.benchmarks.results_tables paper fair

Success is in percent with its 95 % interval; of the random worlds, points above uniform in the same worlds.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from studies.benchmarks.rows import parser_of

Row = Mapping[str, str]
SAMPLERS = {
    "uniform": "uniform",
    "halton paper-blocks": "Halton, the paper's blocks",
    "halton scrambled": "Halton, scrambled",
    "sobol paper-blocks": "Sobol, the paper's blocks",
    "sobol scrambled": "Sobol, scrambled",
    "lattice": "A_d\\* lattice",
    "sukharev": "Sukharev grid (one set)",
    "mpmc": "`mpmc`",
    "hickernell": "`hickernell`",
    "even": "**`even`**",
}
"""Name of a sampler -> how the tables call it, in their order."""
EARLIER, SYMMETRISED = "k=10 earlier", "k=10 symmetrised"
MAZES = (
    ("level 1, N = 64", "maze-1", 64, SYMMETRISED),
    ("level 2, N = 64", "maze-2", 64, SYMMETRISED),
    ("level 2, N = 128", "maze-2", 128, SYMMETRISED),
    ("level 3, N = 256", "maze-3", 256, SYMMETRISED),
    ("level 3, N = 512", "maze-3", 512, SYMMETRISED),
    ("level 3, N = 1024", "maze-3", 1024, SYMMETRISED),
)
CORRIDORS = (
    ("R^2, 0.0225, N = 1024", "corridor-2d-0.0225", 1024, EARLIER),
    ("R^3, 0.1, N = 512", "corridor-3d-0.1", 512, EARLIER),
    ("R^10, 0.495, N = 1024", "corridor-10d-0.495", 1024, EARLIER),
    ("the same, N = 2048", "corridor-10d-0.495", 2048, EARLIER),
    ("legacy6, N = 512", "hypercube-legacy6", 512, EARLIER),
    ("chain, N = 1024", "chain-10d", 1024, EARLIER),
)
PUZZLES = (
    ("Cubicles, N = 1024", "cubicles", 1024, EARLIER),
    ("6-D sets", "cubicles-6d", 1024, EARLIER),
    ("Twistycool, N = 1024", "twistycool", 1024, EARLIER),
    ("6-D sets", "twistycool-6d", 1024, EARLIER),
    ("UR5 c, N = 1024", "ur5-c", 1024, SYMMETRISED),
    ("UR5 a, N = 1024", "ur5-a", 1024, SYMMETRISED),
)
FAIR = (
    (("all", "all"), *(("generator", kind) for kind in ("balls", "boxes", "maze", "se2", "se3"))),
    tuple(("dimension", f"{d}d") for d in (2, 3, 5, 7, 10)),
    tuple(("rule", f"k={k} symmetrised, connect") for k in (4, 6, 10, 20)),
)
"""What the worlds of the fair suite are pooled by: a table each."""


def rows_of(file: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file."""
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def print_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table and an empty line."""
    for cells in (head, [":--", *["--:"] * (len(head) - 1)], *rows):
        print("|", " | ".join(cells), "|")
    print()


def success(row: Row | None) -> str:
    """Return a success in percent with its interval."""
    if row is None:
        return "–"
    share, low, high = (100.0 * float(row[name]) for name in ("success", "low", "high"))
    return f"{share:.0f} [{low:.0f}, {high:.0f}]"


def gain(row: Row | None) -> str:
    """Return how many points a sampler solves more than uniform ones, with the interval."""
    if row is None:
        return "no set"
    more, low, high = (100.0 * float(row[name]) + 0.0 for name in ("difference", "low", "high"))
    return f"{more:+.1f} [{low:.0f}, {high:.0f}]"


def print_cells(rows: Sequence[Row], columns: Sequence[tuple[str, str, int, str]]) -> None:
    """Print the success of every sampler, a column for each problem, number of points and rule."""
    cells = {(row["problem"], int(row["n"]), row["rule"], row["sampler"]): row for row in rows}
    table = [
        [name, *(success(cells.get((problem, n, rule, sampler))) for _, problem, n, rule in columns)]
        for sampler, name in SAMPLERS.items()
    ]
    print_table(["success in %", *(title for title, *_ in columns)], table)


def print_published(rows: Sequence[Row]) -> None:
    """Print the figures of the paper beside ours: successes in percent, and the mean numbers of milestones."""
    of_paper = [row for row in rows if row["source"] == "paper"]
    sizes = sorted({int(row["n"]) for row in of_paper})
    lines: dict[tuple[str, str, str], dict[int, Row]] = {}
    for row in of_paper:
        lines.setdefault((row["problem"], row["sampler"], row["rule"]), {})[int(row["n"])] = row
    table = []
    for names, by_size in lines.items():
        first = next(iter(by_size.values()))
        counts = f"{first['v_counts']} + {first['v_add']}"
        cells = [text for n in sizes for text in beside(by_size[n])]
        table.append([*names, f"{first['expected_runs']} / {first['our_runs']}", counts, *cells])
    head = [cell for n in sizes for cell in (f"SR, N = {n}", "V")]
    print_table(["problem", "sampler", "connection", "runs", "V is", *head], table)
    print_verdicts(rows)


def beside(row: Row) -> tuple[str, str]:
    """Return success and milestones, the paper's and ours; a success that differs is marked."""
    theirs, ours = 100.0 * float(row["expected_success"]), 100.0 * float(row["our_success"])
    mark = " ≠" if row["verdict"] == "differs" else ""
    return f"{theirs:.0f} / {ours:.1f}{mark}", f"{float(row['expected_v']):.1f} / {float(row['our_v']):.1f}"


def print_verdicts(rows: Sequence[Row]) -> None:
    """Print how many cells agree, by who measured them."""
    for source in dict.fromkeys(row["source"] for row in rows):
        verdicts = [row["verdict"] for row in rows if row["source"] == source]
        print(f"{source}:", ", ".join(f"{verdicts.count(name)} {name}" for name in sorted(set(verdicts))))
    print()


def print_fair(rows: Sequence[Row]) -> None:
    """Print by how many points each sampler is above uniform ones, pooled in several ways."""
    found = {(row["pooled_by"], row["group"], row["sampler"]): row for row in rows}
    for groups in FAIR:
        uniform = [next(row for row in rows if (row["pooled_by"], row["group"]) == group) for group in groups]
        table = [["uniform itself, %", *(f"{100.0 * float(row['uniform_success']):.1f}" for row in uniform)]]
        for sampler in SAMPLERS:
            # The Sukharev grid has other numbers of points, and so other worlds.
            if sampler not in ("uniform", "sukharev"):
                table.append([SAMPLERS[sampler], *(gain(found.get((*group, sampler))) for group in groups)])
        titles = [name.removesuffix(" symmetrised, connect").replace("=", " = ") for _, name in groups]
        print_table(["points above uniform", *titles], table)
    print("worlds:", {group: int(float(row["worlds"])) for (by, group, _), row in found.items() if by == "all"})


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("paper", type=Path, help="folder of the report of the suite paper")
    parser.add_argument("fair", type=Path, help="folder of the report of the suite fair")
    options = parser.parse_args()
    cells = rows_of(options.paper / "cells.csv")
    print_published(rows_of(options.paper / "expected.csv"))
    for columns in (MAZES, CORRIDORS, PUZZLES):
        print_cells(cells, columns)
    print_fair(rows_of(options.fair / "fair.csv"))


if __name__ == "__main__":
    main()
