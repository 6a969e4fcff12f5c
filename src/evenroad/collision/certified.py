"""Certified motions: proved free everywhere, not only at the checked states.

A joint that turns by dq moves a point of the robot by at most |dq| times the point's distance from its axis,
one that slides by |dq|.  Let ``arm_cj`` bound that distance, over all configurations, for the segment inside
capsule c (``evenroad.collision.placed_capsules``).  While a motion, by dq in all, goes from share t to u,
straight in the joints, the segment's points then move by at most ``|u - t| D_c``, ``D_c = sum_j arm_cj |dq_j|``, and
the segments c and e of one robot against each other by at most ``|u - t| D_ce``, whose sum runs over the joints that
carry one of the two and not the other: a common one moves both as one body.

If at share t every capsule is farther than ``h D_c`` from every obstacle, and every pair farther apart than ``h D_ce``,
then nothing touches between the shares t - h and t + h.  So the motion's middle is tested with those margins, h one
half; where that fails the motion is halved, and so on, into 2^15 pieces at most (F. Schwarzer, M. Saha and J.-C.
Latombe, Adaptive Dynamic Collision Checking, 2005).  ``D_c`` is lowered to what the motion itself moves the capsule
by: its velocities in the middles of sixteen pieces, and what accelerations, bounded by arms, add to these.  Distances
are those of the model: exact between capsules, and hulls, and to obstacles from spheres that cover them.  Sixteen
pieces are proved at once in single precision, with bodies larger by what that may lose.  "No" means blocked, or that
somewhere the clearance is too small for a proof.
"""

from __future__ import annotations

from dataclasses import dataclass

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._checks import require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad.collision.arm_world import ArmWorld
from evenroad.space import JointSpace
from evenroad.space.batch import as_batch


@dataclass(frozen=True, eq=False)
class CertifiedWorld:
    """An arm's world whose motions are free only where that is proved: for roadmaps with proved edges.

    Motions nearer than about `tolerance` to contact are not proved, > 0 [m]; smaller values cost more time for motions
    that pass close by.
    """

    world: ArmWorld
    tolerance: float = 1e-4

    def __post_init__(self) -> None:
        set_fields(self, tolerance=require_positive("tolerance", self.tolerance))

    @property
    def space(self) -> JointSpace:
        """The space of the wrapped world."""
        return self.world.space

    def valid(self, q: Floats) -> Bools:
        """Check configurations, (n, dim), in the wrapped world: (n,)."""
        free: Bools = self.world.valid(q)
        return free

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, from each row of `a` to that of `b`, two (m, dim) arrays, are proved free: (m,)."""
        return self.world.motion_certified(a, b, self.tolerance)

    @property
    def proof(self) -> str:
        """``certified``: every motion is proved."""
        return "certified"

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are proved free: (p - 1,)."""
        waypoints = as_batch("path", path, self.space.dim)
        return self.motion_valid(waypoints[:-1], waypoints[1:])

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of the wrapped world and the tolerance: equal for worlds of equal results."""
        return fingerprint_of("certified", self.world.fingerprint(), self.tolerance)

    def explain(self, q: Floats) -> str:
        """Return, in words, why one configuration, (dim,), is not free."""
        return self.world.explain(q)
