"""Solids of every kind of obstacle, with their distances in closed form: boxes stand for all of them.

The arm is a ball on two axes through the origin and a slide, so that configurations are places, and it reaches to
`REACH` in every direction.
"""

from dataclasses import dataclass, replace

import numpy as np
import trimesh
import yaml

import evenroad as er
from evenroad.geometry import Mesh, Pose, TriangleMesh, rotation_from_rpy
from evenroad.geometry.mesh import convex_hull, height_map, merged
from evenroad.geometry.pose import IDENTITY
from evenroad.geometry.shapes import Capsule
from evenroad.robots.joint import Joint
from evenroad.robots.robot import Robot
from tests.geometry.octomaps import octomap
from tests.robots.kernel_arms import STRAIGHT, Y, Z
from tests.robots.surface_scenes import from_trimesh, half_turned

RADIUS, LONG = 0.004, 1.0
REACH = RADIUS + LONG


def ball_arm(radius=RADIUS):
    """A ball at the end of a slide that turns about z, then y."""
    links = ("base", "turning", "bending", "tip")
    joints = (
        Joint("yaw", "revolute", *links[0:2], (0, 0, 0), STRAIGHT, Z, -np.pi, np.pi, 1.0),
        Joint("pitch", "revolute", *links[1:3], (0, 0, 0), STRAIGHT, Y, 0.0, np.pi, 1.0),
        Joint("slide", "prismatic", *links[2:4], (0, 0, 0), STRAIGHT, Z, 0.0, LONG, 1.0),
    )
    ball = Capsule((0, 0, 0), (0, 0, 0), radius, link="tip")
    return Robot("ball", links, joints, (ball,), (), ("yaw", "pitch", "slide"))


def at(places):
    """The configurations with the ball at places, (n, 3), within reach."""
    x, y, z = places.T
    return np.stack([np.arctan2(y, x), np.arctan2(np.hypot(x, y), z), np.linalg.norm(places, axis=1)], axis=1)


def to_box(places, size, pose):
    """Signed distances of places, (n, 3), from a box: negative inside."""
    out = np.abs((places - pose.xyz) @ np.reshape(pose.rotation, (3, 3))) - 0.5 * np.array(size)
    return np.linalg.norm(np.maximum(out, 0.0), axis=1) + np.minimum(out.max(axis=1), 0.0)


@dataclass(frozen=True)
class Solid:
    """A box; without another one within it, if it is hollow."""

    size: tuple
    pose: Pose = IDENTITY
    hollow: tuple = ()

    def distance(self, places):
        """Signed distances of places, (n, 3): exact outside of the material, and negative in it."""
        return np.maximum(
            to_box(places, self.size, self.pose), -to_box(places, self.hollow, self.pose) if self.hollow else -np.inf
        )

    def mesh(self, inverted=False, facing=1):
        """Its surface; `facing` -1 turns the hollow's the wrong way."""
        parts = [_box(self.size, self.pose, -1 if inverted else 1)]
        if self.hollow:
            parts.append(_box(self.hollow, self.pose, facing if inverted else -facing))
        return merged(tuple(parts))


def _box(size, pose, facing):
    mesh = from_trimesh(trimesh.creation.box(size))
    return TriangleMesh(pose.apply(mesh.vertices), mesh.triangles[:, ::facing])


def distance(solids, places):
    """Signed distances of places, (n, 3), from the nearest of some solids."""
    return np.min([each.distance(places) for each in solids], axis=0)


def beyond(away, wide=3.2, turn=(0.0, 0.0, 0.0)):
    """A block whose near face is at a distance from the origin, in a direction."""
    rotation = rotation_from_rpy(*turn)
    return Solid((wide,) * 3, Pose(tuple(np.reshape(rotation, (3, 3)) @ (away + 0.5 * wide, 0.1, -0.2)), rotation))


def wedge(away):
    """A block of which one corner is in reach."""
    return Solid((2.0,) * 3, Pose((away + 1.0,) * 3))


def meshes(*solids, change=lambda mesh: mesh, **turns):
    """A scene of one mesh."""
    return er.Scene([Mesh(change(merged(tuple(each.mesh(**turns) for each in solids))))])


def doubled(mesh):
    """Every triangle twice, once for each side."""
    return TriangleMesh(mesh.vertices, np.concatenate([mesh.triangles, mesh.triangles[:, ::-1]]))


