"""Tables that contradict themselves are refused before anything beyond their ends is read."""

import numpy as np
import pytest

from evenroad._native import robot as native
from evenroad._native.world import Disk
from evenroad.collision import native_robot
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.loading.load import load_robot
from evenroad.scenes.scene import Scene
from tests.robots.kernel_arms import random_scene
from tests.robots.mesh_arms import write_fork_arm


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    kept, made = [], native_robot.robot_arrays
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(native_robot, "robot_arrays", lambda *given: kept.append(made(*given)) or kept[-1])
        # Of a size of its own: a robot that an earlier test used is not packed again.
        robot = load_robot(write_fork_arm(tmp_path_factory.mktemp("fork"), scale="1.0123 1.0123 1.0123"))
        ArmWorld(robot, Scene(random_scene(3).obstacles)).valid(np.zeros(3))
    return next(each for each in kept if len(each["shapes"]["body"]))


def _far_end(first):
    return np.append(first[:-1], 2**62)


@pytest.mark.parametrize(
    ("name", "changed", "words"),
    [
        ("first_point", _far_end, "parts.first_point must rise, within parts.points"),
        ("inside", lambda balls: np.zeros((5, 5)), "shapes.inside must have four columns"),
        ("enclosing", lambda which: which[:-1], "shapes.body must be as long as shapes.widths and shapes.enclosing"),
    ],
)
def test_shapes_that_lead_beyond_their_tables_are_refused(tables, name, changed, words):
    native.Robot(**tables)
    shapes = tables["shapes"] | {name: changed(tables["shapes"][name])}
    with pytest.raises(InvalidValue, match=words):
        native.Robot(**tables | {"shapes": shapes})


def test_a_disk_of_which_the_square_of_the_radius_is_nothing_is_refused():
    cells, frame = np.zeros((3, 3), dtype=bool), np.array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0])
    Disk(cells, frame, 1e-150)
    with pytest.raises(InvalidValue, match="radius must be a finite number >= 1e-150"):
        Disk(cells, frame, 1e-170)
