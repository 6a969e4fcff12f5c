"""A name that is called otherwise elsewhere is answered with what it is called here, and no answer misleads."""

import re

import numpy as np
import pytest

import evenroad as er
from evenroad import _hints
from evenroad._call import explains_calls
from evenroad._hints import UnknownAttribute, _tables, among_names
from evenroad.driving import CarWorld
from evenroad.errors import InvalidValue, UnknownName
from evenroad.planning import PlanResults
from evenroad.task import Task, TaskResult
from evenroad.world.gridmap import DiskWorld

CLASSES = [
    *(er.Robot, er.Scene, er.PlanResult, er.Trajectory, er.Pose, er.PointSet, er.GridMap, er.ArmWorld, DiskWorld),
    *(CarWorld, er.FunctionWorld, er.Roadmap, er.Replanner, TaskResult, Task, PlanResults),
]
KINDS = {each.__name__: each for each in CLASSES}


def names_of(kind):
    return {each for each in (*dir(kind), *getattr(kind, "__annotations__", ())) if not each.startswith("_")}


@pytest.mark.parametrize(("value", "guess", "told"), [
    (er.load_robot("ur5"), "joint_limits", "Robot has no `joint_limits`; it is `limits`"),
    (er.load_robot("ur5"), "getJointNames", "did you mean `joint_names`?"),
    (er.load_robot("ur5"), "forward_kinematics", "it is `fk(q, link)`"),
    (er.load_robot("ur5"), "max_joint_velocities", "it is `velocity_limits`"),
    (er.load_robot("ur5"), "velocity_limit", "it is `velocity_limits`"),
    (er.load_robot("ur5"), "fingerprnt", "did you mean `fingerprint`?"),
    (er.load_robot("ur5"), "wheelbase", "Robot has no `wheelbase`; it has bodies, capsules"),
    (er.Scene(), "add_box", "`with_(er.Box(size, xyz=...))` returns a scene with one more"),
    (er.Pose(), "quaternion", "it is `xyzw`"),
    (er.Sphere(0.1), "position", "it is `xyz`"),
    (er.draw("uniform", 4, 2), "to_numpy", "it is `points`"),
    (er.Scene, "from_yaml", "`er.load_scene(file)` reads it"),
    (er.Robot, "from_urdf", "`er.load_robot(file)` reads it"),
    (er, "Car", "`er.load_map(file).world(footprint=...)`, or `evenroad.driving.CarWorld`, is one"),
    (er, "robots_list", "module 'evenroad' has no attribute 'robots_list'"),
    (er, "TrajectoryLimits", "module 'evenroad' has no attribute 'TrajectoryLimits'"),
    (er, "Task", "it is `evenroad.task.Task`"),
    (er, "load_urdf", "it is `er.load_robot`"),
])  # fmt: skip
def test_a_guess_is_answered(value, guess, told):
    assert not hasattr(value, guess)
    with pytest.raises(AttributeError) as raised:
        getattr(value, guess)
    assert told in str(raised.value)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_every_attribute_that_a_hint_names_is_there(kind):
    known = names_of(kind)
    for answer in _tables()[kind.__name__]:
        if not answer.startswith(("* ", "er.", "evenroad.", kind.__name__)):
            first, _, rest = re.match(r"(\w+)(\.?)(\w*)", answer).groups()
            assert first in known, f"{kind.__name__}: {answer}"
            if rest and first in ("robot", "scene"):
                assert rest in names_of(KINDS[first.title()])


def test_every_public_name_that_a_hint_names_is_there():
    for section, rows in _tables().items():
        for name in re.findall(r"\b(?:er|evenroad)(?:\.\w+)+", " ".join(rows)):
            _, *parts = name.replace("evenroad.", "er.").split(".")
            value = er
            for part in parts:
                value = getattr(value, part, None)
            assert value is not None, f"{section}: {name}"


