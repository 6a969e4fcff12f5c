"""A robot in a model of MuJoCo for our planners, and a trajectory driven in its physics; extra ``mjcf``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._checks import as_batch, require_extra, require_known
from evenroad.errors import InvalidValue
from evenroad.space import JointSpace
from evenroad.trajectory import Trajectory
from evenroad.world.function import FunctionWorld, TestedAtStates

mujoco = require_extra("mujoco", "mjcf", "evenroad.adapters.mujoco")

MjModel: TypeAlias = Any
MjData: TypeAlias = Any
"""Values of MuJoCo, whose types need the extra."""

_STIFF = 40.0
"""Natural frequency of the servo that drives a joint, critically damped [1/s]."""


@dataclass(frozen=True, eq=False)
class MujocoWorld(TestedAtStates):
    """Joints of a model of MuJoCo, with MuJoCo's contacts, for our planners.

    A configuration is free if no contact of a body that these joints move has a distance below 0.  Contacts that the
    model excludes do not count, nor do those between bodies that stand still, as of a cup on its table.

    Parameters
    ----------
    model : mujoco.MjModel
        The model, as of ``mujoco.MjModel.from_xml_path("scene.xml")``.
    joints : sequence of str, optional
        Hinges and slides that are planned for.  Default: all.
    resolution : float
        Largest distance between checked states of a motion [rad or m].
    qpos : array_like, shape (nq,), optional
        Where everything else stands.  Default: the model's own ``qpos0``.

    Raises
    ------
    UnknownName
        If the model has no such joint.
    InvalidValue
        If a joint is neither a hinge nor a slide, or a slide has no limits.

    Examples
    --------
    >>> import mujoco
    >>> import evenroad as er
    >>> from evenroad.adapters.mujoco import MujocoWorld
    >>> model = mujoco.MjModel.from_xml_string(
    ...     "<mujoco><worldbody><body><joint name='turn' axis='0 0 1' range='-90 90'/>"
    ...     "<geom type='capsule' fromto='0 0 0 1 0 0' size='.05'/></body></worldbody></mujoco>"
    ... )
    >>> er.plan(MujocoWorld(model), [-1.0], [1.0]).solved
    True
    """

    model: MjModel
    joints: Sequence[str] | None = None
    resolution: float = 0.05
    qpos: npt.ArrayLike | None = None
    space: JointSpace = field(init=False)
    _columns: list[int] = field(init=False, repr=False)
    _moved: Bools = field(init=False, repr=False)
    _states: FunctionWorld = field(init=False, repr=False)

    def __post_init__(self) -> None:
        model = self.model
        single = [int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)]
        names = {model.joint(i).name: i for i in range(model.njnt)}
        joints = tuple(name for name, i in names.items() if model.jnt_type[i] in single)
        for name in self.joints or ():
            require_known("hinge or slide of MuJoCo's model", name, joints)
        joints = joints if self.joints is None else tuple(self.joints)
        numbers = [names[name] for name in joints]
        if not numbers:
            raise InvalidValue("the model has no hinge and no slide that could be planned for")
        limited = model.jnt_limited[numbers].astype(bool)
        hinges = model.jnt_type[numbers] == single[0]
        for name, has_limits, turns in zip(joints, limited, hinges, strict=True):
            if not (has_limits or turns):
                raise InvalidValue(f"slide {name!r} of MuJoCo's model must have a range")
        low, high = np.where(limited, model.jnt_range[numbers].T, [[-math.pi], [math.pi]])
        moved = np.zeros(model.nbody, dtype=np.bool_)
        for body in range(model.nbody):
            moved[body] = moved[model.body_parentid[body]] or body in model.jnt_bodyid[numbers]
        qpos = np.array(model.qpos0 if self.qpos is None else self.qpos, dtype=np.float64)
        if qpos.shape != (model.nq,):
            raise InvalidValue(f"qpos must have the shape ({model.nq},), got {qpos.shape}")
        set_fields(
            self,
            joints=joints,
            qpos=qpos,
            space=JointSpace(tuple(low.tolist()), tuple(high.tolist()), tuple((~limited).tolist())),
            _columns=model.jnt_qposadr[numbers].tolist(),
            _moved=moved,
        )
        set_fields(self, _states=FunctionWorld(self.space, self._free, self.resolution))

    @property
    def proof(self) -> str:
        """Proof of a motion: states close together."""
        return self._states.proof

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are free at states much closer together: (p - 1,)."""
        return self._states.validate(path)

    def explain(self, q: Floats) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        touching = self._touching(mujoco.MjData(self.model), as_batch("q", np.reshape(q, (1, -1)), self.space.dim)[0])
        names = [" touches ".join(repr(_name_of(self.model, geom)) for geom in pair) for pair in touching]
        return ", ".join(names) or self._states.explain(q)

    def _free(self, q: Floats) -> Bools:
        # Data of its own: threads may share a world.
        data = mujoco.MjData(self.model)
        return np.array([not self._touching(data, row) for row in q], dtype=np.bool_)

    def _touching(self, data: MjData, row: Floats) -> list[tuple[int, int]]:
        data.qpos[:] = self.qpos
        data.qpos[self._columns] = row
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_collision(self.model, data)
        return touching_pairs(self.model, data, self._moved)


