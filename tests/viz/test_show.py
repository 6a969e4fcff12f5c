"""What is shown, and where: in the browser, below a notebook's cell, or in a viewer of pictures."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

import evenroad as er
import evenroad.viz.show as shows
from evenroad.task import MoveTo, Task
from evenroad.viz.posture import at_home, draw_arm_world, in_words
from tests.refused import refused

CELLS = np.zeros((40, 60), dtype=bool)
MAP = er.GridMap(CELLS, resolution=0.1)
ON_A_MAP = er.plan(MAP.world(radius=0.2), (0.5, 3.5), (5.5, 3.5))
FLYING = er.FlightWorld(er.Scene([er.Cylinder(0.2, 6.0, xyz=(4, 0, 3), name="tree")]), speed=3.0, acceleration=4.0)
OF_AN_ARM = er.plan(er.ArmWorld("ur5"), (0, -1.5, 0, -1.5, 0, 0), (0.5, -1.5, 0.5, -1.5, 0, 0))


class Page:
    address = "http://127.0.0.1:1234/token"

    def __init__(self, world, result, plan, file, *, timed, port):
        self.timed = timed
        self.planned = plan(world, result.start, result.goal)
        self.done = []

    def serve(self):
        self.done.append("served")
        raise KeyboardInterrupt

    def close(self):
        self.done.append("closed")


@pytest.fixture
def pages(monkeypatch):
    """The pages that a browser was opened for."""
    opened = []
    monkeypatch.setattr(shows, "ArmPage", Page)
    monkeypatch.setattr(shows, "open_browser", lambda address: opened.append(address) is None)
    return opened


@pytest.fixture
def notebook(monkeypatch):
    """What a notebook displays."""
    displayed = []
    shell = type("ZMQInteractiveShell", (), {})()
    display = SimpleNamespace(display=displayed.append, IFrame=lambda *given: given)
    ipython = SimpleNamespace(get_ipython=lambda: shell, display=display, version_info=(9, 0))
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    return displayed


def test_an_arm_is_served_to_the_browser_until_ctrl_c(pages):
    page = er.show(OF_AN_ARM)
    assert pages == [page.address]
    assert page.done == ["served", "closed"]
    assert page.planned.solved


def test_in_a_notebook_an_arm_stays_below_the_cell(pages, notebook):
    page = er.show(OF_AN_ARM)
    assert (pages, page.done) == ([], [])
    assert notebook == [(page.address, "100%", shows.HEIGHT)]


def test_where_no_browser_opens_the_address_is_printed_and_the_page_is_served(pages, monkeypatch, capsys):
    monkeypatch.setattr(shows, "open_browser", lambda address: False)
    page = er.show(OF_AN_ARM)
    assert page.address in capsys.readouterr().out
    assert page.done == ["served", "closed"]


def test_a_trajectory_is_served_with_its_times(pages):
    trajectory = OF_AN_ARM.trajectory(speed=0.5)
    np.testing.assert_array_equal(er.show(trajectory).timed[1], trajectory.positions)
    refused(er.errors.InvalidValue, "does not know its world", er.show, replace(trajectory, world=None))


@pytest.mark.parametrize("what", [
    er.load_robot("ur5"),
    er.load_scene("shelf"),
    Task([MoveTo("inside")]).plan(er.ArmWorld("ur5", "box-reach"), "home").motions[0],
    "office.yaml",
    er.load_map("office.yaml").world(radius=0.2),
    FLYING,
    er.plan(FLYING, er.State((0, 0, 2)), er.State((8, 0, 2))).trajectory(),
], ids=lambda what: type(what).__name__)  # fmt: skip
def test_what_has_a_picture_is_shown(what, notebook):
    picture = er.show(what)
    assert notebook == [picture]
    colours = np.unique(np.asarray(picture).reshape(-1, len(picture.getbands())), axis=0)
    assert len(colours) >= 2
    assert min(picture.size) > 200


def test_a_task_is_a_page_that_plays(notebook):
    page = er.show(Task([MoveTo("inside"), MoveTo("home")]).plan(er.ArmWorld("ur5", "box-reach"), "home"))
    try:
        assert notebook == [(page.address, "100%", shows.HEIGHT)]
        assert '"title":"solved: 2 motions' in page.page()
    finally:
        page.close()


def test_a_saved_plan_is_shown_by_its_name(pages, tmp_path):
    OF_AN_ARM.save(tmp_path / "plan.json")
    assert er.show(tmp_path / "plan.json").done == ["served", "closed"]


def test_a_map_and_a_plan_without_a_path_are_pictures(notebook, monkeypatch):
    for what in (MAP, er.plan(MAP.world(radius=0.2), (0.5, 3.5), (9.0, 3.5))):
        assert np.array_equal(np.asarray(er.show(what)), np.asarray(what.plot()))
    assert len(notebook) == 2
    monkeypatch.delitem(sys.modules, "IPython")
    viewed = []
    monkeypatch.setattr(Image.Image, "show", lambda picture: viewed.append(picture))
    assert viewed == [er.show(MAP)]


@pytest.mark.parametrize(("what", "timed"), [(ON_A_MAP, False), (ON_A_MAP.trajectory(speed=1.0), True)])
def test_a_plan_on_a_map_and_its_trajectory_are_served_and_play(what, timed, monkeypatch):
    texts = []

    def serve(page):
        texts.append(page.page())
        raise KeyboardInterrupt

    monkeypatch.setattr(shows.PageServer, "serve", serve)
    monkeypatch.setattr(shows, "open_browser", lambda address: True)
    er.show(what)
    (text,) = texts
    assert '"kind":"map"' in text
    assert f'"timed":{str(timed).lower()}' in text


@pytest.mark.parametrize("what", [None, np.zeros((3, 2)), er.Pose()])
def test_only_plans_and_maps_are_shown(what):
    refused(er.errors.InvalidValue, "a plan or a map can be shown", er.show, what)


def test_an_arm_in_its_scene_is_a_picture_at_the_configuration_that_is_asked_for(notebook):
    world = er.ArmWorld("ur5", "box-reach")
    home, inside = (np.asarray(er.show(world, q)) for q in (None, "inside"))
    assert len(notebook) == 2
    assert home.shape == inside.shape
    assert (home != inside).any(axis=2).mean() > 0.02


def test_what_touches_is_red_and_the_title_says_it_or_how_far_the_nearest_bodies_are():
    world = er.ArmWorld("ur5", er.Scene([er.Sphere(0.2, xyz=(0.5, 0, 0.5), name="ball")]))
    near, far = world.distance("home"), in_words(world, world._row("home"))
    assert far == f"free; {1e3 * near.metres:.1f} mm from {near.pair[0]} to {near.pair[1]}"
    touching = {"shoulder_lift_joint": -0.9, "elbow_joint": 0.3}
    assert "touches 'ball'" in in_words(world, world._row(touching))
    red = [np.asarray(draw_arm_world(world, q))[..., :3].astype(int) for q in ("home", touching)]
    counts = [((each[..., 0] > 150) & (each[..., 1] < 80) & (each[..., 2] < 80)).sum() for each in red]
    assert counts[1] > counts[0] + 500


def test_a_robot_without_home_stands_at_zero():
    world = er.ArmWorld(replace(er.load_robot("ur5"), states={}))
    assert np.array_equal(at_home(world), np.zeros(6))


def test_a_configuration_is_for_a_world_alone_and_must_be_one_of_its_robot():
    refused(er.errors.InvalidValue, r"q says where .* er\.ArmWorld.*'home'", er.show, MAP, "home")
    world = er.ArmWorld("ur5")
    refused(er.errors.InvalidValue, "must be 6 finite numbers", er.show, world, (0, 1))
    refused(er.errors.UnknownName, "nosuch", er.show, world, {"nosuch": 1.0})


def test_points_are_shown_as_their_picture(monkeypatch):
    seen = []
    monkeypatch.setattr(Image.Image, "show", lambda picture: seen.append(picture))
    picture = er.show(er.draw("even", 64, 2))
    assert seen == [picture]


def test_the_trajectory_of_a_task_says_what_to_show():
    done = Task([MoveTo("inside")]).plan(er.ArmWorld("ur5", "box-reach"), "home")
    with pytest.raises(er.errors.InvalidValue, match="of a task, show the answer itself"):
        er.show(done.trajectory())
