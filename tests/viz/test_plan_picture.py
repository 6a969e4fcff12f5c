from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from evenroad.errors import BrokenFile
from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.viz import style
from evenroad.viz.plan import draw_plan, save_plan_picture
from evenroad.world import GridMap, MapFrame


def _room(**frame):
    occupied = np.zeros((30, 40), dtype=bool)
    occupied[14:16, :30] = True
    return GridMap(occupied, MapFrame(rows=30, cols=40, **frame) if frame else None)


def _axes(result, world):
    axes = Figure().add_subplot()
    draw_plan(axes, result, world)
    return axes


def _pixels_of(picture, colour):
    rgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return (np.abs(np.asarray(picture.convert("RGB")).astype(int) - rgb).sum(axis=2) < 30).sum()


def test_a_solved_plan_shows_start_goal_and_both_paths():
    world = _room().world(1.0)
    axes = _axes(plan(world, (5, 5), (5, 25), PRM(draw("halton", 200, 2))), world)
    assert {text.get_text() for text in axes.get_legend().get_texts()} == {"roadmap path", "path", "start", "goal"}
    assert axes.get_title().startswith("solved")


def test_dollars_in_a_message_are_dollars(tmp_path):
    world = _room().world(1.0)
    result = plan(world, (5, 5), (5, 25), PRM(draw("halton", 10, 2)))
    result = replace(result, message="$\\frac{$ 1$ 2")
    save_plan_picture(tmp_path / "a.png", result, world)
    assert _axes(result, world).title.get_text().startswith(r"solved: \$\frac{\$ 1\$ 2")


def test_a_bare_image_is_drawn_with_y_down_and_a_ros_map_with_y_up():
    for grid, up in ((_room(), False), (_room(resolution=0.5, y_up=True), True)):
        world = grid.world(0.4)
        start, goal = world.space.from_cube(np.array([[0.1, 0.1], [0.9, 0.1]]))
        low, high = _axes(plan(world, start, goal, PRM(draw("halton", 50, 2))), world).get_ylim()
        assert (low < high) == up


def test_obstacles_are_drawn_where_the_world_has_them():
    """A map turned by its yaw: the picture is dark exactly where a tiny disk is in collision."""
    grid = _room(resolution=0.5, origin=(3.0, -2.0), yaw=0.6, y_up=True)
    world = grid.world(1e-6)
    canvas = FigureCanvasAgg(Figure(figsize=(6, 6), dpi=100))
    axes = canvas.figure.add_axes((0, 0, 1, 1))
    start = world.space.from_cube(np.array([[0.05, 0.05]]))[0]
    draw_plan(axes, plan(world, start, start, PRM(draw("halton", 1, 2))), world)
    for artist in [*axes.lines, *axes.patches, *axes.collections, axes.get_legend()]:
        artist.set_visible(False)
    canvas.draw()
    shown = np.asarray(canvas.buffer_rgba())[:, :, 0]
    inside = world.space.from_cube(draw("uniform", 500, 2).points)
    at = axes.transData.transform(inside).round().astype(int)
    dark = shown[shown.shape[0] - 1 - at[:, 1], at[:, 0]] < 128
    assert np.mean(dark != world.valid(inside)) > 0.97


@pytest.mark.parametrize(("start", "goal"), [((3, 13), (20, 25)), ((5, 5), (20, 16.5))])
def test_a_collision_is_marked_at_the_obstacle_that_is_touched(start, goal):
    world = _room().world(4.0)
    result = plan(world, start, goal, PRM(draw("halton", 10, 2)))
    axes = _axes(result, world)
    (cross,) = [line for line in axes.lines if line.get_marker() == "X"]
    end = np.array(start if result.status == "start_invalid" else goal)
    assert np.hypot(*(cross.get_xydata()[0] - end)) < 4.0


def test_the_saved_picture_has_every_colour_of_the_legend(tmp_path):
    world = _room().world(1.0)
    save_plan_picture(tmp_path / "a.png", plan(world, (5, 5), (5, 25), PRM(draw("halton", 200, 2))), world)
    with Image.open(tmp_path / "a.png") as picture:
        for colour in (style.OBSTACLE, style.PATH, style.START, style.GOAL):
            assert _pixels_of(picture, colour) > 50


@pytest.mark.parametrize(("rows", "cols"), [(3, 600), (600, 3)])
def test_long_thin_maps_give_a_picture_of_bearable_size(tmp_path, rows, cols):
    world = GridMap(np.zeros((rows, cols), dtype=bool)).world(0.5)
    save_plan_picture(tmp_path / "a.png", plan(world, (1.5, 1.5), (1.5, 1.5), PRM(draw("halton", 5, 2))), world)
    with Image.open(tmp_path / "a.png") as picture:
        assert max(picture.size) < 2500


def test_a_picture_that_cannot_be_written_is_our_error(tmp_path):
    world = _room().world(1.0)
    result = plan(world, (5, 5), (5, 25), PRM(draw("halton", 20, 2)))
    with pytest.raises(BrokenFile, match="does not exist"):
        save_plan_picture(tmp_path / "no" / "a.png", result, world)


def test_unknown_cells_do_not_look_like_walls_and_only_what_is_known_is_shown():
    occupied = np.ones((200, 200), dtype=bool)
    unknown = occupied.copy()
    occupied[50:80, 60:100] = unknown[48:82, 58:102] = False
    world = GridMap(occupied, unknown=unknown).world(1.0)
    axes = _axes(plan(world, (65, 55), (95, 75)), world)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    assert 50 < left < 58 < 102 < right < 110
    assert 40 < top < 48 < 82 < bottom < 90
    kinds = axes.images[0].get_array()
    assert kinds[10, 10] != kinds[49, 80] != kinds[60, 80]


def test_two_components_have_a_colour_each():
    occupied = np.zeros((30, 40), dtype=bool)
    occupied[14:16] = True
    world = GridMap(occupied).world(2.0)
    kinds = _axes(plan(world, (5, 5), (5, 25)), world).images[0].get_array()
    assert len({kinds[0, 0], kinds[15, 5], kinds[5, 5], kinds[25, 5]}) == 4
    connected = _room().world(2.0)
    kinds = _axes(plan(connected, (5, 5), (5, 25)), connected).images[0].get_array()
    assert kinds[5, 5] == kinds[25, 5]
