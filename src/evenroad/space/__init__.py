"""Spaces: from the unit cube to configurations, with a metric and shortest interpolation."""

from evenroad.space.flat import FlatMetric as FlatMetric
from evenroad.space.protocol import Space as Space
from evenroad.space.rectangle import Rectangle as Rectangle
