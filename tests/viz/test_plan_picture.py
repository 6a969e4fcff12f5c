import numpy as np
import pytest
from PIL import Image

from evenroad.errors import BrokenFile
from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.viz import style
from evenroad.viz.plan import draw_plan, draw_plan_view, save_plan_picture
from evenroad.world import GridMap, MapFrame


def _room(**frame):
    occupied = np.zeros((30, 40), dtype=bool)
    occupied[14:16, :30] = True
    return GridMap(occupied, MapFrame(rows=30, cols=40, **frame) if frame else None)


def _are(picture, colour):
    """Return which pixels of a picture have a colour, (height, width)."""
    rgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return np.abs(np.asarray(picture.convert("RGB")).astype(int) - rgb).sum(axis=2) < 30


def _colours_at(view, *positions):
    """Return the colours of a view at positions."""
    return [view.image.getpixel((int(x), int(y))) for x, y in view.pixels(np.array(positions, dtype=float))]


def test_a_solved_plan_shows_start_goal_obstacles_and_both_paths():
    world = _room().world(1.0)
    picture = draw_plan(plan(world, (5, 5), (5, 25), PRM(draw("halton", 200, 2))), world)
    for colour in (style.OBSTACLE, style.PATH, style.RAW_PATH, style.MILESTONE, style.START, style.GOAL):
        assert _are(picture, colour).sum() > 50


def test_a_bare_image_is_drawn_with_y_down_and_a_ros_map_with_y_up():
    for grid, up in ((_room(), False), (_room(resolution=0.5, y_up=True), True)):
        world = grid.world(0.4)
        start, goal = world.space.from_cube(np.array([[0.1, 0.1], [0.9, 0.9]]))
        picture = draw_plan(plan(world, start, goal, PRM(draw("halton", 50, 2))), world)
        # Above the legend, whose names have these colours, too.
        (starts, _), (goals, _) = (np.nonzero(_are(picture, each)[:-60]) for each in (style.START, style.GOAL))
        assert (starts.mean() > goals.mean()) == up


def test_obstacles_are_drawn_where_the_world_has_them():
    """A map turned by its yaw: the picture is dark exactly where a tiny disk is in collision."""
    world = _room(resolution=0.5, origin=(3.0, -2.0), yaw=0.6, y_up=True).world(1e-6)
    start = world.space.from_cube(np.array([[0.05, 0.05]]))[0]
    view = draw_plan_view(plan(world, start, start, PRM(draw("halton", 1, 2))), world)
    inside = world.space.from_cube(draw("uniform", 500, 2).points)
    dark = np.array(_colours_at(view, *inside)).max(axis=1) < 128
    assert np.mean(dark != world.valid(inside)) > 0.97
    np.testing.assert_allclose(view.positions(np.array(view.pixels(inside))), inside, atol=1e-9)


@pytest.mark.parametrize(("start", "goal"), [((3, 13), (20, 25)), ((5, 5), (20, 16.5))])
def test_a_collision_is_marked_at_the_obstacle_that_is_touched(start, goal):
    world = _room().world(4.0)
    result = plan(world, start, goal, PRM(draw("halton", 10, 2)))
    view = draw_plan_view(result, world)
    end = np.array(start if result.status == "start_invalid" else goal)
    touched = world.nearest_obstacle(end[np.newaxis])[0]
    assert np.hypot(*(touched - end)) < 4.0
    assert _colours_at(view, touched) == [(0xD1, 0x34, 0x3B)]


@pytest.mark.parametrize(("rows", "cols"), [(3, 600), (600, 3)])
def test_long_thin_maps_give_a_picture_of_bearable_size(rows, cols):
    world = GridMap(np.zeros((rows, cols), dtype=bool)).world(0.5)
    picture = draw_plan(plan(world, (1.5, 1.5), (1.5, 1.5), PRM(draw("halton", 5, 2))), world)
    assert max(picture.size) < 2500


def test_a_picture_is_saved_or_says_why_not(tmp_path):
    world = _room().world(1.0)
    result = plan(world, (5, 5), (5, 25), PRM(draw("halton", 20, 2)))
    save_plan_picture(tmp_path / "a.png", result, world)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.tobytes() == draw_plan(result, world).tobytes()
    with pytest.raises(BrokenFile, match="does not exist"):
        save_plan_picture(tmp_path / "no" / "a.png", result, world)


def test_unknown_cells_do_not_look_like_walls_and_only_what_is_known_is_shown():
    occupied = np.ones((200, 200), dtype=bool)
    unknown = occupied.copy()
    occupied[50:80, 60:100] = unknown[48:82, 58:102] = False
    world = GridMap(occupied, unknown=unknown).world(1.0)
    view = draw_plan_view(plan(world, (65, 55), (95, 75)), world)
    (left, top), (right, bottom) = view.low, view.high
    assert 50 < left < 58 < 102 < right < 110
    assert 40 < top < 48 < 82 < bottom < 90
    assert len(set(_colours_at(view, (57.5, 48.5), (80.5, 49.5), (62.5, 78.5)))) == 3


def test_two_components_have_a_colour_each():
    occupied = np.zeros((30, 40), dtype=bool)
    occupied[14:16] = True
    places = [(2.5, 2.5), (5.5, 15.0), (12.5, 5.5), (12.5, 25.5)]
    world = GridMap(occupied).world(2.0)
    assert len(set(_colours_at(draw_plan_view(plan(world, (5, 5), (5, 25)), world), *places[1:]))) == 3
    connected = _room().world(2.0)
    _, _, *both = _colours_at(draw_plan_view(plan(connected, (5, 5), (5, 25)), connected), *places)
    assert len(set(both)) == 1