def test_every_section_is_of_something():
    assert set(_tables()) == {*KINDS, "World", "shapes", "modules", "keywords"}


def test_asking_whether_there_is_a_name_reads_no_table(monkeypatch):
    monkeypatch.setattr(_hints, "_tables", lambda: pytest.fail("read"))
    assert not hasattr(er.Pose(), "quaternion")
    assert getattr(er.Pose(), "quaternion", 7) == 7


@explains_calls
class Wheel:
    @property
    def turns(self):
        return self.no_such_thing


def test_a_property_that_fails_says_why_and_not_that_it_is_not_there():
    with pytest.raises(UnknownAttribute, match="Wheel has no `no_such_thing`"):
        _ = Wheel().turns


def test_a_keyword_is_answered_where_the_function_has_what_is_meant():
    with pytest.raises(UnknownName, match="keyword of Pose: 'position'; it is `xyz`"):
        er.Pose(position=(0, 0, 0))
    with pytest.raises(InvalidValue, match="'timeout'; it is `seconds`"):
        er.plan(er.ArmWorld("ur5"), "home", "home", timeout=1)
    with pytest.raises(UnknownName, match="option of sampler 'sobol': 'seed'; it is `rng`"):
        er.draw("sobol", 64, 2, seed=0)


@pytest.mark.parametrize("name", ["rrtc", "RRT-Connect", "rrt_connect", "RRTConnect", "BiRRT"])
def test_a_planner_has_its_name_in_any_spelling(name):
    world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    assert er.plan(world, (3, 3), (27, 17), name).planner == er.plan(world, (3, 3), (27, 17), er.RRTConnect()).planner


def test_a_planner_that_there_is_not_is_answered_with_the_nearest():
    world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    with pytest.raises(UnknownName, match=r"'BIT\*'; `er.RRTConnect\(improve=True\)` improves its path; known: fmt"):
        er.plan(world, (3, 3), (27, 17), "BIT*")


def test_of_many_names_those_that_are_near_are_named():
    known = {"panda", "panda_hand", "kinova", "ur5", "ur5_gripper", "ur10", "tiago"}
    told = str(among_names("robot", "franka_panda", known, "`evenroad robots` lists them"))
    assert told == "unknown robot 'franka_panda'; near names: panda, panda_hand; `evenroad robots` lists them"
    assert "near" not in str(among_names("robot", "zzz", known, "`evenroad robots` lists them"))


@pytest.mark.parametrize(("name", "told"), [
    ("MoveTo", "it is `evenroad.task.MoveTo`"), ("InvalidValue", "it is `evenroad.errors.InvalidValue`"),
    ("save", "`result.save(file)` writes it"),
    ("check_collision", "`er.ArmWorld(robot, scene).in_collision(q)` says it"),
])  # fmt: skip
def test_a_name_of_a_part_is_answered_with_where_it_is_and_not_with_what_is_alike(name, told):
    with pytest.raises(AttributeError, match=re.escape(told)):
        getattr(er, name)


@pytest.mark.parametrize(("call", "told"), [
    (lambda: er.Sphere(0.1, center=(0, 0, 0)), "'center'; it is `xyz`"),
    (lambda: er.Cylinder(radius=0.1, height=0.3), "'height'; it is `length`"),
    (lambda: er.PRM(n=100), "'n'; it is `points`"),
    (lambda: er.FlightWorld(er.Scene(), max_speed=3), "'max_speed'; it is `speed`; known: acceleration, bounds, jerk"),
    (lambda: er.plan(robot="ur5", scene="box-reach", start="home", goal="inside"), "plan is called as plan(world, "),
    (lambda: er.Robot("ur5"), "er.load_robot(name or file) makes one"),
])  # fmt: skip
def test_a_keyword_is_answered_also_where_a_function_takes_others(call, told):
    with pytest.raises(er.errors.EvenroadError, match=re.escape(told)):
        call()