@dataclass(frozen=True)
class Driven:
    """A trajectory as MuJoCo's physics drove it.

    `positions`, (n, dim), are the joints at its times [rad or m], `largest_error` is the largest distance of a joint
    from where it should be, and `contacts` are the pairs of geoms that touched, with a joint's body among them.
    """

    positions: Floats
    largest_error: float
    contacts: tuple[tuple[str, str], ...]


def drive(world: MujocoWorld, trajectory: Trajectory) -> Driven:
    """Return how the model moves when its joints are driven along a trajectory, by inverse dynamics and a servo.

    Gravity, inertia and contacts are MuJoCo's; the model's actuators are left alone.

    Parameters
    ----------
    world : MujocoWorld
        The model; its `qpos` is where everything else begins.
    trajectory : Trajectory
        Its joints are those of the world, in any order.

    Raises
    ------
    UnknownName
        If the trajectory moves a joint that the world does not.
    """
    model, joints = world.model, list(world.joints or ())
    for name in trajectory.names:
        require_known("joint of the world", name, joints)
    order = [joints.index(name) for name in trajectory.names]
    columns = [world._columns[i] for i in order]
    dofs = [int(model.joint(joints[i]).dofadr[0]) for i in order]
    data = mujoco.MjData(model)
    data.qpos[:] = world.qpos
    data.qpos[columns] = trajectory.positions[0]
    seen: list[Floats] = []
    contacts: set[tuple[str, str]] = set()
    for time in trajectory.times:
        while data.time < time - 0.5 * model.opt.timestep:
            share = [np.interp(data.time, trajectory.times, column) for column in trajectory.positions.T]
            speed = [np.interp(data.time, trajectory.times, column) for column in trajectory.velocities.T]
            wanted = np.array([np.interp(data.time, trajectory.times, column) for column in trajectory.accelerations.T])
            wanted += _STIFF**2 * (share - data.qpos[columns]) + 2.0 * _STIFF * (speed - data.qvel[dofs])
            data.qfrc_applied[dofs] = _forces(model, data, dofs, wanted)
            mujoco.mj_step(model, data)
            for pair in touching_pairs(model, data, world._moved):
                one, other = sorted(_name_of(model, geom) for geom in pair)
                contacts.add((one, other))
        seen.append(data.qpos[columns].copy())
    positions = np.array(seen)
    error = float(np.abs(positions - trajectory.positions).max())
    return Driven(positions, error, tuple(sorted(contacts)))


def _forces(model: MjModel, data: MjData, dofs: Sequence[int], accelerations: Floats) -> Floats:
    """Return the forces of joints that give them accelerations, against gravity and inertia, without contacts."""
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    wanted = np.zeros(model.nv)
    wanted[dofs] = accelerations
    forces = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, forces, wanted)
    total: Floats = (forces + data.qfrc_bias - data.qfrc_passive)[dofs]
    return total


def touching_pairs(model: MjModel, data: MjData, moved: Bools) -> list[tuple[int, int]]:
    """Return the pairs of geoms that overlap, at least one of which a planned joint moves."""
    contacts = data.contact
    pairs = zip(contacts.geom1.tolist(), contacts.geom2.tolist(), (contacts.dist < 0.0).tolist(), strict=True)
    body = model.geom_bodyid
    return [(one, other) for one, other, overlap in pairs if overlap and (moved[body[one]] or moved[body[other]])]


def _name_of(model: MjModel, geom: int) -> str:
    own = model.geom(geom).name
    return str(own or f"{model.body(model.geom_bodyid[geom]).name or 'world'} (geom {geom})")
