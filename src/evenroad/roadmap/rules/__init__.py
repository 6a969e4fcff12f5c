"""Connection rules: which pairs of milestones a roadmap tries to join, each by its name."""

from evenroad.roadmap.rules.growing import KStar as KStar
from evenroad.roadmap.rules.growing import RadiusStar as RadiusStar
from evenroad.roadmap.rules.growing import TheoryRadius as TheoryRadius
from evenroad.roadmap.rules.growing import default_rule as default_rule
from evenroad.roadmap.rules.growing import prm_star_gamma as prm_star_gamma
from evenroad.roadmap.rules.growing import rule_named as rule_named
from evenroad.roadmap.rules.near import Complete as Complete
from evenroad.roadmap.rules.near import KEarlier as KEarlier
from evenroad.roadmap.rules.near import KMutual as KMutual
from evenroad.roadmap.rules.near import KNearest as KNearest
from evenroad.roadmap.rules.near import Radius as Radius
from evenroad.roadmap.rules.near import Reach as Reach
from evenroad.roadmap.rules.near import Rule as Rule
