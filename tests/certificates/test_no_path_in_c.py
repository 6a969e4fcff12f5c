"""Certificates that there is no path: the checker in C says of each file what the one in Python says."""

import subprocess

import numpy as np
import pytest

from evenroad_verify.command import main
from tests.certificates.checker_in_c import ACCEPTED, ManyChecks, program
from tests.certificates.no_path import Place, accepts, at, flat_arm, posts

MESH = '<mesh filename="bar.stl"/>'
ENDLESS = flat_arm("continuous")


@pytest.fixture(scope="module")
def many():
    with ManyChecks() as process:
        yield process


@pytest.fixture(scope="module", params=["box", "endless", "mesh", "kept"])
def caught(request, tmp_path_factory):
    """The bar stands between two posts; the goal is beyond one of them."""
    import trimesh

    folder = tmp_path_factory.mktemp(request.param)
    trimesh.creation.box((0.5, 0.06, 0.06)).export(folder / "bar.stl")
    places = posts(at(0.7, 0.3), at(-0.7, 0.3), at(0.2, 0.86), at(2.9, 0.3))
    urdf = {"endless": ENDLESS, "mesh": flat_arm(first=MESH)}.get(request.param)
    place = Place(folder, places, urdf, clearance=0.01 if request.param == "kept" else 0.0)
    return place, place.certificate([0.0, 0.3], [[2.0, 0.3], [1.8, 0.1]])


def test_both_commands_print_the_same(caught, capsys):
    place, _ = caught
    words = [str(place.folder / "none.cert"), str(place.sources.robot), str(place.sources.scene)]
    assert main(words) == ACCEPTED
    done = subprocess.run([program("command"), *words], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (ACCEPTED, capsys.readouterr().out, "")


def test_both_agree_on_files_in_which_something_was_changed(caught, many):
    place, data = caught
    rng, start, accepted = np.random.default_rng(2), data.index(b"\n\n") + 2, 0
    assert many.read(place.sources.robot, place.sources.scene) == ACCEPTED
    for i in range(120):
        other = bytearray(data)
        place_of_change = rng.integers(start if i % 3 else 0, len(data))
        other[place_of_change] = rng.integers(256) if i % 2 else other[place_of_change] ^ (1 << rng.integers(8))
        said = many.accepts(other)
        assert said == accepts(bytes(other), place.inputs)
        accepted += said
    assert 0 < accepted < 120
