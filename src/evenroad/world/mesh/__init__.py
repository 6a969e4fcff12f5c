"""Meshes: a body and obstacles of triangles, from users' own files, checked by coal (extra ``mesh``)."""

from evenroad.geometry.mesh import TriangleMesh as TriangleMesh
from evenroad.geometry.mesh import load_mesh as load_mesh
from evenroad.world.mesh.mesh_world import MeshWorld as MeshWorld
from evenroad.world.solids.oriented_box import surface_of as surface_of
