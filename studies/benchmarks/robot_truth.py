"""Verdicts on robots' self-collision against pinocchio and coal on the files' own shapes.

    python -m studies.benchmarks.robot_truth OUT.csv ROBOT.urdf FOLDER ...

For each robot: how many configurations that we call free collide in truth (uniform ones, others bisected to our edge
of contact, and states of paths), how many are blocked here and there, and how many are blocked here alone.  True pairs
are all links with shapes that a moving joint is between, but neighbours and those that touch in every uniform
configuration, nor are among those that the loader names because one goes into the other as drawn.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import combinations
from pathlib import Path

import coal
import numpy as np
import pinocchio
import trimesh
from studies.benchmarks.rows import row_per_robot

from evenroad.geometry.mesh import TriangleMesh
from evenroad.planning.arm_trees import connect, shorten
from evenroad.robot import ArmWorld, Scene, load_model
from evenroad.robots.pairs import CONTAINED
from evenroad.space.path import resample

COUNT = 2000
PATHS = 10
NO_AREA = 1e-12
"""Triangles of a mesh file up to this area are none [m²]."""
FIELDS = (
    *("robot", "dim", "links", "tested", "dropped_touching", "configurations", "truth_blocked", "blocked", "beyond"),
    *("free_that_collide", "at_contact", "at_contact_that_collide", "path_states", "path_states_that_collide"),
    *("hulls", "note"),
)


class Truth:
    """A URDF in pinocchio, its collision shapes in coal."""

    def __init__(self, file: Path, group: tuple[str, ...], held: dict[str, float]) -> None:
        folders = [str(folder) for folder in file.resolve().parents][:8]
        self.model = pinocchio.buildModelFromUrdf(str(file))
        self.geometry = pinocchio.buildGeomFromUrdf(
            self.model, str(file), pinocchio.GeometryType.COLLISION, package_dirs=folders
        )
        self.data = self.model.createData()
        self.group, self.held = group, held
        self.mimics = {joint.get("name"): joint.find("mimic") for joint in ET.parse(file).getroot().findall("joint")}
        self.of_link: dict[str, list[int]] = {}
        for i, item in enumerate(self.geometry.geometryObjects):
            self.of_link.setdefault(self.model.frames[item.parentFrame].name, []).append(i)
        self.pairs = self._pairs(ET.parse(file).getroot())
        self.surfaces: dict[int, np.ndarray] = {}
        self.boxes: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self.convex: set[int] = set()
        self.notes: list[str] = []
        for i, item in enumerate(self.geometry.geometryObjects):
            if isinstance(item.geometry, coal.BVHModelBase):
                self._note_surface(i, item)

    def _note_surface(self, i: int, item: pinocchio.GeometryObject) -> None:
        """Note the triangles, (t, 3, 3), of a closed mesh, and whether it is convex.

        They are those of trimesh's reader: coal 3.0.3 mixes up the corners of a file of several meshes, as of an
        iCub's head.  Slivers are left out: coal calls spheres near them in contact, as deep as their radius.
        """
        read = trimesh.load(item.meshPath, force="mesh", process=False)
        read.apply_scale(item.meshScale)
        read.update_faces(read.area_faces > NO_AREA)
        corners, known = np.array(read.vertices), item.geometry.vertices()
        if np.allclose([corners.min(axis=0), corners.max(axis=0)], [known.min(axis=0), known.max(axis=0)], atol=1e-6):
            model = coal.BVHModelOBBRSS()
            model.beginModel(len(read.faces), len(corners))
            model.addVertices(corners)
            model.addTriangles(np.array(read.faces))
            model.endModel()
            item.geometry = model
        else:
            self.notes.append(f"{Path(item.meshPath).name} as coal reads it")
        mesh = TriangleMesh(corners, np.array(read.faces))
        closed = mesh.closed_parts.closed
        if mesh.closed_parts.oriented and closed.any():
            self.surfaces[i] = mesh.vertices[mesh.triangles[closed]]
            self.boxes[i] = self.surfaces[i].min(axis=(0, 1)), self.surfaces[i].max(axis=(0, 1))
        if mesh.is_convex:
            self.convex.add(i)

    def _pairs(self, root: ET.Element) -> list[tuple[str, str]]:
        above, moves = {}, {}
        for joint in root.findall("joint"):
            child = joint.find("child").get("link")
            above[child], moves[child] = joint.find("parent").get("link"), joint.get("type") != "fixed"

        def way(link: str) -> list[str]:
            return [link] + (way(above[link]) if link in above else [])

        pairs = []
        for first, second in combinations(self.of_link, 2):
            up, down = way(first), way(second)
            between = [link for link in up if link not in down] + [link for link in down if link not in up]
            moving = sum(moves[link] for link in between)
            # What lies between them, both ends of the way left out.
            lower, upper = (second, first) if first in down else (first, second) if second in up else (None, None)
            inner = [link for link in way(lower)[1:] if link in between and link != upper] if lower else []
            neighbours = lower is not None and moving == 1 and not any(link in self.of_link for link in inner)
            if moving and not neighbours:
                pairs.append((first, second))
        return pairs

    def touching(self, q: np.ndarray) -> np.ndarray:
        """Return which pairs touch in which configurations, (n, pairs)."""
        hits = np.zeros((len(q), len(self.pairs)), dtype=bool)
        items = self.geometry.geometryObjects
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        request.enable_contact = True
        middles, radii = self.balls()
        rotation, shift = self.places(q)
        centres = np.einsum("nbij,bj->nbi", rotation, middles) + shift
        every = [
            (column, i, k)
            for column, (first, second) in enumerate(self.pairs)
            for i in self.of_link[first]
            for k in self.of_link[second]
        ]
        _, one, two = np.array(every).T
        for row in range(len(q)):
            solid = [coal.Transform3s(*place) for place in zip(rotation[row], shift[row], strict=True)]
            near = np.linalg.norm(centres[row, one] - centres[row, two], axis=1) <= radii[one] + radii[two]
            for column, i, k in np.array(every)[near].tolist():
                result.clear()
                if not hits[row, column]:
                    pair = items[i].geometry, solid[i], items[k].geometry, solid[k]
                    hits[row, column] = bool(coal.collide(*pair, request, result))
        return hits

    def balls(self) -> tuple[np.ndarray, np.ndarray]:
        """Return centres, (bodies, 3), and radii of balls around the bodies, in their frames."""
        geometries = [item.geometry for item in self.geometry.geometryObjects]
        for each in geometries:
            each.computeLocalAABB()
        return np.array([each.aabb_center for each in geometries]), np.array([each.aabb_radius for each in geometries])

    def places(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return where the bodies are: rotations, (n, bodies, 3, 3), and translations."""
        items, found = self.geometry.geometryObjects, []
        for values in q:
            pinocchio.framesForwardKinematics(self.model, self.data, self._state(values))
            found.append([self.data.oMi[item.parentJoint] * item.placement for item in items])
        rotation = np.array([[place.rotation for place in row] for row in found]).reshape(len(q), len(items), 3, 3)
        return rotation, np.array([[place.translation for place in row] for row in found]).reshape(*rotation.shape[:3])

    def _state(self, values: np.ndarray) -> np.ndarray:
        known = dict(zip(self.group, values.tolist(), strict=True)) | self.held
        state = pinocchio.neutral(self.model)
        for joint in list(self.model.joints)[1:]:
            name, value = self.model.names[joint.id], 0.0
            mimic = self.mimics.get(name)
            if mimic is not None:
                value = float(mimic.get("multiplier", 1)) * known.get(mimic.get("joint"), 0.0)
                value += float(mimic.get("offset", 0))
            value = known.get(name, value)
            if joint.nq == 2:
                state[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
            elif joint.nq == 1:
                state[joint.idx_q] = value
        return state


def measured(file: Path, rng: np.random.Generator) -> dict[str, object]:
    """Return the row of one robot."""
    row: dict[str, object] = {"robot": file.stem}
    model = load_model(file)
    robot = model.robot
    world = ArmWorld(robot, Scene((), name="empty"))
    held = {
        joint.name: robot.held.get(joint.name, joint.neutral)
        for joint in robot.joints
        if joint.kind != "fixed" and joint.mimic is None and joint.name not in robot.group
    }
    truth = Truth(file, robot.group, held)
    q = world.space.from_cube(rng.random((COUNT, world.space.cube_dim)))
    free = world.valid(q)
    hits = truth.touching(q)
    contained = {frozenset((first, second)) for first, second, why in model.dropped if why == CONTAINED}
    counted = ~hits.all(axis=0) & [frozenset(pair) not in contained for pair in truth.pairs]
    collides = hits[:, counted].any(axis=1)
    row |= {
        "dim": len(robot.group),
        "links": len(robot.links),
        "tested": len(robot.pairs),
        "dropped_touching": sum("touch" in why for _, _, why in model.dropped),
        "hulls": len(robot.hulls),
        "configurations": COUNT,
        "truth_blocked": round(100 * collides.mean(), 2),
        "blocked": round(100 * (~free).mean(), 2),
        "beyond": round(100 * (~free & ~collides).mean(), 2),
        "free_that_collide": int((free & collides).sum()),
    }
    if free.any() and not free.all():
        edge = at_contact(world, q[free], q[~free], COUNT, rng)
        row["at_contact"] = len(edge)
        row["at_contact_that_collide"] = int(truth.touching(edge)[:, counted].any(axis=1).sum())
    if free.sum() > 1:
        states = path_states(world, q[free])
        row["path_states"] = len(states)
        row["path_states_that_collide"] = int(truth.touching(states)[:, counted].any(axis=1).sum())
    return row


def at_contact(
    world: ArmWorld, free: np.ndarray, blocked: np.ndarray, count: int, rng: np.random.Generator
) -> np.ndarray:
    """Return free configurations within a billionth of the way of blocked ones."""
    a = free[rng.integers(len(free), size=count)]
    b = blocked[rng.integers(len(blocked), size=count)]
    for _ in range(30):
        middle = 0.5 * (a + b)
        ok = world.valid(middle)[:, np.newaxis]
        a, b = np.where(ok, middle, a), np.where(ok, b, middle)
    return a[world.valid(a)]


def path_states(world: ArmWorld, free: np.ndarray) -> np.ndarray:
    """Return states of shortened paths between free configurations."""
    found = []
    for k in range(min(PATHS, len(free) - 1)):
        connection = connect(world, free[k], free[k + 1 : k + 2], seconds=2.0)
        if len(connection.path) > 1:
            path, _ = shorten(world, connection.path)
            found.append(resample(path, world.space, 0.02)[0])
    return np.concatenate(found)[: 2 * COUNT] if found else free[:0]


def main() -> None:
    """Write a row for each robot as soon as it is there."""
    row_per_robot(FIELDS, "*.urdf", lambda file: measured(file, np.random.default_rng(0)), lambda file: file.stem)


if __name__ == "__main__":
    main()
