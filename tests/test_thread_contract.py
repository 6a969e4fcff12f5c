"""Whatever is public gives eight threads the answers that one gets, or paths as good where it learns."""

import itertools
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import evenroad as er
from evenroad.collision.certified import CertifiedWorld
from evenroad.constraints.constrained_world import kept_world
from evenroad.geometry import Mesh, PointCloud, TriangleMesh
from evenroad.planning import GrowingPRM
from evenroad.planning.connectors import ARM_TREES
from evenroad.planning.planners.trees import default_planner
from evenroad.points.measures import MEASURES
from evenroad.roadmap import Budget, KNearest
from evenroad.roadmap.build import roadmap_of_points
from evenroad.robot import Obstacle, link_poses
from evenroad.trajectory import Limits, load_trajectory, make_trajectory, save_trajectory
from evenroad.world.gridmap.load import load_maze
from tests.robots.kernel_arms import TABLE, box_scene, ur5
from tests.threads import together

QUERIES = 8
_names = itertools.count()


def bits(answer):
    """An answer as a value that is equal where all its bits are; of a result what does not tell of effort."""
    if isinstance(answer, np.ndarray):
        return answer.shape, answer.dtype.str, answer.tobytes()
    if isinstance(answer, er.PlanResult):
        return answer.status, answer.goal_index, answer.proof, answer.cost, bits(answer.path)
    if isinstance(answer, er.PointSet):
        return bits(answer.points)
    if isinstance(answer, tuple | list):
        return tuple(map(bits, answer))
    return answer


def robot():
    """An arm that nothing is known of yet."""
    return replace(ur5(limits=math.pi, joints=3), name=f"arm {next(_names)}")


@cache
def ends(world=None):
    """Free starts and goals, (q, 2, dim): of the arm in its box, or of a world."""
    world = er.ArmWorld(robot(), box_scene()) if world is None else world
    q = world.space.from_cube(er.draw("sobol", 256, world.space.cube_dim, rng=1).points)
    return q[world.valid(q)][: 2 * QUERIES].reshape(QUERIES, 2, -1)


def explained(world, q):
    """Why the first configuration is not free that is not."""
    blocked = q[~world.valid(q)]
    return world.explain(blocked[0]) if len(blocked) else ""


def verdicts(world, q):
    """What a world is asked: of each pair another question first, and so of each thread."""
    asks = []
    for a, b in q[:4]:
        asks += [
            lambda a=a, b=b: world.valid(np.linspace(a, b, 33)),
            lambda a=a, b=b: world.motion_valid(np.array([a, b]), np.array([b, a])),
            lambda a=a, b=b: explained(world, np.linspace(a, b, 33)),
        ]
        if hasattr(world, "validate"):
            asks.append(lambda a=a, b=b: world.validate(np.linspace(a, b, 5)))
    return asks


def an_arm():
    world = er.ArmWorld(robot(), box_scene())
    certified, (a, b) = CertifiedWorld(world), ends()[0]
    own = [lambda: world.apart(a, np.atleast_2d(b)), lambda: certified.motion_valid(ends()[:, 0], ends()[:, 1])]
    return verdicts(world, ends()) + own + [lambda: ARM_TREES.smooth(world, np.array([a, b]))]


def an_arm_among_clouds_and_meshes():
    corners = [(0, 0, 0), (0.3, 0, 0), (0, 0.3, 0), (0, 0, 0.5)]
    wedge = TriangleMesh(corners, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], "wedge")
    scan = np.random.default_rng(0).uniform((-0.5, 0.4, 0.2), (0.1, 0.6, 0.6), (60, 3))
    scene = TABLE.with_(
        Obstacle("wedge", Mesh(wedge, pose=er.Pose((0.4, -0.3, 0.05)))), Obstacle("scan", PointCloud(scan, 0.02))
    )
    return verdicts(er.ArmWorld(robot(), scene), ends())


def an_upright_arm():
    world = er.ArmWorld(robot(), box_scene())
    upright = kept_world(world, (er.constraints.KeepUpright(0.5),), ends()[0, 0], "wrist3")
    return [lambda a=a: upright.shares(a) for a in ends()[:6]] + verdicts(upright, ends())


def trees():
    world = er.ArmWorld(robot(), box_scene())
    budget = Budget(seconds=60.0, rounds=2)
    asks = [lambda a=a, b=b: er.plan(world, a, b) for a, b in ends()]
    return [*asks, lambda: er.plan(world, *ends()[0], default_planner(world, improve=True), limits=budget)]


