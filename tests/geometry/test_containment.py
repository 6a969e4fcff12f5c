import numpy as np
import pytest
import trimesh

from evenroad.geometry import Box, Capsule, Cylinder, Mesh, Pose, Sphere, TriangleMesh
from evenroad.geometry.hulls import piece_of, share_inside


def moved(*places):
    return np.stack([Pose((x, 0.0, 0.0)).matrix for x in places])


def ring():
    made = trimesh.creation.annulus(0.2, 0.4, 0.2)
    return Mesh(TriangleMesh(made.vertices, made.faces))


BODIES = {
    "box": Box((0.2, 0.2, 0.2)),
    "ball": Sphere(0.1),
    "capsule": Capsule((-0.05, 0, 0), (0.05, 0, 0), 0.05),
    "cylinder": Cylinder(0.1, 0.2),
}


@pytest.mark.parametrize("name", BODIES)
def test_a_body_is_in_a_large_box_by_the_share_of_its_volume(name):
    shares = share_inside([piece_of(BODIES[name])], [piece_of(Box((2.0, 2.0, 2.0)))], moved(0.0, 1.0, 2.0))
    assert shares == pytest.approx([1.0, 0.5, 0.0], abs=0.02)


def test_a_hole_of_a_mesh_a_hull_and_an_open_surface_are_no_inside():
    shares = share_inside([piece_of(Sphere(0.05))], [piece_of(ring())], moved(0.0, 0.3, 0.2))
    assert shares == pytest.approx([0.0, 1.0, 0.5], abs=0.15)
    assert share_inside([piece_of(ring())], [piece_of(Box((2.0, 2.0, 2.0)))], moved(0.0)) == [1.0]
    sheet = TriangleMesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1, 2]]))
    assert share_inside([piece_of(Mesh(sheet))], [piece_of(Box((4.0, 4.0, 4.0)))], moved(0.0)) == [0.0]
