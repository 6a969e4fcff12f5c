"""The written report: which files, what stands in them, and what is refused."""

import csv
import math
import re
from html.parser import HTMLParser

import pytest

from evenroad.errors import BrokenFile
from evenroad_studies.bench.task import Outcome
from evenroad_studies.report import write_report
from tests.studies.report.stores import made_up, solved, task, write_store
from tests.studies.report.stores import without_pictures as without_pictures

LEGACY = {"rule": "k=10 earlier", "search": "stock"}
FAILED = Outcome("failed", error="Traceback (most recent call last):\n  boo\nValueError: <script> | 50%\n")


def _rows():
    rows = made_up("maze-1", runs=20) + made_up("hypercube-legacy6", runs=20, **LEGACY)
    rows += [(task("maze-1", "uniform", 128, 99), FAILED)]
    for place, sampler in enumerate(("uniform", "lattice")):
        for run in range(36):
            where = task("fair-balls-3d-50", sampler, 256, run, instance=run // 3)
            rows.append((where, solved((run + place) % 3 > 0)))
    return rows


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return write_store(tmp_path_factory.mktemp("store") / "results.db", _rows())


@pytest.fixture(scope="module")
def report(store, tmp_path_factory):
    return write_report(store, tmp_path_factory.mktemp("report") / "out", command="evenroad report results.db")


class _Page(HTMLParser):
    """Collects ids, links and sources, and sees that every element is closed."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.sources, self.text = [], [], [], [], ""

    def handle_starttag(self, tag, attributes):
        of = dict(attributes)
        self.ids += [of["id"]] if "id" in of else []
        self.links += [of["href"]] if tag == "a" else []
        self.sources += [of["src"]] if "src" in of else []
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


@pytest.fixture(scope="module")
def page(report):
    page = _Page()
    page.feed(report.files[0].read_text(encoding="utf-8"))
    assert page.open == []
    return page


def test_the_page_needs_no_other_file(page, report):
    html = report.files[0].read_text(encoding="utf-8")
    assert page.sources
    assert all(source.startswith("data:image/png;base64,") for source in page.sources)
    assert "http" not in html
    assert "<link" not in html
    assert "<script" not in html


def test_the_page_says_where_its_numbers_come_from_and_has_tables_of_every_kind(page):
    for fact in ("evenroad report results.db", "553 rows", "1 (1 failed)", "numpy", "seeds", "protocol", "paper"):
        assert fact in page.text
    for title in (
        "Table 1 of the paper beside ours",
        "Independent measurement beside ours",
        "Fair suite by generator",
        "maze-1, k=10 symmetrised, connect: success [%]",
        "difference from uniform [points]",
        "success of single sets [%]",
        "N for 90 %",
    ):
        assert title in page.text
    assert len(set(page.ids)) == len(page.ids)
    assert {link.removeprefix("#") for link in page.links} <= set(page.ids)
    assert not [each for each in page.ids if each.startswith("fair-balls")], "fair problems are pooled"


def test_every_table_names_its_connection_rule(report):
    titles = re.split(r"^### ", (report.files[0].parent / "tables.md").read_text("utf-8"), flags=re.M)[1:]
    assert len(titles) > 10
    for table in titles:
        named = re.search(r"k=\d+(, \d+)* (symmetrised|earlier)", table.split("\n\n")[0])
        assert named or "connection" in table or " rule " in table, table.splitlines()[0]


def test_cells_as_csv_hold_every_cell_with_its_counts(report):
    (path,) = [path for path in report.files if path.name == "cells.csv"]
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(report.analysis.cells) == 12 + 12 + 2
    (uniform,) = [r for r in rows if (r["problem"], r["sampler"], r["n"]) == ("maze-1", "uniform", "128")]
    assert (uniform["runs"], uniform["failures"], uniform["interval"]) == ("21", "1", "wilson")
    assert float(uniform["success"]) == int(uniform["solved"]) / 21
    assert (uniform["unit"], uniform["units"], uniform["sets"]) == ("runs", "21", "0")
    assert math.isfinite(float(uniform["mean_seconds"]))


def test_milestones_are_counted_as_the_paper_does_only_where_the_search_stops_as_its_planner(report):
    (path,) = [path for path in report.files if path.name == "cells.csv"]
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        expected = str(float(row["mean_valid"]) + 3) if row["search"] == "stock" else ""
        assert row["mean_paper_v"] == expected
    assert {row["search"] for row in rows} == {"stock", "connect"}


def test_pictures_are_files_as_well(report):
    pictures = [path for path in report.files if path.suffix == ".png"]
    assert {path.name for path in pictures} >= {"maze-1-k-10-symmetrised-connect.png", "point-sets.png"}
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in pictures)


def test_the_same_store_gives_the_same_bytes(store, report, tmp_path):
    again = write_report(store, tmp_path, command="evenroad report results.db")
    assert [path.name for path in again.files] == [path.name for path in report.files]
    for ours, theirs in zip(again.files, report.files, strict=True):
        assert ours.read_bytes() == theirs.read_bytes(), ours.name


def test_a_folder_that_cannot_be_made_is_refused(store, tmp_path):
    (tmp_path / "file").write_text("mine")
    for folder in (tmp_path / "no" / "such", tmp_path / "file"):
        with pytest.raises(BrokenFile, match="folder"):
            write_report(store, folder)
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.usefixtures("without_pictures")
@pytest.mark.parametrize("samplers", [("uniform",), ("lattice",), ("of another version",)])
def test_one_sampler_and_one_run_are_enough(tmp_path, samplers):
    rows = [(task("of another version", sampler), solved()) for sampler in samplers]
    report = write_report(write_store(tmp_path / "a.db", rows), tmp_path / "out")
    assert len(report.analysis.cells) == 1
    assert "≤ 128" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("without_pictures")
def test_a_store_of_failures_only_is_reported(tmp_path):
    rows = [(task(run=run), FAILED) for run in range(3)]
    report = write_report(write_store(tmp_path / "a.db", rows), tmp_path / "out")
    assert report.analysis.failures[0].runs == 3
    assert "ValueError" in (tmp_path / "out" / "tables.md").read_text(encoding="utf-8")