def one_call():
    where = link_poses(ur5(joints=3), ends()[1, 1][np.newaxis])[0, -1]
    pose = er.PoseGoal(er.Pose(where[:3, 3]), position_only=True)
    arm = robot()
    return [
        lambda: er.plan("box-reach", "home", "inside", robot="ur5", certified=True),
        lambda: er.plan(box_scene(), ends()[0, 0], pose, robot=arm),
        lambda: er.plan(box_scene(), *ends()[2], er.PRM(200), robot=arm),
        lambda: er.load_robot("ur5").configuration("home", er.load_scene("box-reach")),
    ]


def points_and_rules():
    world = er.ArmWorld(robot(), box_scene())
    a, b = ends()[3]
    return [
        lambda: er.plan(world, a, b, er.PRM(100)),
        lambda: er.plan(world, a, b, er.PRM(100, search="lazy", rule=KNearest(12))),
        lambda: er.plan(world, a, b, er.FMT(100)),
        lambda: er.plan(world, a, b, GrowingPRM(), limits=Budget(samples=256)),
    ]


def a_kept_roadmap():
    world = er.ArmWorld(robot(), box_scene())
    kept = roadmap_of_points(world.space, er.draw("uniform", 128, 3, rng=2))
    here = kept.within(world)
    asks = [lambda a=a, b=b: here.plan(a, b) for a, b in ends()]
    return [*asks, lambda: kept.within(world).plan(*ends()[0])]


def a_scene_that_changes():
    world = er.ArmWorld(robot(), box_scene())
    pose = er.Pose((0.4, 0.4, 0.4))

    def updated(a, b):
        live = er.Replanner(world, b)
        return live.update(a), live.update(a, moved={"roof": pose}), live.world.valid(ends()[:, 0])

    changed = [lambda: world.moved({"roof": pose}).valid(ends()[:, 0]), lambda: world.without("left").scene.rows]
    return [*changed, *(lambda a=a, b=b: updated(a, b) for a, b in ends()[:4])]


def a_disk_on_a_map():
    world = load_maze(2).world()
    q = ends(world)
    asks = [lambda a=a, b=b: (world.may_connect(a, b), world.component(a), world.nearest_free(b)) for a, b in q[:4]]
    return [*asks, *verdicts(world, q), *(lambda a=a, b=b: er.plan(world, a, b) for a, b in q[:4])]


def a_function():
    world = er.FunctionWorld(er.spaces.SE2((0, 0), (1, 1)), lambda q: np.abs(q[:, 0] - 0.5) > 0.1 * q[:, 1], 0.02)
    q = ends(world)
    return [*verdicts(world, q[:2]), lambda: er.plan(world, *q[0], er.PRM(40))]


def samplers():
    names = ("even", "hickernell", "korobov", "growing", "halton", "sobol", "lattice")
    draws = [lambda name=name, d=d: er.draw(name, 64, d, rng=3) for name in names for d in (2, 3)]
    return [*draws, lambda: MEASURES["hickernell"].rooted(er.draw("korobov", 101, 4))]


def trajectories():
    path = np.cumsum(ends()[:6, 0], axis=0)
    limits = Limits((1.0,) * 3, (4.0,) * 3)

    def made():
        there = make_trajectory(path, limits)
        return there.times, there.positions, there.velocities

    return [made]


def files(folder):
    """Saved once, loaded by all, and saved by all."""
    world = load_maze(2).world()
    er.draw("uniform", 64, 2, rng=2).save(folder / "p.npz")
    er.build_roadmap(world, 64).save(folder / "r.npz")
    save_trajectory(folder / "t.json", make_trajectory(ends()[0], Limits((1.0,) * 3, (4.0,) * 3)))
    return [
        lambda: er.load_points(folder / "p.npz"),
        lambda: er.load_roadmap(folder / "r.npz").edges,
        lambda: load_trajectory(folder / "t.json").positions,
        lambda: er.load_robot("arm7") == er.load_robot("arm7"),
        lambda: er.load_scene("box-reach") == er.load_scene("box-reach"),
        lambda: er.draw("uniform", 64, 2, rng=2).save(folder / "again.npz"),
    ]


VALUES = [
    an_arm,
    an_arm_among_clouds_and_meshes,
    an_upright_arm,
    trees,
    one_call,
    points_and_rules,
    a_kept_roadmap,
    a_scene_that_changes,
    a_disk_on_a_map,
    a_function,
    samplers,
    trajectories,
]


@pytest.mark.parametrize("made", VALUES, ids=lambda made: made.__name__)
def test_eight_threads_get_the_answers_of_one(made):
    expected = [bits(ask()) for ask in made()]
    for answers in together(*made()):
        assert [bits(answer) for answer in answers] == expected


def test_eight_threads_read_and_write_files_as_one(tmp_path):
    asks = files(tmp_path)
    expected = [bits(ask()) for ask in asks]
    for answers in together(*asks):
        assert [bits(answer) for answer in answers] == expected
    assert bits(er.load_points(tmp_path / "again.npz")) == bits(er.load_points(tmp_path / "p.npz"))
