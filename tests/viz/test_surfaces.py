import numpy as np
import pytest

from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Sphere
from evenroad.robot import load_model
from evenroad.viz.surfaces import link_surfaces, surface_of

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
    drawn, plain = link_surfaces(model.robot, model.file), link_surfaces(model.robot, None)
    assert np.abs(drawn["tip"][0]).max() == pytest.approx(0.05)
    assert np.abs(plain["tip"][0]).max() >= 0.2 - 1e-6
    np.testing.assert_array_equal(drawn["base"][0], plain["base"][0])
