"""Roadmaps: points x space -> neighbour graph; x world -> plan."""

from evenroad.roadmap.build import Roadmap as Roadmap
from evenroad.roadmap.cost import EdgeCost as EdgeCost
from evenroad.roadmap.fmt import fmt as fmt
from evenroad.roadmap.npz import load_roadmap as load_roadmap
from evenroad.roadmap.npz import load_world_roadmap as load_world_roadmap
from evenroad.roadmap.npz import save_roadmap as save_roadmap
from evenroad.roadmap.npz import save_world_roadmap as save_world_roadmap
from evenroad.roadmap.plan import plan as plan
from evenroad.roadmap.result import PlanResult as PlanResult
from evenroad.roadmap.result import Status as Status
from evenroad.roadmap.rules import Complete as Complete
from evenroad.roadmap.rules import KEarlier as KEarlier
from evenroad.roadmap.rules import KMutual as KMutual
from evenroad.roadmap.rules import KNearest as KNearest
from evenroad.roadmap.rules import KStar as KStar
from evenroad.roadmap.rules import Radius as Radius
from evenroad.roadmap.rules import RadiusStar as RadiusStar
from evenroad.roadmap.rules import Reach as Reach
from evenroad.roadmap.rules import Rule as Rule
from evenroad.roadmap.rules import TheoryRadius as TheoryRadius
from evenroad.roadmap.rules import prm_star_gamma as prm_star_gamma
from evenroad.roadmap.rules import rule_named as rule_named
from evenroad.roadmap.world_roadmap import WorldRoadmap as WorldRoadmap
