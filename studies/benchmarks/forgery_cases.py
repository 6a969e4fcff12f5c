"""Certificates of every kind, small enough to be checked in milliseconds, whose claims an oracle can judge."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import trimesh
from tests.certificates.no_path import TIP, Place, at, flat_arm, posts
from tests.certificates.no_path import Parts as NoPathParts
from tests.certificates.written import Written, box_reach, parts_of, shelf
from tests.robots.oracle import clearance, link_poses

import evenroad as er
from evenroad.certificates.certify import Sources, certify
from evenroad.certificates.certify_pairs import certify_pairs
from evenroad.certificates.link_pairs import Links, untested_pairs
from evenroad.certificates.no_path import certify_no_path
from evenroad.certificates.robot_files import ReadRobot
from evenroad.constraints import KeepInBox, KeepUpright
from evenroad.constraints.constrained_world import kept_world
from evenroad_verify.certificate import read_certificate
from evenroad_verify.claim import Inputs, read_inputs
from evenroad_verify.no_path import MAGIC as OF_NO_PATH
from evenroad_verify.no_path import read_no_path

CONTACT = 2e-6
ARM = """<robot name="arm">
  <link name="base"><collision><origin xyz="0 0 -0.4"/><geometry><sphere radius="0.3"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><capsule radius="0.05" length="0.7"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0.4 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3"/></joint>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="1 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
</robot>
"""
SRDF = """<robot name="arm"><disable_collisions link1="base" link2="upper"/>
  <disable_collisions link1="upper" link2="fore"/></robot>
"""
PATH = np.array([[-0.5, 0.2], [0.1, 0.5], [0.5, -0.3]])
SOLID = """obstacles:
  wall: {shape: box, size: [0.2, 0.4, 0.3], xyz: [1.65, 0.0, 0.0], rpy: [0.0, 0.3, 0.1]}
  post: {shape: cylinder, radius: 0.05, length: 1.0, xyz: [0.7, -0.75, 0.0]}
  ball: {shape: sphere, radius: 0.1, xyz: [0.4, 0.6, 0.3]}
  table: {shape: box, size: [1.0, 1.0, 0.1], xyz: [0.0, 0.0, -0.75]}
allowed:
  table: [base]
limits:
  turn: [-1.5, 1.5]