def with_collapsed(mesh):
    """Some triangles more, without an area."""
    return TriangleMesh(mesh.vertices, np.concatenate([mesh.triangles, mesh.triangles[:5, [0, 0, 1]]]))


def with_sheets(mesh):
    """Open sheets across the inside, which bound nothing."""
    rng = np.random.default_rng(0)
    corners = rng.uniform(-0.9, 0.9, (40, 1, 3)) + rng.uniform(-0.05, 0.05, (40, 3, 3))
    sheets = TriangleMesh(corners.reshape(-1, 3), np.arange(120).reshape(-1, 3))
    return merged((mesh, sheets))


def scene_from(folder, entry):
    """A scene of one entry of a file."""
    (folder / "scene.yaml").write_text(yaml.safe_dump({"obstacles": {"it": entry}}))
    return er.load_scene(folder / "scene.yaml")


def exported(folder, name, solids, convex=False):
    """A scene of a mesh's file: `include` of a glTF, or a shape of any other."""
    whole = merged(tuple(each.mesh() for each in solids))
    mesh = trimesh.Trimesh(whole.vertices, whole.triangles, process=False)
    if name.endswith(".glb"):
        mesh.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * np.pi, (1, 0, 0)))
        mesh.export(folder / name)
        return scene_from(folder, {"include": name})
    mesh.export(folder / name)
    return scene_from(folder, {"shape": "mesh", "file": name, **({"convex": True} if convex else {})})


def in_a_urdf(folder, solids):
    exported(folder, "body.obj", solids)
    (folder / "body.urdf").write_text(
        "<robot name='b'><link name='l'><collision><geometry><mesh filename='body.obj'/></geometry></collision></link>"
        "</robot>"
    )
    return scene_from(folder, {"include": "body.urdf"})


def in_moveit(folder, solids):
    mesh = merged(tuple(each.mesh() for each in solids))
    body = {
        "id": "it",
        "meshes": [{"vertices": mesh.vertices.tolist(),
                    "triangles": [{"vertex_indices": row} for row in mesh.triangles.tolist()]}],
        "mesh_poses": [{"position": [0, 0, 0], "orientation": [0, 0, 0, 1]}],
    }  # fmt: skip
    (folder / "moveit.yaml").write_text(yaml.safe_dump({"world": {"collision_objects": [body]}}))
    return er.load_scene(folder / "moveit.yaml")


def in_an_octomap(folder):
    """Cells of half a metre: a wall of three times six."""
    cells = [(1, y, z) for y in range(-3, 3) for z in range(-1, 2)]
    return scene_from(folder, {"include": octomap(folder, cells, resolution=0.5).name})


def ground(folder):
    np.save(folder / "ground.npy", np.full((41, 41), -0.4))
    return scene_from(folder, {"shape": "height_map", "file": "ground.npy", "spacing": 0.1, "xyz": [-2.0, -2.0, 0.0]})


NEAR, FAR, EDGE, TURNED = beyond(0.3), beyond(0.9), beyond(0.9985), beyond(0.5, turn=(0.4, -0.7, 2.0))
CORNER, AROUND = wedge(0.3), Solid((5.0, 5.0, 5.0), Pose((0.3, 0.1, -0.2)))
ROOM = Solid((1.9, 1.8, 1.7), Pose((0.02, 0.01, 0.03)), (1.1, 1.0, 0.9))
OUTER_ROOM = Solid((6.0, 6.0, 6.0), Pose(), (1.4, 1.2, 1.3))
CROSSING = (Solid((0.4, 0.3, 4.0), Pose((0.5, 0, 0))), Solid((4.0, 0.35, 0.3), Pose((0.0, 0.03, 0.35))))
POST = Solid((0.5, 0.5, 0.5), Pose((0.47, 0.4, 0.2)))
SLAB = Solid((4.0, 4.0, 4.0), Pose((0.0, 0.0, -2.4)))
VOXELS = Solid((0.5, 3.0, 1.5), Pose((0.75, 0.0, 0.25)))


def inverted_one():
    return Mesh(merged((CROSSING[0].mesh(), CROSSING[1].mesh(inverted=True))))


