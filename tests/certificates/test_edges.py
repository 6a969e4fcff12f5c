"""At the edge of contact, inside of closed meshes, and in files with flipped bits."""

import numpy as np
import pytest
import trimesh
from scipy.optimize import brentq

from evenroad.errors import InvalidValue
from evenroad_verify.command import verify
from evenroad_verify.errors import Refused
from tests.certificates.small import certificate_in, inputs_of, sources_in
from tests.certificates.written import accepts, parts_of, with_digest

WALL = "obstacles:\n  wall: {{shape: box, size: [0.2, 0.2, 0.2], xyz: [{x!r}, 0.0, 0.0]}}\n"
MESH = "obstacles:\n  shell: {shape: mesh, file: shell.stl}\n"
# The ball passes the wall at its nearest in the middle of the motion, 1.1 m from the axis.
PATH = [[-0.4], [0.4]]


@pytest.mark.parametrize("apart", [2e-5, 1e-6, 2e-7])
def test_what_is_micrometres_free_is_proved(apart, tmp_path):
    sources, data = certificate_in(tmp_path, WALL.format(x=1.2 + apart), PATH)
    assert verify(data, inputs_of(sources)).least < apart


@pytest.mark.parametrize("deep", [2e-5, 1e-6, 1e-8])
def test_what_touches_by_micrometres_is_never_certified(deep, tmp_path):
    with pytest.raises(InvalidValue, match=r"motion 0 at share 0\.\d+: ball touches an obstacle"):
        certificate_in(tmp_path, WALL.format(x=1.2 - deep), PATH)
    _, data = certificate_in(tmp_path, WALL.format(x=1.2 + 2e-5), PATH)
    inputs = inputs_of(sources_in(tmp_path, WALL.format(x=1.2 - deep)))
    assert not accepts(with_digest(data, inputs), inputs)


def test_the_first_touch_is_found_to_a_millionth_of_the_path(tmp_path):
    x = 1.2 - 1e-3

    def gap(share):
        angle = -0.4 + 0.8 * share
        centre = np.array([np.cos(angle), np.sin(angle), 0.0])
        outside = np.maximum(np.abs(centre - [x, 0.0, 0.0]) - 0.1, 0.0)
        return np.linalg.norm(outside) - 0.1

    first = brentq(gap, 0.0, 0.5)
    with pytest.raises(InvalidValue) as refused:
        certificate_in(tmp_path, WALL.format(x=x), PATH)
    share = float(str(refused.value).split("share ")[1].split(":")[0])
    assert share == pytest.approx(first, abs=2e-6)


@pytest.mark.parametrize(("radius", "nested"), [(0.3, True), (0.05, False)])
def test_a_body_inside_of_a_closed_mesh_is_refused(radius, nested, tmp_path):
    shell = trimesh.creation.icosphere(2, radius)
    shell.apply_translation([1.0 if nested else 1.3, 0.0, 0.0])
    shell.export(tmp_path / "shell.stl")
    sources, data = certificate_in(tmp_path, MESH, [[-0.05], [0.05]])
    assert accepts(data, inputs_of(sources)) is not nested


def test_a_body_inside_of_a_mesh_with_a_hole_is_said_not_to_be_claimed(tmp_path):
    shell = trimesh.creation.icosphere(2, 0.3)
    shell.apply_translation([1.0, 0.0, 0.0])
    shell.update_faces(np.arange(len(shell.faces)) != 7)
    shell.export(tmp_path / "shell.stl")
    sources, data = certificate_in(tmp_path, MESH, [[-0.05], [0.05]])
    assert verify(data, inputs_of(sources)).opened == 1


def test_a_fine_mesh_is_proved_apart_as_a_whole(tmp_path):
    shell = trimesh.creation.icosphere(5, 0.3)
    shell.apply_translation([1.45, 0.0, 0.0])
    shell.export(tmp_path / "shell.stl")
    sources, data = certificate_in(tmp_path, MESH, PATH)
    assert len(shell.vertices) > 10_000
    # Two balls that are apart: neither is cut, and the time a few times.
    assert accepts(data, inputs_of(sources))
    assert 3 * len(parts_of(data)[2]) < 12


def test_flipped_bits_never_stop_the_checker(tmp_path):
    scene = WALL.format(x=1.25) + "  post: {shape: cylinder, radius: 0.05, length: 1, xyz: [0.8, 0.4, 0]}\n"
    sources, data = certificate_in(tmp_path, scene, [[-0.4], [0.0], [0.1]])
    inputs, rng, reasons = inputs_of(sources), np.random.default_rng(0), []
    for _ in range(700):
        other = bytearray(data)
        for place in rng.integers(len(data), size=rng.integers(1, 4)):
            other[place] ^= 1 << rng.integers(8)
        try:
            verify(bytes(other), inputs)
        except Refused as reason:
            reasons.append(str(reason))
    assert 600 < len(reasons) < 700
    assert max(len(reason.splitlines()) for reason in reasons) == 1
