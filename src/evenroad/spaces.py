"""The spaces by one public name, ``er.spaces``: ``er.spaces.SE2((-5, -5), (5, 5))``."""

from evenroad.space import SE2 as SE2
from evenroad.space import SE3 as SE3
from evenroad.space import SO3 as SO3
from evenroad.space import BoxSpace as BoxSpace
from evenroad.space import Circle as Circle
from evenroad.space import JointSpace as JointSpace
from evenroad.space import Product as Product
from evenroad.space import Rectangle as Rectangle
from evenroad.space import Space as Space
