"""``evenroad plan --straight``, ``--upright``, ``--constraint``: what the tip of an arm keeps on its way."""

from __future__ import annotations

import math
from functools import reduce
from operator import and_

from evenroad.cli.plan import PlanArm
from evenroad.constraints.text import constraints_of
from evenroad.constraints.tip import KeepUpright
from evenroad.errors import InvalidValue
from evenroad.poses.cartesian_line import CartesianLine
from evenroad.poses.constraint import Constraint
from evenroad.poses.pose_goal import as_numbers


def given_constraints(plan: PlanArm) -> Constraint | None:
    """Return the constraints of the tip."""
    straight, keeps = None, constraints_of([" ".join(words) for words in plan.constraint], degrees=plan.deg)
    if plan.straight is not None:
        approach, retreat, *_ = (*as_numbers("--straight", plan.straight, (1, 2)), 0.0)
        straight = CartesianLine(approach, retreat, plan.away or "-z", plan.tip)
    elif plan.away is not None:
        raise InvalidValue("--away goes with --straight")
    if plan.upright is not None:
        if plan.roadmap is not None:
            raise InvalidValue("--upright goes without --roadmap: the roadmap's motions are not upright")
        within = math.radians(plan.upright) if plan.deg else plan.upright
        keeps.append(KeepUpright(within, plan.upright_axis, plan.tip))
    elif plan.upright_axis is not None:
        raise InvalidValue("--upright-axis goes with --upright")
    if keeps and plan.roadmap is not None:
        raise InvalidValue("--constraint goes without --roadmap: the roadmap's motions do not keep it")
    every: list[Constraint] = [*([straight] if straight else []), *keeps]
    return reduce(and_, every) if every else None
