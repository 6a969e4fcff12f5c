"""Random questions whose answers have certificates: a robot among all kinds of obstacle, and what a plan may hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from zlib import crc32

import numpy as np

import evenroad as er
from evenroad.certificates.certify import Sources
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints import KeepInBox
from evenroad.constraints.constrained_world import KeptWorld
from evenroad.errors import EvenroadError
from evenroad.geometry.mesh import convex_hull, height_map
from evenroad.loading.load import RobotOptions, load_model
from evenroad.loading.model import RobotModel
from evenroad.robots.held import HeldObject
from evenroad.robots.kinematics import capsule_endpoints, link_poses
from evenroad.scenes.obstacle import Obstacle
from evenroad.scenes.robot_in_scene import in_scene
from evenroad.trajectory.limits import Limits

EXTRAS = ("clearance", "wider", "padding", "allowed", "held", "base", "driven", "kept")
"""What a question has beside obstacles: a clearance of all or of one obstacle, a padded link, an allowed contact, an
object in the hand, a base that moves in the plane, a trajectory with rounded corners, a link that stays in a box."""
SHARE = 0.25
"""How often a question has each of them."""
TRIES = 10
BASE = "sweep"
BASE_SRDF = """<robot name="{name}">
  <virtual_joint name="{base}" type="planar" parent_frame="floor" child_link="{root}"/>
  <group name="all">{joints}</group>
</robot>"""


@dataclass(frozen=True)
class Around:
    """Where a robot's links are: the obstacles of a scene are drawn there."""

    rng: np.random.Generator
    low: np.ndarray
    high: np.ndarray
    scale: float = 1.0
    """Of the sizes of all that is drawn."""

    def place(self) -> np.ndarray:
        return self.rng.uniform(self.low, self.high)

    def size(self, share: float = 0.15) -> float:
        return float(self.scale * share * np.max(self.high - self.low) * self.rng.uniform(0.3, 1.0))


def boxes(around: Around) -> list[er.Shape]:
    return [
        er.Box([around.size() for _ in range(3)], xyz=around.place(), rpy=around.rng.normal(size=3)) for _ in range(5)
    ]


def primitives(around: Around) -> list[er.Shape]:
    sphere, place = er.Sphere(around.size(0.1), xyz=around.place()), around.place
    turned = {"rpy": tuple(around.rng.normal(size=3))}
    cylinder = er.Cylinder(around.size(0.05), around.size(0.5), xyz=place(), **turned)
    return [sphere, cylinder, er.Capsule(around.size(0.05), around.size(0.5), xyz=place(), **turned)]


def mesh(around: Around) -> list[er.Shape]:
    points = around.rng.normal(size=(30, 3))
    hull = convex_hull(around.size() * points / np.linalg.norm(points, axis=1, keepdims=True))
    return [er.Mesh(hull, xyz=around.place()) for _ in range(2)]


def cloud(around: Around) -> list[er.Shape]:
    points = around.place() + around.size() * around.rng.uniform(-1.0, 1.0, (2000, 3))
    return [er.PointCloud(points, radius=0.01)]


def ground(around: Around) -> list[er.Shape]:
    heights = around.rng.uniform(0.0, around.size(0.1), (20, 20))
    side = float(np.max(around.high - around.low))
    return [er.Mesh(height_map(heights, side / 19.0, depth=0.2), xyz=(*around.low[:2], around.low[2]))]


KINDS: dict[str, Callable[[Around], list[er.Shape]]] = {
    "boxes": boxes,
    "primitives": primitives,
    "mesh": mesh,
    "cloud": cloud,
    "ground": ground,
}


@dataclass(frozen=True)
class Tried:
    """A robot as its file is read, with an SRDF or none."""

    model: RobotModel
    sources: Sources

    @classmethod
    def read(cls, path: Path | str, packages: Mapping[str, Path], srdf: Path | None = None) -> Tried:
        group = None if srdf is None else "all"
        options: RobotOptions = {"srdf": srdf, "group": group, "packages": packages}
        try:
            model = load_model(path, **options)
        except EvenroadError as error:
            if "--use-visuals" not in str(error):
                raise
            options["use_visuals"] = True
            model = load_model(path, **options)
        visuals = options.get("use_visuals", False)
        return cls(model, Sources.named(path, None, srdf, embed=True, packages=packages, use_visuals=visuals))

    def on_a_base(self, folder: Path) -> Tried:
        """Return the same robot on a base that moves in the plane."""
        robot = self.model.robot
        joints = "".join(f'<joint name="{name}"/>' for name in (BASE, *robot.group))
        srdf = folder / "base.srdf"
        srdf.write_text(BASE_SRDF.format(name=robot.name, base=BASE, root=robot.links[0], joints=joints))
        return self.read(self.sources.robot, {name: Path(at) for name, at in self.sources.packages.items()}, srdf)

    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the corners of a box around most of the places where the robot's bodies may be."""
        empty = ArmWorld(self.model.robot)
        q = empty.space.from_cube(np.random.default_rng(0).random((200, empty.space.cube_dim)))
        endpoints = capsule_endpoints(self.model.robot, q).reshape(-1, 3)
        low, high = np.quantile(endpoints, [0.02, 0.98], axis=0)
        return low, high + 0.05


