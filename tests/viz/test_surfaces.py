import numpy as np
import pytest

from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Sphere
from evenroad.robot import load_model
from evenroad.viz.bodies import robot_parts
from evenroad.viz.surfaces import surface_of, tube

AT = Pose.from_rpy((0.3, -0.2, 0.5), (0.4, -0.3, 1.1))


@pytest.mark.parametrize(("shape", "distance"), [
    (Sphere(0.2, pose=AT), lambda p: np.linalg.norm(p, axis=1) - 0.2),
    (Box((0.2, 0.4, 0.6), pose=AT), lambda p: np.abs(np.abs(p) / [0.1, 0.2, 0.3]).max(axis=1) - 1.0),
    (Cylinder(0.1, 0.5, pose=AT), lambda p: np.maximum(np.hypot(p[:, 0], p[:, 1]) - 0.1, np.abs(p[:, 2]) - 0.25)),
    (
        Capsule((0, 0, -0.25), (0, 0, 0.25), 0.1, pose=AT),
        lambda p: np.linalg.norm(p - np.clip(p, [0, 0, -0.25], [0, 0, 0.25]), axis=1) - 0.1,
    ),
], ids=lambda each: getattr(each, "kind", ""))  # fmt: skip
def test_the_corners_of_a_surface_lie_on_its_body(shape, distance):
    vertices, triangles = surface_of(shape)
    np.testing.assert_allclose(distance(AT.local(vertices)), 0.0, atol=1e-6)
    assert triangles.max() < len(vertices)


def test_a_link_is_shown_as_it_is_drawn_and_else_as_its_capsules(tmp_path):
    cube = '<geometry><box size="0.1 0.1 0.1"/></geometry>'
    (tmp_path / "arm.urdf").write_text(
        '<robot name="arm"><link name="base"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>'
        f'<link name="tip"><visual>{cube}</visual><collision><geometry><sphere radius="0.2"/></geometry></collision>'
        '</link><joint name="turn" type="revolute"><parent link="base"/><child link="tip"/><origin xyz="0 0 1"/>'
        '<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>'
    )
    model = load_model(tmp_path / "arm.urdf")
    drawn, plain = robot_parts(model.robot, model.file), robot_parts(model.robot)
    assert np.abs(drawn["tip"].corners).max() == pytest.approx(0.05)
    assert np.abs(plain["base"].corners).max() >= 0.2 - 1e-6
    np.testing.assert_allclose(drawn["base"].corners, plain["base"].corners, atol=1e-6)


def test_surfaces_turn_outward():
    for shape in (Sphere(0.2), Box((0.2, 0.4, 0.6)), Cylinder(0.1, 0.5), Capsule((0, 0, -0.25), (0, 0, 0.25), 0.1)):
        corners = surface_of(shape)[0][surface_of(shape)[1]]
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert ((faces * corners.mean(axis=1)).sum(axis=1) >= -1e-12).all()
    line = np.column_stack([np.linspace(0.0, 1.0, 5), np.zeros(5), np.zeros(5)])
    assert np.hypot(*tube(line, 0.01)[0].T[1:]) == pytest.approx(0.01)
