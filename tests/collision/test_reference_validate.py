"""The last check of a path where coal is not there: what stays unchecked is said."""

import numpy as np

from evenroad.collision import coal_world
from evenroad.collision.validate import unseen_pairs, validate
from evenroad.errors import NotAvailable
from evenroad.loading.load import load_model
from evenroad.scenes.scene import Scene
from tests.robots.mesh_arms import write_plate_arm


def missing():
    raise NotAvailable("coal is not here")


def test_pairs_that_nobody_tests_without_coal_are_named(tmp_path, monkeypatch):
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path))
    monkeypatch.setattr(coal_world, "require_coal", missing)
    file = write_plate_arm(tmp_path)
    model = load_model(file)
    unseen = unseen_pairs(model)
    # The collar is in the plate all the time; the tip, near it, is not, and every planner tests it.
    assert ("plate", "collar") in unseen
    assert ("plate", "tip") in model.robot.pairs
    check = validate(file, model.robot, Scene((), name="nothing"), np.zeros((2, 3)), unseen=unseen)
    assert check.verdict == "not checked"
    assert "'plate' with 'collar'" in str(check)
    assert "needs evenroad[mesh]" in str(check)


def test_neighbours_and_what_an_srdf_disables_are_no_unseen_pairs():
    assert unseen_pairs(load_model("ur5")) == ()
