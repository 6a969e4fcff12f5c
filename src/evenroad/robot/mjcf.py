"""Reading an MJCF file: the tree and the collision geometry that MuJoCo compiles from it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_extra
from evenroad.errors import BrokenFile
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, Shape, shape_of
from evenroad.robot.joint import Joint, Kind, Mimic
from evenroad.robot.urdf import Urdf, as_tree
from evenroad.robot.urdf_xml import RobotFile, read_xml

_FAR = 1e6
"""Limits of slides that have none [m]."""
_KINDS: dict[str, Kind] = {"mjJNT_HINGE": "revolute", "mjJNT_SLIDE": "prismatic"}


def read_mjcf(file: RobotFile) -> Urdf:
    """Read an MJCF file with MuJoCo, whose defaults, includes and frames are its own.

    Bodies are links and keep their names; of a body with several joints, or with one whose anchor is not its origin,
    links without a body lie between.  A free joint, or a ball, stays as it is drawn; a linear equality of two joints
    makes a mimic.  Geoms that collide with nothing are no bodies.  Raises BrokenFile if the file is missing or MuJoCo
    does not take it, or a mesh is not in a file of its own; NotAvailable if MuJoCo is not installed.
    """
    read_xml(file.path, "robot", "an MJCF", "mujoco")
    mujoco = require_extra("mujoco", "mjcf", f"{file.path} is an MJCF, which")
    try:
        spec = mujoco.MjSpec.from_file(str(file.path))
        model = spec.compile()
    except (ValueError, RuntimeError) as error:
        raise BrokenFile(f"MuJoCo cannot read {file.path}: {error}") from error
    return _Reader(mujoco, spec, model, file).urdf()


class _Reader:
    """A compiled model, and what is made of it."""

    def __init__(self, mujoco: Any, spec: Any, model: Any, file: RobotFile) -> None:
        self.mujoco, self.spec, self.model, self.file = mujoco, spec, model, file
        self.notes: list[str] = []
        self.links = [_name(model.body(i), "body") for i in range(model.nbody)]

    def urdf(self) -> Urdf:
        model, links = self.model, list(self.links)
        joints: list[Joint] = []
        for body in range(1, model.nbody):
            for joint in self._joints_of(body):
                joints.append(joint)
                if joint.child not in links:
                    links.append(joint.child)
        shapes = [shape for geom in range(model.ngeom) if (shape := self._shape(geom)) is not None]
        drawn = {self.links[body] for body in model.geom_bodyid if body} - {shape.link for shape in shapes}
        return as_tree(
            self.spec.modelname,
            links,
            self._with_mimics(joints),
            shapes,
            str(self.file.path),
            tuple(link for link in self.links if link in drawn),
            self.notes,
        )

    def _joints_of(self, body: int) -> Iterator[Joint]:
        """Yield the joints that lead to a body from its parent, one after the other."""
        model, link = self.model, self.links[body]
        pose = _pose(model.body_pos[body], model.body_quat[body])
        parent, anchor = self.links[model.body_parentid[body]], IDENTITY
        first, count = model.body_jntadr[body], model.body_jntnum[body]
        for number in range(first, first + count):
            name = _name(model.joint(number), "joint")
            kind = self.mujoco.mjtJoint(model.jnt_type[number]).name
            if kind not in _KINDS:
                said = "free" if "FREE" in kind else "a ball"
                self.notes.append(f"joint {name!r} of {link!r}, {said}, is fixed")
                continue
            own = Pose(tuple(model.jnt_pos[number].tolist()))
            last = number == first + count - 1 and not model.jnt_pos[number].any()
            child = link if last else f"{link}/{name}"
            origin = pose @ anchor.inverse() @ own
            yield self._joint(number, name, _KINDS[kind], parent, child, origin)
            parent, pose, anchor = child, IDENTITY, own
        if parent != link:
            origin = pose @ anchor.inverse()
            yield Joint(f"{link}/fixed", "fixed", parent, link, origin.xyz, origin.rotation)

    def _joint(self, number: int, name: str, kind: Kind, parent: str, child: str, origin: Pose) -> Joint:
        model = self.model
        x, y, z = model.jnt_axis[number].tolist()
        far = math.inf if kind == "revolute" else _FAR
        lower, upper = model.jnt_range[number].tolist() if model.jnt_limited[number] else (-far, far)
        # The body is drawn where the joint is at its reference.
        reference = float(model.qpos0[model.jnt_qposadr[number]])
        if reference and kind == "revolute":
            half = -0.5 * reference
            origin = origin @ Pose.from_quaternion(
                (0, 0, 0), xyzw=(*(math.sin(half) * part for part in (x, y, z)), math.cos(half))
            )
        elif reference:
            origin = origin @ Pose((-reference * x, -reference * y, -reference * z))
        kind = "continuous" if math.isinf(upper) else kind
        return Joint(name, kind, parent, child, origin.xyz, origin.rotation, (x, y, z), lower, upper)

    def _with_mimics(self, joints: list[Joint]) -> list[Joint]:
        """Return the joints with those mimics that equalities ``q1 = c0 + c1 q2`` make."""
        model, mimics = self.model, {}
        for number in np.flatnonzero(model.eq_type == self.mujoco.mjtEq.mjEQ_JOINT):
            first, second = model.eq_obj1id[number], model.eq_obj2id[number]
            follower = _name(model.joint(first), "joint")
            c0, c1, *others = model.eq_data[number][:5].tolist()
            if second < 0 or any(others):
                self.notes.append(f"an equality of joint {follower!r} is left out: it is not a linear one")
                continue
            at = model.qpos0[model.jnt_qposadr[[first, second]]].tolist()
            mimics[follower] = Mimic(_name(model.joint(second), "joint"), c1, c0 + at[0] - c1 * at[1])
        return [replace(joint, mimic=mimics.get(joint.name)) for joint in joints]

    def _shape(self, geom: int) -> Shape | None:
        model, link = self.model, self.links[self.model.geom_bodyid[geom]]
        kind = self.mujoco.mjtGeom(model.geom_type[geom]).name.removeprefix("mjGEOM_").lower()
        collides = model.geom_contype[geom] or model.geom_conaffinity[geom]
        if not collides and not self.file.use_visuals:
            return None
        pose = _pose(model.geom_pos[geom], model.geom_quat[geom])
        a, b, c = model.geom_size[geom].tolist()
        if kind in ("plane", "hfield"):
            self.notes.append(f"the {kind} of {link!r} is left out: a scene says what is around the robot")
            return None
        if kind == "ellipsoid":
            self.notes.append(f"the ellipsoid of {link!r} is taken as the box around it")
        if kind == "mesh":
            return self._mesh(int(model.geom_dataid[geom]), pose, link)
        sizes = {"sphere": (a,), "capsule": (a, 2 * b), "cylinder": (a, 2 * b)}
        boxed = kind not in sizes
        return shape_of("box" if boxed else kind, (2 * a, 2 * b, 2 * c) if boxed else sizes[kind], pose, link)

    def _mesh(self, number: int, pose: Pose, link: str) -> Mesh:
        """Return a mesh by its file; compiled meshes are moved to their centres, which is undone here."""
        model, mesh = self.model, self.spec.meshes[number]
        path = self.file.path.parent / self.spec.modelfiledir / self.spec.meshdir / mesh.file
        if not mesh.file or not path.is_file():
            raise BrokenFile(
                f"the mesh {mesh.name!r} of link {link!r} in {self.file.path} is missing; looked for {path}"
            )
        moved = _pose(model.mesh_pos[number], model.mesh_quat[number])
        x, y, z = model.mesh_scale[number].tolist()
        return Mesh(path, (x, y, z), pose=pose @ moved.inverse(), link=link)


def _name(element: Any, what: str) -> str:
    return str(element.name) or f"{what}_{element.id}"


def _pose(xyz: Floats, quaternion: Floats) -> Pose:
    # MuJoCo has w first.
    return Pose.from_quaternion(xyz.tolist(), xyzw=np.roll(quaternion, -1).tolist())
