"""Rigid bodies: of boxes, with compiled checks, or of users' meshes, checked by coal."""

from evenroad.research.worlds.rigid.mesh_world import MeshWorld as MeshWorld
from evenroad.research.worlds.rigid.oriented_box import OrientedBox as OrientedBox
from evenroad.research.worlds.rigid.oriented_box import shell as shell
from evenroad.research.worlds.rigid.oriented_box import surface_of as surface_of
from evenroad.research.worlds.rigid.solid_world import SolidWorld as SolidWorld
