"""What reaches the terminal is what was said: brackets and colons are no markup."""

import re

import numpy as np
import pytest
from rich.table import Table

from evenroad._terminal import print_table
from evenroad.points import PointSet, save_points
from tests.research.report.stores import solved, task, write_store

SAID = ("[ms]", "[bold]", "[/]", "scene[red].yaml", ":key:")


def test_a_table_shows_titles_headings_and_cells_as_they_are(capsys):
    table = Table(*SAID, title=" ".join(SAID))
    table.add_row(*SAID)
    print_table(table)
    out = capsys.readouterr().out
    assert {text: out.count(text) for text in SAID} == dict.fromkeys(SAID, 3)


def test_a_plan_says_in_which_unit_its_times_are(run):
    code, out, _ = run("demo", "--level", 1, "-n", 256)
    assert code == 0
    assert re.search(r"^time \[ms\] .*\d", out, re.MULTILINE)


def test_the_fair_suite_says_in_which_unit_its_differences_are(run, tmp_path):
    rows = [
        (task("fair-balls-3d-50", sampler, 256, each, instance=each), solved(each % 2 == place))
        for place, sampler in enumerate(("uniform", "korobov"))
        for each in range(12)
    ]
    write_store(tmp_path / "results.db", rows)
    code, out, _ = run("report", "results.db", "-o", "out")
    assert code == 0
    assert "[points]" in out


@pytest.mark.parametrize("name", ["set[red].npz", "[bold]", "a:key:b"])
def test_a_files_name_may_look_like_markup(run, tmp_path, name):
    save_points(tmp_path / f"{name}.npz", PointSet(np.array([[0.25, 0.5], [0.75, 0.125]])))
    code, out, _ = run("measure", f"{name}.npz")
    assert code == 0
    assert f"{name}.npz: n=2" in out