"""
MESH = "obstacles:\n  wall: {shape: mesh, file: wall.stl, xyz: [1.65, 0.1, 0.0]}\n"
PIECES = MESH.replace("xyz", "clearance: 0.001, xyz")
"""A box in an open shell around all, with a triangle that comes twice at a corner of the shell."""
CLOUD = "obstacles:\n  scan: {shape: cloud, file: scan.xyz, radius: 0.02, xyz: [1.6, 0.0, 0.0]}\n"


@dataclass(frozen=True)
class Case:
    """A certificate, its files in a folder, and a judge of what it claims: whether that is false."""

    name: str
    data: bytes
    sources: Sources
    is_false: Callable[[bytes, Sources], bool]

    def inputs(self, data: bytes, sources: Sources | None = None) -> Inputs:
        """Return what the checker in Python reads of files, or of what a certificate carries in their place."""
        files, carrier = sources or self.sources, None
        if self.carries:
            carrier = read_no_path(data).terminals if self.of_no_path else read_certificate(data)
        return read_inputs(files.robot, files.scene, files.srdf, {}, carrier)

    @property
    def carries(self) -> bool:
        return b"\nrobot " in self.data or b"\nscene " in self.data

    @property
    def of_no_path(self) -> bool:
        return self.data.startswith(OF_NO_PATH)


def cases(folder: Path) -> list[Case]:
    """Return a case of each kind; their files are in folders of their own."""
    scenes = {"path": SOLID, "mesh": MESH, "pieces": PIECES, "cloud": CLOUD}
    made = [_arm(folder / name, name, scene) for name, scene in scenes.items()]
    t = np.linspace(0.0, 1.0, 60)[:, np.newaxis]
    bent = (1 - t) ** 2 * PATH[0] + 2 * t * (1 - t) * PATH[1] + t**2 * PATH[2]
    made += [_arm(folder / "curve", "curve", SOLID, states=bent), _arm(folder / "own", "own", MESH, embed=True)]
    keeps = {"axis": KeepUpright(0.55, "z"), "point": KeepInBox((0.0, -1.0, -1.0), (1.5, 1.0, 1.0), within=0.01)}
    made += [_arm(folder / name, name, SOLID, keep=keep) for name, keep in keeps.items()]
    made += [_no_path(folder, "no path"), _no_path(folder, "no position", True), _no_path(folder, "no pose", False)]
    return [*made, *(_shipped(name, written) for name, written in (("box-reach", box_reach()), ("shelf", shelf())))]


def _shipped(name: str, written: Written) -> Case:
    return Case(name, written.data, written.sources, _is_false)


def _arm(folder: Path, name: str, scene: str, keep=None, states=None, embed: bool = False) -> Case:
    folder.mkdir()
    (folder / "arm.urdf").write_text(ARM)
    (folder / "arm.srdf").write_text(SRDF)
    (folder / "scene.yaml").write_text(scene)
    if scene is MESH:
        trimesh.creation.box((0.2, 0.4, 0.3)).export(folder / "wall.stl")
    if scene is PIECES:
        _wall_in_a_shell().export(folder / "wall.stl")
    if scene is CLOUD:
        rng = np.random.default_rng(5)
        np.savetxt(folder / "scan.xyz", rng.uniform((-0.02, -0.3, -0.3), (0.02, 0.3, 0.3), (40, 3)), "%.9f")
    sources = Sources(folder / "arm.urdf", folder / "scene.yaml", folder / "arm.srdf", embed=embed)
    world = er.ArmWorld(er.load_robot(sources.robot, srdf=sources.srdf), er.load_scene(sources.scene))
    if keep is not None:
        world = kept_world(world, (keep,), PATH[0], "fore")
    certify(world, PATH, sources, folder / "arm.cert", states=states)
    return Case(name, (folder / "arm.cert").read_bytes(), sources, _is_false)


def _wall_in_a_shell() -> trimesh.Trimesh:
    wall, shell = trimesh.creation.box((0.2, 0.4, 0.3)), trimesh.creation.icosphere(1, 2.2)
    shell.apply_translation((-1.65, -0.1, 0.0))
    corner = shell.triangles[0, 0]
    flap = np.array([[corner, 1.1 * corner, corner * (1.0, 1.05, 1.0)]] * 2)
    corners = np.concatenate([wall.triangles, shell.triangles, flap]).reshape(-1, 3)
    return trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False)


def pairs_case(folder: Path) -> Case:
    """Return a case of pairs that never touch, whose scene, in which there is nothing, is a file; nobody judges it."""
    made = _arm(folder / "pairs", "pairs", "obstacles: {}\n")
    read = ReadRobot(made.sources, ())
    links, file = Links(read.urdf), folder / "pairs" / "pairs.cert"
    certify_pairs(read, links, untested_pairs(links, [("base", "fore", "disabled")], 30.0), file)
    data = file.read_bytes().replace(b"scene -\n", b"")[: -8 - len("obstacles: {}\n")]
    return Case("pairs", data, replace(made.sources, srdf=None), lambda *_: False)


def _no_path(folder: Path, name: str, position_only: bool | None = None) -> Case:
    urdf = flat_arm() if position_only is None else flat_arm().replace("</robot>", TIP)
    place = Place(folder / name, posts(at(0.7, 0.3), at(-0.7, 0.3), at(0.2, 0.86), at(2.9, 0.3)), urdf)
    goals, poses = [[2.0, 0.3], [1.8, 0.1]], []
    if position_only is not None:
        xy = np.array(at(2.0, 0.5)) + at(2.3, 0.4)
        goals, poses = [], [er.PoseGoal(er.Pose((*xy, 0.0), rpy=(0, 0, 2.8)), "tip", position_only=position_only)]
    file = place.folder / "none.cert"
    certify_no_path(place.world, np.array([0.0, 0.3]), np.array(goals).reshape(-1, 2), place.sources, file, poses)
    return Case(name, file.read_bytes(), place.sources, _has_path)


def sampled(data: bytes, count: int) -> np.ndarray:
    """Return states of the curves of a certificate, (n, dim)."""
    lines, points, _, _ = parts_of(data)
    degree = int(next(line for line in lines if line.startswith("degree ")).split()[1])
    first, last = points[:-degree:degree], points[degree::degree]
    middle = points[1::2] if degree == 2 else 0.5 * (first + last)
    t = np.linspace(0.0, 1.0, count)[:, np.newaxis, np.newaxis]
    return ((1 - t) ** 2 * first + 2 * t * (1 - t) * middle + t**2 * last).reshape(-1, points.shape[1])


def _is_false(data: bytes, sources: Sources) -> bool:
    """Return whether the oracle sees a contact, or a constraint that is left, at a state of a path."""
    robot, scene = er.load_robot(sources.robot, srdf=sources.srdf), er.load_scene(sources.scene)
    if any(obstacle.shape in ("mesh", "cloud") for obstacle in scene.obstacles):
        scene = replace(scene, obstacles=[each for obstacle in scene.obstacles for each in _simple(obstacle, sources)])
    q = sampled(data, 30)
    joints = [line[6:] for line in parts_of(data)[0] if line.startswith("joint ")]
    q = q[:, [joints.index(name) for name in robot.group]]
    if clearance(robot, scene, q, samples=25).min() < -CONTACT:
        return True
    for line in parts_of(data)[0]:
        kind, *words = line.split(" ")
        if kind == "axis" and words[-1] in ("upper", "fore"):
            turn, _ = link_poses(robot, q)[words[-1]]
            within, *vectors = map(float, words[:-1])
            a, d = (np.array(each) / np.linalg.norm(each) for each in (vectors[:3], vectors[3:]))
            if np.arccos(np.clip(turn @ a @ d, -1.0, 1.0)).max() > within + 1e-6:
                return True
        if kind == "point" and words[-1] in ("upper", "fore"):
            turn, origin = link_poses(robot, q)[words[-1]]
            within, *values = map(float, words[:-1])
            point, xyzw, low, high = np.split(np.array(values), (3, 7, 10))
            seen = (origin + turn @ point) @ er.Pose((0, 0, 0), xyzw=xyzw).rotation_matrix
            if np.linalg.norm(np.maximum(np.maximum(low - seen, seen - high), 0.0), axis=1).max() > within + CONTACT:
                return True
    return False


def _simple(obstacle, sources: Sources):
    """Return a mesh, whose closed piece is a box, as one, and a cloud as balls."""
    if obstacle.shape == "mesh":
        box, *_ = trimesh.load_mesh(sources.scene.parent / "wall.stl").split(only_watertight=True)
        middle = np.array(obstacle.xyz) + np.array(obstacle.rotation).reshape(3, 3) @ box.bounds.mean(0)
        return [er.Box(tuple(box.extents), xyz=tuple(middle), name=obstacle.name)]
    if obstacle.shape == "cloud":
        rows = np.loadtxt(sources.scene.parent / "scan.xyz")
        radius = float(re.search(r"radius: ([-+.\de]+)", sources.scene.read_text()).group(1))
        return [er.Sphere(radius, xyz=tuple(np.array(obstacle.xyz) + row), name=f"p{i}") for i, row in enumerate(rows)]
    return [obstacle]


def _has_path(data: bytes, sources: Sources) -> bool:
    """Return whether a flood of fine cells joins the start with a goal, or with a posture that reaches a pose."""
    parts = NoPathParts.of(data)
    folder = sources.scene.parent
    place = Place(folder / "judged", sources.scene.read_text(), sources.robot.read_text())
    shutil.rmtree(folder / "judged")
    start, *goals = parts.ends.tolist()
    for line in parts.lines:
        kind, *words = line.split(" ")
        if kind in ("position", "pose") and words[-1] == "tip":
            numbers = list(map(float, words[:-1]))
            x, y = numbers[1:3] if kind == "position" else numbers[2:4]
            goals += [
                [turn, bend] for turn, bend in _postures(x, y) if kind == "position" or _is_turned(numbers, turn + bend)
            ]
    return any(place.joined(start, goal) for goal in goals if np.abs(goal).max() < 3.0)


def _postures(x: float, y: float):
    """Return the two postures that bring the tip of the flat arm to a place, if it is in reach."""
    cosine = (x * x + y * y - 0.5**2 - 0.4**2) / (2 * 0.5 * 0.4)
    for bend in (np.arccos(cosine), -np.arccos(cosine)) if abs(cosine) <= 1.0 else ():
        turn = np.arctan2(y, x) - np.arctan2(0.4 * np.sin(bend), 0.5 + 0.4 * np.cos(bend))
        yield np.remainder(turn + np.pi, 2 * np.pi) - np.pi, bend


def _is_turned(numbers: list[float], angle: float) -> bool:
    z, w = numbers[7:9]
    off = angle + 0.5 - 2.0 * np.arctan2(z, w)
    return abs(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi) <= numbers[1]
