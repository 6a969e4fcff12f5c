"""Roadmaps: points x space -> neighbour graph; x world -> plan."""

from evenroad.roadmap.plan import plan as plan
from evenroad.roadmap.result import PlanResult as PlanResult
from evenroad.roadmap.result import Status as Status
from evenroad.roadmap.rules import KNearest as KNearest
from evenroad.roadmap.rules import Radius as Radius
from evenroad.roadmap.rules import Rule as Rule
