"""Roadmaps: points x space -> neighbour graph; x world -> plan."""

from evenroad.roadmap.budget import Budget as Budget
from evenroad.roadmap.certificate import Certificate as Certificate
from evenroad.roadmap.certify import certify as certify
from evenroad.roadmap.certify import certify_roadmap as certify_roadmap
from evenroad.roadmap.point_roadmap import Roadmap as Roadmap
from evenroad.roadmap.point_roadmap import WorldRoadmap as WorldRoadmap
from evenroad.roadmap.query import EdgeCost as EdgeCost
from evenroad.roadmap.query import Query as Query
from evenroad.roadmap.result import PlanResult as PlanResult
from evenroad.roadmap.result import SearchedGraph as SearchedGraph
from evenroad.roadmap.result import Stage as Stage
from evenroad.roadmap.result import Status as Status
from evenroad.roadmap.rules import Complete as Complete
from evenroad.roadmap.rules import KNearest as KNearest
from evenroad.roadmap.rules import Radius as Radius
from evenroad.roadmap.rules import Reach as Reach
from evenroad.roadmap.rules import Rule as Rule
from evenroad.roadmap.rules import default_rule as default_rule
from evenroad.roadmap.rules import rule_named as rule_named
