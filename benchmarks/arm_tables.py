"""The tables and pictures of docs/robot-roadmaps.md out of a store of `evenroad bench arms`.

    python -m benchmarks.arm_tables results.db --docs docs

Between ``<!-- table NAME -->`` and ``<!-- end -->`` the page gets the table NAME as it stands in the report's
`tables.md`; data/arms.csv and the pictures of the UR5 of five joints are written anew, the costs by
`python -m benchmarks.arm_ompl --store`.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from evenroad.research.arms.results import HEADER, arm_lines, csv_of
from evenroad.research.bench.store import read_rows
from evenroad.research.report.arms import arm_tables, draw_success
from evenroad.research.report.tables import as_markdown
from evenroad.research.report.write import csv_text

PLACE = re.compile(r"(<!-- table (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)


def main() -> None:
    """Write them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("store", type=Path)
    parser.add_argument("--docs", type=Path, default=Path("docs"))
    options = parser.parse_args()
    lines = arm_lines(read_rows(options.store))
    tables = {table.name: table for table in arm_tables(lines)}
    page = options.docs / "robot-roadmaps.md"

    def filled(match: re.Match[str]) -> str:
        begin, name, end = match.groups()
        if name not in tables:
            raise SystemExit(f"the store has no table {name!r}; it has {', '.join(tables)}")
        _, _, rest = as_markdown(tables[name]).partition("\n")
        return f"{begin}{rest.partition('Success [%]')[0].strip()}\n{end}"

    page.write_text(PLACE.sub(filled, page.read_text()))
    (options.docs / "data" / "arms.csv").write_bytes(csv_text(" ".join(HEADER), csv_of(lines)))
    draw_success(lines, "ur5-5", "10").savefig(options.docs / "arms_ur5.png", dpi=100)


if __name__ == "__main__":
    main()
