"""Planning for an arm in one call; poses as goals; ways that the tip is told to take."""

from evenroad.arms.plan import SEARCH as SEARCH
from evenroad.arms.plan import ArmPlanner as ArmPlanner
from evenroad.arms.plan import finished as finished
from evenroad.arms.plan import plan_arm as plan_arm
from evenroad.arms.plan import plan_query as plan_query
from evenroad.arms.query import RESOLUTION as RESOLUTION
from evenroad.arms.query import ArmQuery as ArmQuery
from evenroad.arms.query import Goal as Goal
from evenroad.arms.query import Place as Place
from evenroad.arms.query import arm_query as arm_query
from evenroad.arms.query import mesh_check as mesh_check