SOLIDS = {
    "a block, its face near": (lambda f: meshes(NEAR), [NEAR]),
    "a block, its face far": (lambda f: meshes(FAR), [FAR]),
    "a block, its face at the edge of reach": (lambda f: meshes(EDGE), [EDGE]),
    "a block in a pose": (lambda f: meshes(TURNED), [TURNED]),
    "a corner of a block": (lambda f: meshes(CORNER), [CORNER]),
    "a block around all": (lambda f: meshes(AROUND), [AROUND]),
    "a block around all, faces either way": (lambda f: meshes(AROUND, change=half_turned), [AROUND]),
    "a block turned inside out": (lambda f: meshes(NEAR, inverted=True), [NEAR]),
    "a block in the mirror": (
        lambda f: er.Scene([Mesh(NEAR.mesh(), (-1.0, -1.0, -1.0))]),
        [replace(NEAR, pose=Pose(tuple(-np.array(NEAR.pose.xyz))))]),
    "a block, faces either way": (lambda f: meshes(NEAR, change=half_turned), [NEAR]),
    "a block with two sides": (lambda f: meshes(NEAR, change=doubled), [NEAR]),
    "a block with collapsed triangles": (lambda f: meshes(NEAR, change=with_collapsed), [NEAR]),
    "bars that cross": (lambda f: meshes(*CROSSING), CROSSING),
    "bars that cross, one inside out": (lambda f: er.Scene([inverted_one()]), CROSSING),
    "bars that cross, faces either way": (lambda f: meshes(*CROSSING, change=half_turned), CROSSING),
    "a room": (lambda f: meshes(ROOM), [ROOM]),
    "a room turned inside out": (lambda f: meshes(ROOM, inverted=True), [ROOM]),
    "a room, faces either way": (lambda f: meshes(ROOM, change=half_turned), [ROOM]),
    "a room whose walls reach beyond": (lambda f: meshes(OUTER_ROOM), [OUTER_ROOM]),
    "a room whose shells face one way": (lambda f: meshes(ROOM, facing=-1), [replace(ROOM, hollow=())]),
    "a post in a room, inside out": (
        lambda f: er.Scene([Mesh(merged((OUTER_ROOM.mesh(), POST.mesh(inverted=True))))]), [OUTER_ROOM, POST]),
    "a convex hull": (lambda f: er.Scene([Mesh(convex_hull(TURNED.mesh().vertices))]), [TURNED]),
    "convex: true": (lambda f: exported(f, "body.stl", [NEAR], convex=True), [NEAR]),
    "a glTF that is included": (lambda f: exported(f, "body.glb", [NEAR]), [NEAR]),
    "a URDF that is included": (lambda f: in_a_urdf(f, [NEAR]), [NEAR]),
    "a mesh of MoveIt": (lambda f: in_moveit(f, [NEAR]), [NEAR]),
    "an OctoMap": (lambda f: in_an_octomap(f), [VOXELS]),
    "a height map": (lambda f: ground(f), [SLAB]),
    "a deep height map of Python": (
        lambda f: er.Scene([Mesh(height_map(np.full((5, 5), -0.4), 1.0, (-2.0, -2.0), depth=4.0))]), [SLAB]),
    "a box": (lambda f: er.Scene([er.Box(NEAR.size, pose=NEAR.pose)]), [NEAR]),
    "a plane": (lambda f: scene_from(f, {"shape": "plane", "xyz": [0, 0, -0.4]}), [SLAB]),
}  # fmt: skip
"""Name -> the scene, made in a folder, and the solids that it is."""


def places_of(solids, rng, count):
    """Places within the arm's reach: anywhere, at its end, and near the faces of solids, (n, 3)."""
    ways = rng.normal(size=(count, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    drawn = [ways * LONG * rng.random((count, 1)) ** (1 / 3), ways * (LONG - 0.02 * rng.random((count, 1)) ** 4)]
    for each in solids:
        for size in filter(len, (each.size, each.hollow)):
            on = rng.uniform(-0.5, 0.5, (20 * count, 3))
            axis, off = rng.integers(0, 3, len(on)), np.exp(rng.uniform(np.log(1e-6), np.log(0.03), len(on)))
            on[np.arange(len(on)), axis] = rng.choice((-0.5, 0.5), len(on))
            local = on * size
            local[np.arange(len(on)), axis] += rng.choice((-1.0, 1.0), len(on)) * off
            there = each.pose.apply(local)
            drawn.append(there[np.linalg.norm(there, axis=1) < LONG][:count])
    return np.concatenate(drawn)
