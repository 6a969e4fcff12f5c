"""Reading an MJCF file: the tree and the collision geometry that MuJoCo compiles from it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_extra
from evenroad.errors import BrokenFile
from evenroad.geometry.mesh import TriangleMesh, convex_hull
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, Shape, shape_of
from evenroad.loading.description import RobotDescription, as_tree, require_few_links
from evenroad.loading.mjcf_contacts import Contacts, contacts_of, untested_pairs
from evenroad.loading.mjcf_equalities import with_equalities
from evenroad.loading.mjcf_guard import require_bounded
from evenroad.loading.mjcf_model import CompiledMjcf
from evenroad.loading.mjcf_states import keyframes, note_left_out
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.xml_file import read_xml
from evenroad.robots.joint import Joint, Kind
from evenroad.robots.planes import DEPTH, SIDE, Plane

_FAR = 1e6
"""Limits of prismatic joints without limits [m]."""
_KINDS: dict[str, Kind] = {"hinge": "revolute", "slide": "prismatic"}


def read_mjcf(file: RobotFile) -> RobotDescription:
    """Read an MJCF file with MuJoCo, whose defaults, includes, frames and rules of contact are its own.

    Bodies are links and keep their names.  A body with several joints, or with one whose anchor is not its origin, has
    links without a body before it.  A free joint, or a ball, stays as it is drawn; a linear equality of two joints
    makes a mimic.  Keyframes are named states.

    A mesh is its convex hull, as in MuJoCo; margins are part of what has them.  Geoms that collide with nothing are no
    bodies.  Two links are tested where MuJoCo looks for contacts: ``contype``, ``conaffinity``, ``<exclude>``,
    ``<pair>``, and parents with their children.  Geoms of one body that differ in this are two links, fixed to each
    other.  A plane stands in every scene that the robot is in.

    Raises BrokenFile if the file is missing, MuJoCo does not take it, or it closes a loop; NotAvailable if MuJoCo is
    not installed.
    """
    read_xml(file.path, "robot", "an MJCF", "mujoco")
    require_bounded(file.path)
    mujoco = require_extra("mujoco", "mjcf", f"{file.path} is an MJCF, which")
    try:
        spec = mujoco.MjSpec.from_file(str(file.path))
        # Memory for a simulation, which is none of ours; before 3.4 MuJoCo took no such number.
        with suppress(TypeError):
            spec.memory = -1
        model = spec.compile()
    except (ValueError, RuntimeError) as error:
        said = " ".join(str(error).split())
        raise BrokenFile(f"MuJoCo cannot read {file.path}: {said}") from error
    require_few_links(model.nbody, len(set(model.geom_bodyid.tolist())), file.path)
    return _Reader(CompiledMjcf(mujoco, model, str(file.path)), file, spec.modelname).urdf()


class _Reader:
    """A compiled model, and the links and joints made of it."""

    def __init__(self, mjcf: CompiledMjcf, file: RobotFile, name: str) -> None:
        self.mjcf, self.file, self.name = mjcf, file, name
        self.model, self.notes = mjcf.model, mjcf.notes
        self.links = [mjcf.name("body", i) for i in range(self.model.nbody)]
        self.kinds = [mjcf.kind_of("mjtGeom", "mjGEOM_", kind) for kind in self.model.geom_type]

    def urdf(self) -> RobotDescription:
        model, links = self.model, list(self.links)
        joints: list[Joint] = []
        for body in range(1, model.nbody):
            for joint in self._joints_of(body):
                joints.append(joint)
                if joint.child not in links:
                    links.append(joint.child)
        joints = with_equalities(self.mjcf, joints)
        bodies, drawn = self._bodies()
        contacts = contacts_of(self.mjcf, drawn)
        solid = [geom for geom in bodies if self.kinds[geom] not in ("plane", "hfield")]
        geoms = self._by_link(solid, contacts)
        for link in geoms:
            if link not in links:
                links.append(link)
                body = self.links[model.geom_bodyid[geoms[link][0]]]
                joints.append(Joint(f"{link}/fixed", "fixed", body, link, IDENTITY.xyz, IDENTITY.rotation))
        shapes = [self._shape(geom, link, contacts.grown[geom]) for link in geoms for geom in geoms[link]]
        bare = {self.links[model.geom_bodyid[geom]] for geom in range(model.ngeom) if geom not in bodies}
        bare -= {self.links[model.geom_bodyid[geom]] for geom in bodies}
        still = {links[0]}
        for joint in joints:
            still |= {joint.child} if joint.kind == "fixed" and joint.parent in still else set()
        moving = {link: of for link, of in geoms.items() if link not in still}
        planes = self._planes([geom for geom in bodies if geom not in solid], geoms, moving, contacts)
        self._note(solid, contacts)
        note_left_out(self.mjcf)
        states = keyframes(self.mjcf)
        drawn_only = tuple(link for link in self.links[1:] if link in bare)
        tree = as_tree(self.name, links, joints, shapes, self.mjcf.where, drawn_only, self.notes)
        untested = None if self.file.as_drawn else untested_pairs(contacts, geoms)
        return replace(tree, untested=untested, planes=planes, states=states)

    def _bodies(self) -> tuple[list[int], list[int]]:
        """Return the geoms that are bodies, and which of these are only drawn."""
        model = self.model
        paired = {*model.pair_geom1.tolist(), *model.pair_geom2.tolist()}
        solid = [
            geom
            for geom in range(model.ngeom)
            if model.geom_contype[geom] or model.geom_conaffinity[geom] or geom in paired
        ]
        others = sorted(set(range(model.ngeom)).difference(solid))
        if self.file.as_drawn:
            seen = {int(model.geom_bodyid[geom]) for geom in others}
            return sorted(others + [geom for geom in solid if model.geom_bodyid[geom] not in seen]), []
        bodied = {int(model.geom_bodyid[geom]) for geom in solid}
        drawn = [geom for geom in others if self.file.use_visuals and model.geom_bodyid[geom] not in bodied]
        if drawn:
            links = dict.fromkeys(self.links[model.geom_bodyid[geom]] for geom in drawn)
            self.notes.append(f"what is drawn of a link is its body: {', '.join(links)}")
        return sorted(solid + drawn), drawn

    def _by_link(self, geoms: Sequence[int], contacts: Contacts) -> dict[str, list[int]]:
        """Return the geoms of every link; those of a body that do not collide with the same are links of their own."""
        of_link: dict[str, list[int]] = {}
        for geom in geoms:
            link = self.links[self.model.geom_bodyid[geom]]
            own = f"{link}/{self.mjcf.name('geom', geom)}"
            for name in (link, *(each for each in of_link if each.startswith(f"{link}/")), own):
                same = of_link.setdefault(name, [geom])[0]
                if self.file.as_drawn or (contacts.collide[same] == contacts.collide[geom]).all():
                    of_link[name] = list(dict.fromkeys([*of_link[name], geom]))
                    break
        return of_link

    def _joints_of(self, body: int) -> Iterator[Joint]:
        """Yield the joints that lead to a body from its parent, one after the other."""
        model, link = self.model, self.links[body]
        pose = _pose(model.body_pos[body], model.body_quat[body])
        parent, anchor = self.links[model.body_parentid[body]], IDENTITY
        first, count = model.body_jntadr[body], model.body_jntnum[body]
        for number in range(first, first + count):
            name = self.mjcf.name("joint", number)
            kind = self.mjcf.kind_of("mjtJoint", "mjJNT_", model.jnt_type[number])
            if kind not in _KINDS:
                said = "free" if kind == "free" else "a ball"
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

    def _shape(self, geom: int, link: str, grown: float) -> Shape:
        model, kind = self.model, self.kinds[geom]
        pose = _pose(model.geom_pos[geom], model.geom_quat[geom])
        a, b, c = model.geom_size[geom].tolist()
        if kind in ("mesh", "sdf"):
            return Mesh(self._mesh(int(model.geom_dataid[geom]), grown), pose=pose, link=link)
        if kind == "sphere":
            return shape_of(kind, (a + grown,), pose, link)
        if kind in ("capsule", "cylinder"):
            return shape_of(kind, (a + grown, 2.0 * (b + grown * (kind == "cylinder"))), pose, link)
        if kind == "ellipsoid":
            self.notes.append(f"the ellipsoid of {link!r} is taken as the box around it")
        a, b, c = (2.0 * (half + grown) for half in (a, b, c))
        return shape_of("box", (a, b, c), pose, link)

    def _mesh(self, number: int, grown: float) -> TriangleMesh:
        """Return the hull of a compiled mesh, or all of its triangles where it is drawn."""
        model, name = self.model, self.mjcf.name("mesh", number)
        first, count = model.mesh_vertadr[number], model.mesh_vertnum[number]
        vertices = np.array(model.mesh_vert[first : first + count], dtype=np.float64)
        if not self.file.as_drawn:
            return convex_hull(vertices, name, grown)
        first, count = model.mesh_faceadr[number], model.mesh_facenum[number]
        return TriangleMesh(vertices, np.array(model.mesh_face[first : first + count], dtype=np.int64), name)

    def _planes(
        self,
        geoms: Sequence[int],
        links: dict[str, list[int]],
        moving: dict[str, list[int]],
        contacts: Contacts,
    ) -> tuple[Plane, ...]:
        """Return the planes, each with those links that are not tested against it; height fields are left out."""
        model, planes = self.model, []
        data = self.mjcf.mujoco.MjData(model)
        self.mjcf.mujoco.mj_kinematics(model, data)
        for geom in geoms:
            link, kind = self.links[model.geom_bodyid[geom]], self.kinds[geom]
            if kind == "hfield":
                self.notes.append(f"the hfield of {link!r} is left out: a scene says what is around the robot")
                continue
            name = str(model.geom(geom).name) or f"plane_{geom}"
            # A plane is no thicker for its margin, but begins earlier.
            turned = data.geom_xmat[geom].tolist()
            plane_pose = Pose(tuple(data.geom_xpos[geom].tolist()), tuple(turned)) @ Pose(
                (0.0, 0.0, contacts.grown[geom])
            )
            tested = {link for link, of in moving.items() if contacts.collide[geom, of].any()}
            untested = tuple(link for link in links if link not in tested)
            planes.append(Plane(name, plane_pose.xyz, plane_pose.rotation, untested))
            self.notes.append(
                f"the plane {name!r} stands in every scene, as a box of {SIDE:g} x {SIDE:g} m, {DEPTH:g} m deep"
            )
        return tuple(planes)

    def _note(self, solid: Sequence[int], contacts: Contacts) -> None:
        """Note how bodies collide where users may not expect it."""
        if self.file.as_drawn:
            return
        grown = contacts.grown[list(solid)]
        if grown.max(initial=0.0) > 0.0:
            self.notes.append(f"margins of up to {grown.max():g} m are part of the bodies that have them")
        if len(solid) > 1 and not contacts.collide[np.ix_(solid, solid)].any():
            self.notes.append("by contype, conaffinity and excludes of the file no two of its bodies ever collide")
        if int(self.model.opt.disableflags) & int(self.mjcf.mujoco.mjtDisableBit.mjDSBL_CONTACT):
            self.notes.append("the file switches contacts off: they are tested nevertheless")


def _pose(xyz: Floats, quaternion: Floats) -> Pose:
    # MuJoCo's quaternions begin with w.
    return Pose.from_quaternion(xyz.tolist(), xyzw=np.roll(quaternion, -1).tolist())