@dataclass(frozen=True)
class Question:
    """A world with a start and a goal; `kept` is the link that is claimed to stay in a box, if one is."""

    world: ArmWorld
    start: np.ndarray
    goal: np.ndarray
    kept: str = ""


@dataclass(frozen=True)
class Draw:
    """Which obstacles a question has, and what else."""

    around: Around
    kinds: tuple[str, ...]
    extras: frozenset[str] = field(default_factory=frozenset)

    @classmethod
    def of(cls, robot: str, number: int, low: np.ndarray, high: np.ndarray) -> Draw:
        """Return the draw of a number for a robot: one to three kinds of obstacle, each is the first one in turn."""
        rng = np.random.default_rng([crc32(robot.encode()), number])
        first = list(KINDS)[number % len(KINDS)]
        others = [str(each) for each in rng.choice(list(KINDS), rng.integers(3), replace=False)]
        extras = frozenset(each for each in EXTRAS if rng.random() < SHARE)
        return cls(Around(rng, low, high), tuple(dict.fromkeys([first, *others])), extras)

    def question(self, tried: Tried) -> Question | None:
        """Return a question with a free start and goal, among ever smaller obstacles; None if there is none."""
        robot, around, rng = tried.model.robot, self.around, self.around.rng
        bodied = list(dict.fromkeys(each.link for each in robot.capsules))
        if "held" in self.extras:
            body = er.Box([around.size(0.1) for _ in range(3)], xyz=0.05 * rng.normal(size=3))
            robot = robot.holding(HeldObject("held", body, bodied[-1], tuple(bodied[len(bodied) // 2 :])))
        if "padding" in self.extras:
            robot = robot.with_padding({str(rng.choice(bodied)): float(rng.uniform(0.0, 0.02))})
        limits = {f"{BASE}/{each}": (-0.5, 0.5) for each in "xy"} if "base" in self.extras else {}
        clearance = 0.01 if "clearance" in self.extras else 0.0
        for number in range(TRIES):
            smaller = replace(around, scale=0.8**number)
            shapes = [shape for kind in self.kinds for shape in KINDS[kind](smaller)]
            obstacles = [Obstacle(f"obstacle {index}", shape) for index, shape in enumerate(shapes)]
            if "wider" in self.extras:
                obstacles[-1] = Obstacle(obstacles[-1].name, shapes[-1], clearance=0.02)
            names = {obstacles[int(rng.integers(len(obstacles)))].name} if "allowed" in self.extras else set()
            allowed = frozenset((link, name) for link in bodied[: 1 + len(bodied) // 3] for name in names)
            scene = er.Scene(obstacles, limits=limits, allowed=allowed)
            world = ArmWorld(in_scene(robot, scene), scene, clearance=clearance)
            q = world.space.from_cube(rng.random((200, world.space.cube_dim)))
            free = q[world.valid(q)]
            if len(free) > 1:
                return Question(world, free[0], free[-1], bodied[-1] if "kept" in self.extras else "")
        return None


def kept(question: Question, path: np.ndarray) -> object:
    """Return the world of a question in which a link stays near a box around where it is at the waypoints."""
    if not question.kept:
        return question.world
    robot = question.world.robot
    at = link_poses(robot, path)[:, robot.links.index(question.kept), :3, 3]
    low, high = at.min(axis=0), at.max(axis=0)
    keep = KeepInBox(tuple(low.tolist()), tuple(high.tolist()), within=0.01 + float(np.ptp(at, axis=0).max()))
    return KeptWorld(question.world, (keep.bound(robot, path[0], question.kept),))


def driven(result: er.PlanResult) -> np.ndarray:
    """Return the states of a trajectory along a path, which rounds its corners."""
    dim = len(result.start)
    trajectory = result.trajectory(Limits((2.0,) * dim, (4.0,) * dim), deviation=0.05)
    return np.asarray(trajectory.positions)
