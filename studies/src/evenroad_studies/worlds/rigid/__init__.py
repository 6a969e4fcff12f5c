"""Rigid bodies of boxes, with compiled checks."""

from evenroad_studies.worlds.rigid.oriented_box import OrientedBox as OrientedBox
from evenroad_studies.worlds.rigid.oriented_box import shell as shell
from evenroad_studies.worlds.rigid.oriented_box import surface_of as surface_of
from evenroad_studies.worlds.rigid.solid_world import SolidWorld as SolidWorld
