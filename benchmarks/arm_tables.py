"""The tables and pictures of docs/robot-roadmaps.md and arm-suite.md out of stores of `evenroad bench arms`.

    python -m benchmarks.arm_tables results.db --docs docs
    python -m benchmarks.arm_tables here.db there.db --docs docs

Between ``<!-- table NAME -->`` and ``<!-- end -->`` the pages get the table NAME as it stands in the report's
`tables.md`; data/arms.csv and the picture of the UR5 of five joints are written anew, that of costs by
`python -m benchmarks.arm_ompl --store`.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from evenroad.research.arms.results import HEADER, arm_lines, csv_of
from evenroad.research.bench.store import joined, read_rows
from evenroad.research.report.arms import arm_tables, draw_success, summary_tables
from evenroad.research.report.tables import as_markdown
from evenroad.research.report.write import csv_text

PAGES = ("robot-roadmaps.md", "arm-suite.md")
PLACE = re.compile(r"(<!-- table (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)


def main() -> None:
    """Write them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("stores", type=Path, nargs="+")
    parser.add_argument("--docs", type=Path, default=Path("docs"))
    options = parser.parse_args()
    lines = arm_lines(joined([read_rows(store) for store in options.stores]))
    tables = {table.name: table for table in (*summary_tables(lines), *arm_tables(lines))}

    def filled(match: re.Match[str]) -> str:
        begin, name, end = match.groups()
        if name not in tables:
            raise SystemExit(f"the stores have no table {name!r}; they have {', '.join(tables)}")
        _, _, rest = as_markdown(tables[name]).partition("\n")
        return f"{begin}{rest.partition('Success [%]')[0].strip()}\n{end}"

    for page in [options.docs / name for name in PAGES]:
        page.write_text(PLACE.sub(filled, page.read_text()))
    (options.docs / "data" / "arms.csv").write_bytes(csv_text(" ".join(HEADER), csv_of(lines)))
    draw_success(lines, "ur5-5", "10").savefig(options.docs / "arms_ur5.png", dpi=100)


if __name__ == "__main__":
    main()
