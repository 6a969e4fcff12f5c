"""What reaches the terminal is what was said: brackets and colons are no markup."""

import sys
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from evenroad._terminal import LineProgress, print_table, progress_shown
from evenroad.cli.plan_parts import print_plan
from evenroad.planning import PRM, plan
from evenroad.points import PointSet, save_points
from evenroad.world import GridMap

SAID = ("[ms]", "[bold]", "[/]", "scene[red].yaml", ":key:")


def test_a_table_shows_titles_headings_and_cells_as_they_are(capsys):
    print_table([SAID], SAID, " ".join(SAID))
    out = capsys.readouterr().out
    assert {text: out.count(text) for text in SAID} == dict.fromkeys(SAID, 3)


def test_the_widest_column_is_wrapped_and_nothing_of_it_is_lost(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    words = [f"word-{i}" for i in range(20)]
    print_table([("one", " ".join(words), "3"), ("two", "x" * 50, "44")], right=(2,))
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) == 40
    assert " ".join(lines).split() == ["one", *words[:4], "3", *words[4:], "two", "x" * 31, "44", "x" * 19]
    assert lines[0].endswith("   3")


def test_a_heading_of_two_lines_takes_no_more_width_than_its_longer_one(capsys):
    print_table([("a", "1")], ("name", "number of\nruns"), right=(1,))
    assert capsys.readouterr().out.splitlines() == ["name  number of", "           runs", "a             1"]


def test_names_are_bold_on_a_terminal_alone(capsys, monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    for terminal, shown in ((False, "a  b\n"), (True, "\033[1ma\033[0m  b\n")):
        monkeypatch.setattr(sys.stdout, "isatty", lambda terminal=terminal: terminal)
        print_table([("a", "b")])
        assert capsys.readouterr().out == shown


def test_progress_is_one_line_on_a_terminal_and_gone_at_the_end(capsys, monkeypatch):
    now = [0.0]
    monkeypatch.setattr("evenroad._terminal.perf_counter", lambda: now[0])
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with suppress(KeyboardInterrupt), progress_shown("work [ms]") as report:
        for now[0], step in ((1.0, 0), (2.0, 1), (2.05, 2)):
            report(step, 4, 0.5)
        raise KeyboardInterrupt
    said = capsys.readouterr().err
    assert "\n" not in said
    assert said.split("\r\033[2K") == ["", "work [ms] ...", "work [ms]: 25 %, 6 s left, best 0.5", ""]


@pytest.mark.parametrize(("terminal", "kind"), [(False, "xterm"), (True, "dumb")])
def test_progress_is_lines_where_the_cursor_cannot_go_back(capsys, monkeypatch, terminal, kind):
    monkeypatch.setenv("TERM", kind)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    now = [0.0]
    monkeypatch.setattr("evenroad._terminal.perf_counter", lambda: now[0])
    with progress_shown("work") as report:
        for now[0], step in ((1.0, 0), (20.0, 1)):
            report(step, 4)
    assert capsys.readouterr().err == "work: 25 %, 60 s left\n"


@pytest.mark.parametrize("name", ["set[red].npz", "[bold]", "a:key:b"])
def test_a_files_name_may_look_like_markup(run, tmp_path, name):
    save_points(tmp_path / f"{name}.npz", PointSet(np.array([[0.25, 0.5], [0.75, 0.125]])))
    code, out, _ = run("measure", f"{name}.npz")
    assert code == 0
    assert f"{name}.npz: n=2" in out


def test_the_times_of_a_plan_for_an_arm_fit_one_line_of_80_columns(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    seconds = {"validity": 0.0123, "neighbours": 1.4567, "search": 0.5555, "motions": 0.9999, "shortcut": 0.0021}
    world = GridMap(np.zeros((9, 9), dtype=bool)).world(1.0)
    result = replace(plan(world, (2, 2), (7, 7), PRM(16)), timings=seconds)
    print_plan(result, ["a.json"], [("checked by", "lanes")])
    out = capsys.readouterr().out
    assert "time [ms]   validity 12, neighbours 1457, search 556, motions 1000, shortcut 2.1" in out


def test_the_time_left_is_told_once_it_can_be_known(monkeypatch):
    now, said = [0.0], []
    monkeypatch.setattr("evenroad._terminal.perf_counter", lambda: now[0])
    progress = LineProgress("work", said.append, every=10.0)
    for seconds, step in ((1.0, 0), (30.0, 2), (45.0, 50), (60.0, 75)):
        now[0] = seconds
        progress(step, 100)
    assert said == ["work: 2 %", "work: 50 %, 45 s left", "work: 75 %, 20 s left"]
