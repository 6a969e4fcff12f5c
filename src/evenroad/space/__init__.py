"""Spaces: from the unit cube to configurations, with a metric and shortest interpolation."""

from evenroad.space.flat import FlatMetric as FlatMetric
from evenroad.space.joints import BoxSpace as BoxSpace
from evenroad.space.joints import Circle as Circle
from evenroad.space.joints import JointSpace as JointSpace
from evenroad.space.product import SE2 as SE2
from evenroad.space.product import SE3 as SE3
from evenroad.space.product import Product as Product
from evenroad.space.protocol import Space as Space
from evenroad.space.rectangle import Rectangle as Rectangle
from evenroad.space.so3 import SO3 as SO3
