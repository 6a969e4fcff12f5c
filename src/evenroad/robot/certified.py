"""Certified motions: proved free everywhere, not only at the states that were looked at.

A joint that turns by dq moves a point of the robot by at most |dq| times the point's distance from its axis,
one that slides by |dq|.  Let ``arm_cj`` bound that distance, over all configurations, for the segment inside
capsule c (``evenroad.robot.kernel.reach``).  While a motion goes from share t to share u of its way dq,
straight in the joints, the segment's points then move by at most

    |u - t| D_c,    D_c = sum_j arm_cj |dq_j|,

and the segments c and e of one robot against each other by at most ``|u - t| D_ce``, whose sum runs over the
joints that carry one of the two and not the other: a common one moves both as one body.

If at share t every capsule is farther than ``h D_c`` from every obstacle, and every pair farther apart than
``h D_ce``, then nothing touches between the shares t - h and t + h.  So the motion's middle is tested with those
margins, h one half; where that fails the motion is halved, and so on.  (The idea is that of F. Schwarzer,
M. Saha and J.-C. Latombe, Adaptive Dynamic Collision Checking, 2005.)  Distances are those of the
model: exact between capsules, and to obstacles from spheres that cover them, in double precision.

"No" means blocked, or that somewhere the clearance is too small to tell.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_positive
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel.certify import motions_certified
from evenroad.robot.kernel.model import ArmModel
from evenroad.robot.kernel.reach import joint_arms
from evenroad.space import JointSpace
from evenroad.space.batch import as_batch_pair


@dataclass(frozen=True, eq=False)
class CertifiedWorld:
    """An arm's world whose motions are free only where that is proved, with no gap between states.

    Motions are first tested at the states of `world`, which finds most of the blocked ones fast; the others
    are certified.  For a roadmap whose every edge is proved, plan in this world instead of the other.

    Parameters
    ----------
    world : ArmWorld
        The robot and its scene.
    tolerance : float
        Where a motion comes nearer than about this to contact it is not called free, > 0 [m].  Smaller ones
        cost more time for motions that pass close by.

    Raises
    ------
    InvalidValue
        If `tolerance` is not such a number.
    """

    world: ArmWorld
    tolerance: float = 1e-4
    _arms: npt.NDArray[np.float64] = field(init=False, repr=False)
    _pair_arms: npt.NDArray[np.float64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "tolerance", require_positive("tolerance", self.tolerance))
        arms, pair_arms = _arms_by_coordinate(self.world)
        object.__setattr__(self, "_arms", arms)
        object.__setattr__(self, "_pair_arms", pair_arms)

    @property
    def space(self) -> JointSpace:
        """The space of the world inside."""
        return self.world.space

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return what the world inside says of configurations, (n, dim): (n,)."""
        return self.world.valid(q)

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which motions, from each row of `a` to that of `b`, two (m, dim) arrays, are proved free: (m,).

        Raises
        ------
        InvalidValue
            As for :class:`ArmWorld`.
        """
        first, second = as_batch_pair(a, b, self.space.dim)
        proved = self.world.motion_valid(first, second)
        open_ones = np.flatnonzero(proved)
        tables = self.world.tables
        proved[open_ones] = motions_certified(
            _read_only(first[open_ones]),
            _read_only(second[open_ones]),
            self.tolerance,
            self.world.bounds,
            tables.ints,
            tables.floats,
            self._arms,
            self._pair_arms,
        )
        return proved

    def explain(self, q: npt.NDArray[np.float64]) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        return self.world.explain(q)


def _arms_by_coordinate(world: ArmWorld) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return how fast coordinates move capsules, (capsules, dim), and pairs against each other, (pairs, dim)."""
    model: ArmModel = world.model
    by_frame = joint_arms(model.tree, model.capsules, world.robot)
    pairs = world.tables.capsule_pairs
    first, second = (by_frame[[pair[end] for pair in pairs]].reshape(-1, by_frame.shape[1]) for end in (0, 1))
    carried = [_carriers(model, capsule.frame) for capsule in model.capsules]
    common = np.zeros(first.shape, dtype=np.bool_)
    for row, (i, k) in zip(common, pairs, strict=True):
        row[[number - 1 for number in carried[i] & carried[k]]] = True
    pair_by_frame = np.where(common, 0.0, first + second)
    to_coordinate = np.zeros((by_frame.shape[1], world.space.dim))
    for column, frame in enumerate(model.tree.frames):
        to_coordinate[column, frame.coordinate] = 1.0
    return _read_only(by_frame @ to_coordinate), _read_only(pair_by_frame @ to_coordinate)


def _carriers(model: ArmModel, number: int) -> set[int]:
    """Return the numbers of the moving frames that carry what is fixed to a frame, itself included."""
    carriers = set()
    while number > 0:
        carriers.add(number)
        number = model.tree.frames[number - 1].parent
    return carriers


def _read_only(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    array = np.ascontiguousarray(array)
    array.setflags(write=False)
    return array
