"""Connection rules: which pairs of milestones a roadmap tries to join, each by its name."""

from evenroad.roadmap.rules.complete import Complete as Complete
from evenroad.roadmap.rules.default import default_rule as default_rule
from evenroad.roadmap.rules.k_nearest import KEarlier as KEarlier
from evenroad.roadmap.rules.k_nearest import KMutual as KMutual
from evenroad.roadmap.rules.k_nearest import KNearest as KNearest
from evenroad.roadmap.rules.named import rule_named as rule_named
from evenroad.roadmap.rules.radius import Radius as Radius
from evenroad.roadmap.rules.rule import Reach as Reach
from evenroad.roadmap.rules.rule import Rule as Rule
from evenroad.roadmap.rules.star import KStar as KStar
from evenroad.roadmap.rules.star import RadiusStar as RadiusStar
from evenroad.roadmap.rules.star import prm_star_gamma as prm_star_gamma
from evenroad.roadmap.rules.theory import TheoryRadius as TheoryRadius
