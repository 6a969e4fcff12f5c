"""Figures: what is drawn, not how it looks."""

import pytest

from evenroad.errors import NotAvailable
from evenroad_studies.bench.samplers import SAMPLERS
from evenroad_studies.report.cells import cells_of
from evenroad_studies.report.charts import LOOKS, as_png, draw_curves, draw_fair_gains, draw_maze_success, maze_settings
from evenroad_studies.report.fair import pooled
from evenroad_studies.report.scenes import draw_scene, scenes_among
from tests.studies.report.stores import made_up, runs_from


def test_every_sampler_has_a_look_of_its_own():
    assert list(LOOKS) == list(SAMPLERS)
    assert len({(look["color"], look["linestyle"]) for look in LOOKS.values()}) == len(LOOKS)


def test_curves_name_every_sampler_once_and_show_its_success_in_three_panels(tmp_path):
    cells = cells_of(runs_from(tmp_path / "a.db", made_up(runs=10)))
    figure = draw_curves(cells, "a title")
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == list(dict.fromkeys(c.sampler for c in cells))
    uniform = [100 * cell.rate for cell in cells if cell.sampler == "uniform"]
    for axes in figure.axes:
        assert axes.lines[0].get_ydata() == pytest.approx(uniform)


def test_mazes_under_one_rule_share_a_picture(tmp_path):
    rows = made_up("maze-1", runs=5) + made_up("maze-2", runs=5) + made_up("maze-2", runs=5, rule="k=4 symmetrised")
    runs = runs_from(tmp_path / "a.db", rows)
    mazes = maze_settings(runs.settings)
    assert {(each.problem, each.search) for each in mazes} <= {("maze-1", "connect"), ("maze-2", "connect")}
    assert len({each.rule for each in mazes}) == 1
    figure = draw_maze_success([cell for cell in cells_of(runs) if cell.setting in mazes])
    assert [axes.get_title().split(",")[0] for axes in figure.axes] == ["maze-1", "maze-2"]
    for axes in figure.axes:
        places = [tuple(points.get_xdata()) for points, _, _ in axes.containers]
        assert len(set(places)) == len(places) == 4, "error bars of two samplers cover each other"


def test_gains_in_random_worlds_are_drawn_with_their_intervals_and_dimensions_without_what_has_none(tmp_path):
    rows = made_up("fair-balls-2d-50", runs=12) + made_up("fair-maze-50", runs=12)
    found = pooled(runs_from(tmp_path / "a.db", rows))
    figure = draw_fair_gains(found)
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == ["by generator", "by dimension", "by rule"]
    assert [tick.get_text() for tick in figure.axes[1].get_xticklabels()] == ["2d"]
    first = next(each for each in found["dimension"] if each.group == "2d")
    (points, _, (bars,)) = figure.axes[1].containers[0]
    assert points.get_ydata() == pytest.approx([100 * (first.rate - first.reference_rate)])
    low, high = bars.get_segments()[0][:, 1]
    assert low <= points.get_ydata()[0] <= high
    (legend,) = figure.legends
    assert "uniform" not in [text.get_text() for text in legend.get_texts()]


def test_scenes_are_shown_once_and_what_nobody_draws_has_none(tmp_path):
    assert maze_settings(runs_from(tmp_path / "a.db", made_up("maze-1", runs=2)).settings) == ()
    assert scenes_among(["twistycool-6d", "maze-2", "corridor-2d-0.1", "twistycool"]) == ("maze-2", "twistycool")
    with pytest.raises(NotAvailable, match="hypercube-legacy6"):
        draw_scene("hypercube-legacy6")


def test_the_same_figure_gives_the_same_bytes_which_do_not_name_who_drew_it(tmp_path):
    cells = cells_of(runs_from(tmp_path / "a.db", made_up(runs=10)))
    first, again, other = (as_png(draw_curves(cells, title)) for title in ("a", "a", "b"))
    assert first == again != other
    assert b"Matplotlib" not in first
