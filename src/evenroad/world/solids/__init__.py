"""Solids: rigid bodies made of boxes that move among boxes and rectangles, in the plane and in space."""

from evenroad.world.solids.oriented_box import OrientedBox as OrientedBox
from evenroad.world.solids.oriented_box import shell as shell
from evenroad.world.solids.oriented_box import surface_of as surface_of
from evenroad.world.solids.solid_world import SolidWorld as SolidWorld
