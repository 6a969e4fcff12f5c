"""Geometry: poses, shapes, meshes, distances, and capsules fitted to shapes; it knows nothing of robots."""

from evenroad.geometry.cloud_file import load_cloud as load_cloud
from evenroad.geometry.distance import segment_distance as segment_distance
from evenroad.geometry.fit import fit_capsules as fit_capsules
from evenroad.geometry.fit import union_volume as union_volume
from evenroad.geometry.mesh import TriangleMesh as TriangleMesh
from evenroad.geometry.mesh import height_map as height_map
from evenroad.geometry.mesh import load_mesh as load_mesh
from evenroad.geometry.pose import IDENTITY as IDENTITY
from evenroad.geometry.pose import Pose as Pose
from evenroad.geometry.rotation import rotation_from_heading as rotation_from_heading
from evenroad.geometry.rotation import rotation_from_quaternion as rotation_from_quaternion
from evenroad.geometry.rotation import rotation_from_rpy as rotation_from_rpy
from evenroad.geometry.shapes import Box as Box
from evenroad.geometry.shapes import Capsule as Capsule
from evenroad.geometry.shapes import Cylinder as Cylinder
from evenroad.geometry.shapes import Mesh as Mesh
from evenroad.geometry.shapes import PointCloud as PointCloud
from evenroad.geometry.shapes import Shape as Shape
from evenroad.geometry.shapes import Sphere as Sphere
from evenroad.geometry.shapes import shape_of as shape_of
