from evenroad.planning.growing import GrowingPRM as GrowingPRM
from evenroad.planning.plan import plan as plan
from evenroad.planning.prm import FMT as FMT
from evenroad.planning.prm import PRM as PRM
from evenroad.planning.trees import GridSearch as GridSearch
from evenroad.planning.trees import RRTConnect as RRTConnect
from evenroad.roadmap.problem import Planner as Planner
from evenroad.roadmap.problem import Problem as Problem
