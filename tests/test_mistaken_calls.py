"""Calls with what was meant for another function or library: each is told in one line what to write instead.

The calls were written down before it was tried what they answer.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import evenroad as er

CALLS = {
    # --- points
    "er.draw(64, 2)": "draw(name, n, d",
    "er.draw('sobol', 64)": "draw(name, n, d",
    "er.draw('sobol', '64', 2)": "n must be",
    "er.draw('sobol', 64.0, 2)": "n must be",
    "er.draw('sobl', 64, 2)": "did you mean 'sobol'?",
    "er.draw(er.qmc.Sobol(2), 64, 2)": "sampler",
    "er.draw('sobol', 64, 2, rng='zero')": "rng must be",
    "er.draw('sobol', 64, 2, seed=0)": "seed",
    "er.draw('even', 64, 2, rgn=0)": "rng",
    "er.PointSet('set.npy')": "load_points",
    "er.PointSet(Path('set.npy'))": "load_points",
    "er.PointSet([1, 2, 3])": "(n, d)",
    "er.load_points(np.zeros((3, 2)))": "PointSet(",
    "er.load_points(None)": "file",
    "points.save()": "save(path)",
    "points.save(np.zeros(3))": "file",
    "points.discrepancy('star')": "did you mean 'L2-star'?",
    "er.qmc.Even(2)": "Even is called as Even(d, *, n, optimization, rng, seed): missing 1 required",
    "er.qmc.Even(d=2, n=16, rgn=0)": "rng",
    # --- maps
    "er.load_map(np.zeros((3, 3)))": "compared, as cells > 0",
    "er.load_map(None)": "file",
    "er.load_map('ofice.yaml')": "did you mean 'office'?",
    "er.GridMap('office.yaml')": "load_map",
    "er.GridMap(np.zeros((20, 30)))": "boolean",
    "er.GridMap([[0, 1], [0, 0]])": "boolean",
    "er.GridMap(np.zeros((2, 2), bool), resolution='5cm')": "resolution",
    "er.GridMap(np.zeros((2, 2), bool), 0.05)": "resolution=0.05",
    "er.GridMap(np.zeros((2, 2), bool), res=0.05)": "resolution",
    "gridmap.world()": "radius",
    "gridmap.world('0.2')": "radius",
    "gridmap.world(raduis=0.2)": "did you mean 'radius'?",
    "gridmap.world(footprint=[(-1, 0), (1, 0)])": "three corners",
    "disk.valid('start')": "finite numbers",
    "disk.valid(None)": "q must",
    "disk.valid([0.1])": "(n, 2)",
    "disk.motion_valid((0, 0))": "motion_valid(a, b)",
    "disk.motion_valid((0, 0), 'goal')": "finite numbers",
    "disk.explain('here')": "finite numbers",
    "disk.explain((1, 2, 3))": "(1, 2)",
    "disk.distance('here')": "finite numbers",
    # --- results
    "result.resample('fine')": "step",
    "result.resample()": "resample(step)",
    "result.trajectory(np.ones(2))": "Limits(",
    "result.trajectory(sped=0.5)": "did you mean 'speed'?",
    "result.trajectory(speed='fast')": "speed",
    "result.save(None)": "file",
    "result.save('way.txt')": ".json",
    "result.plot(7)": "file",
    "result.plot(world='office.yaml')": "world",
    "er.show('plan.json')": "plan or trajectory plan.json",
    "er.plan(arm, 'home', 'zero', timeout=1)": "seconds=5",
    "er.plan(arm, 'home', 'zero', clearance=0.02)": "ArmWorld(robot, scene, clearance=...)",
    "er.plan(arm, 'home', 'zero', padding=0.02)": "load_robot(file, padding=...)",
    "er.plan_many(arm, np.zeros((1, 6)), np.zeros((1, 6)), secnds=1)": "did you mean 'seconds'?",
    "er.plan_many(arm, np.zeros((1, 6)))": "plan_many(worlds, starts, goals, *, threads, progress",
    "er.RRTConnect(range=0.5)": "known: improve",
    "er.PRM(n=512)": "points",
    "er.build_roadmap(arm, n=64)": "points",
    "er.io.load_plan(7)": "file",
    "er.io.load_plan('nosuch.json')": "nosuch.json",
    # --- robots
    "er.load_robot(np.zeros(6))": "file",
    "er.load_robot(model)": "URDF",
    "er.load_robot('ur5', gruop='arm')": "did you mean 'group'?",
    "er.load_robot('ur5', paddng=0.01)": "did you mean 'padding'?",
    "er.load_robot('nosuch.urdf')": "nosuch.urdf",
    "er.load_robot('ur55')": "ur5",
    "er.Robot('ur5')": "Robot(name, links, joints",
    "robot.fk()": "fk(q, link)",
    "robot.fk('nowhere')": "unknown state 'nowhere'",
    "robot.fk(np.zeros(7))": "6 finite numbers",
    "robot.fk(np.zeros((3, 6)), 'tool0')": "of 3 rows give one",
    "robot.fk({'elbow_joint': 'bent'}, 'tool0')": "elbow_joint",
    "robot.fk(np.zeros(6), 'tol0')": "did you mean 'tool0'?",
    "robot.fk(np.zeros(6), 7)": "link",
    "robot.fk(model)": "6 finite numbers",
    "robot.fk(np.zeros(6), frame='tool0')": "known: link, q",
    "robot.ik('home')": "er.Pose(",
    "robot.ik([0.4, 0.2, 0.3])": "er.Pose(",
    "robot.ik(model)": "er.Pose(",
    "robot.ik(er.Pose((0.4, 0.2, 0.3)), tip='tool0')": "link",
    "robot.random('seed')": "rng must be",
    "robot.random(n=2.5)": "n must be",
    "robot.configuration(None)": "6 finite numbers",
    "robot.configuration({'elbow': 1})": "did you mean 'elbow_joint'?",
    "robot.with_tool('gripper.urdf', 'tool0')": "load_robot",
    "robot.with_tool(model, 'tool0')": "tool must be",
    "robot.with_tool([er.Box((1, 1, 1))])": "at",
    "robot.holding('can', 'tool0')": "Shape",
    "robot.holding(er.Box((0.1, 0.1, 0.1)))": "link",
    "er.Pose(np.eye(4))": "from_matrix",
    "er.Pose('0 0 0')": "xyz",
    "er.Pose((0, 0))": "xyz",
    "er.Pose((0, 0, 0), quat=(0, 0, 0, 1))": "xyzw",
    "er.Pose((0, 0, 0), (0, 0, 0, 1))": "xyzw",
    "er.Pose.from_matrix(np.eye(3))": "4",
    "er.Pose.from_matrix('eye')": "4",
    "er.Pose() @ np.eye(4)": "from_matrix",
    "er.Pose().apply('here')": "(n, 3)",
    "er.PoseGoal('home')": "Pose",
    "er.PoseGoal(np.eye(4))": "Pose",
    # --- scenes
    "er.load_scene({'obstacles': {}})": "er.Scene(",
    "er.load_scene(np.zeros(3))": "file",
    "er.load_scene('box-rech')": "box-reach",
    "er.Scene('box-reach')": "load_scene",
    "er.Scene(7)": "list of shapes",
    "er.Scene([box], obstacle=1)": "'obstacle'; did you mean 'obstacles'",
    "er.Scene([box], obstacles=[box])": "Scene is called as Scene(obstacles, *, name, allowed",
    "er.Scene('cell', [box])": "Scene is called as Scene(obstacles, *, name, allowed",
    "er.Scene([np.zeros(3)])": "er.Box((x, y, z), xyz=...)",
    "er.Scene('table', name='cell')": "must be a list of shapes",
    "er.Scene([box], name=3)": "must be a text",
    "er.Scene([box, box])": "names of their own",
    "er.Scene({'obstacle': {}})": "obstacles",
    "er.Scene({'obstacles': {'can': {'shape': 'tin'}}})": "obstacle 'can' in scene",
    "er.Scene({'obstacles': {}}, limits={'a': (0, 1)})": "put limits into it",
    "er.Scene([model])": "er.Box(",
    "er.Scene({'obstacles': [{'box': {'sise': [1, 1, 1]}}]})": "did you mean 'size'?",
    "scene.with_('box')": "er.Box(",
    "scene.with_(er.Sphere(0.1), alowed=())": "did you mean 'allowed'?",
    "scene.without('tabel')": "did you mean 'table'?",
    "scene.without(7)": "obstacle",
    "er.Box(0.1, 0.1, 0.1)": "size",
    "er.Box('big')": "size",
    "er.Box((1, 1, 1), position=(0, 0, 0))": "known: link, name, pose, rpy, xyz, xyzw",
    "er.Box((1, 1, 1), xyz=(0, 0, 0), pose=er.Pose())": "got both",
    "er.Box((1, 1, 1), pose=(0, 0, 0))": "must be a Pose",
    "er.Box((1, 1))": "size of a box",
    "er.geometry.Capsule(0.1)": "Capsule(radius, length)",
    "er.geometry.Capsule(0.1, 0.2, 0.3, 0.4)": "each once",
    "er.Mesh(7)": "vertices (v, 3)",
    "er.Sphere()": "radius",
    "er.Sphere('0.1')": "radius",
    "er.Cylinder(0.1)": "length",
    "er.Cylinder(radius=0.1, height=0.3)": "length",
    "er.Sphere(0.1, pos=(0, 0, 0))": "xyz",
    "er.Mesh(None)": "file",
    "er.PointCloud('scan.pcd')": "scan.pcd",
    "er.PointCloud(np.zeros(3))": "(n, 3)",
    "er.ArmWorld(7)": "load_robot",
    "er.ArmWorld(model)": "load_robot",
    "er.ArmWorld('ur5', 7)": "Scene",
    "er.ArmWorld(robot, [1])": "er.Box(",
    "er.ArmWorld(robot, scene, margin=0.01)": "clearance",
    "er.ArmWorld(robot, resolution='fine')": "resolution",
    "arm.valid('hom')": "did you mean 'home'?",
    "arm.valid(np.zeros(7))": "6",
    "arm.valid({'elbow': 1})": "did you mean 'elbow_joint'?",
    "arm.valid(model)": "q must",
    "arm.motion_valid('home')": "motion_valid(a, b)",
    "arm.explain(7)": "6",
    # --- worlds of one's own
    "er.FunctionWorld(free)": "FunctionWorld(space, is_valid",
    "er.FunctionWorld('space', free)": "list of (low, high)",
    "er.FunctionWorld(space, 'free')": "must be a function",
    "er.FunctionWorld(space, free, resolution='fine')": "resolution",
    "er.FunctionWorld(space, free, vectorized=True)": "did you mean 'vectorised'?",
    "er.FunctionWorld(space, free).valid('here')": "finite numbers",
    "er.FunctionWorld(space, free).explain('here')": "finite numbers",
    "er.spaces.BoxSpace(2)": "low",
    "er.spaces.BoxSpace((-1, 1))": "BoxSpace(low, high",
    "er.spaces.SE2(5, 5)": "low",
    "er.spaces.SE2((0, 0), (1, 1), weight=(1, 1))": "did you mean 'weights'?",
    "er.spaces.SE3((0, 0), (1, 1))": "3 numbers",
    "er.spaces.Product(7)": "parts",
    "er.spaces.Product([er.spaces.Circle(), 7])": "parts",
    "er.spaces.BoxSpace((0, 0), (1, 1)).distance('a', 'b')": "array of numbers",
}

"""Call -> words that its error has."""


class Model:
    """What another library calls a robot."""

    nq, name = 6, "arm"


@cache
def _values():
    cells = np.zeros((100, 100), bool)
    cells[:70, 50:55] = True
    gridmap = er.GridMap(cells, resolution=0.01)
    disk = gridmap.world(radius=0.02)
    robot, scene = er.load_robot("ur5"), er.load_scene("box-reach")
    return {
        "points": er.draw("sobol", 64, 2),
        "gridmap": gridmap,
        "disk": disk,
        "result": er.plan(disk, (0.05, 0.05), (0.95, 0.95)),
        "robot": robot,
        "scene": scene,
        "arm": er.ArmWorld(robot, scene),
        "space": er.spaces.BoxSpace((-2, -2), (2, 2)),
        "free": lambda q: np.hypot(q[..., 0], q[..., 1]) > 0.5,
        "model": Model(),
        "box": er.Box((0.8, 1.2, 0.04), name="table"),
    }


@pytest.mark.parametrize("call", CALLS)
def test_a_mistaken_call_is_told_what_to_write(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(er.errors.EvenroadError) as error:
        eval(call, {"er": er, "np": np, "Path": Path}, _values())
    text = str(error.value)
    assert CALLS[call] in text
    assert "\n" not in text


VALUES = {
    **{name: f"{name}" for name in ("points", "gridmap", "disk", "result", "robot", "scene", "arm", "space")},
    "status": "result.status",
    "frame": "gridmap.frame",
    "obstacle": "scene.obstacles[0]",
    "joint": "robot.joints[0]",
    "pose": "robot.fk(np.zeros(6))",
    "pose goal": "er.PoseGoal(er.Pose((0.4, 0.2, 0.3)))",
    "own world": "er.FunctionWorld(space, free)",
    "poses": "er.spaces.SE2((0, 0), (1, 1))",
    "joint space": "arm.space",
    "trajectory": "result.trajectory(speed=0.2)",
    "limits": "result.trajectory(speed=0.2).limits",
    "mesh": "er.Mesh((np.eye(3), [[0, 1, 2]]))",
    "cloud": "er.PointCloud(np.zeros((3, 3)))",
    "origin": "points.origin",
    "engine": "er.qmc.Even(d=2, n=16, rng=0)",
    "growing": "er.qmc.Growing(d=2, rng=0)",
}


@pytest.mark.parametrize("name", VALUES)
def test_a_value_shows_itself_in_one_short_line(name):
    text = repr(eval(VALUES[name], {"er": er, "np": np}, _values()))
    assert "\n" not in text
    assert len(text) <= 200
    assert "object at 0x" not in text
