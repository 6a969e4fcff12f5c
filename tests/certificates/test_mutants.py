"""A planner, and even a writer, that call contacts free: no certificate of theirs is accepted."""

import pytest

import evenroad as er
from evenroad.certificates.certify import certify
from evenroad.errors import InvalidValue
from tests.certificates.written import accepts, box_reach, touches, with_digest


@pytest.fixture(scope="module")
def blind():
    """A path of a planner that sees no obstacle."""
    path = er.plan(er.ArmWorld("ur5"), box_reach().path[0], box_reach().path[-1]).path
    assert touches(box_reach(), path)
    return path


def test_a_path_that_touches_gets_no_certificate(blind, tmp_path):
    with pytest.raises(InvalidValue, match="touches an obstacle"):
        certify(box_reach().world, blind, box_reach().sources, tmp_path / "blind.cert")
    assert not list(tmp_path.iterdir())


def test_a_writer_that_sees_no_obstacle_is_refused(blind, tmp_path):
    world = er.ArmWorld("ur5")
    # What it carries is what it saw: it is true, and about another scene.
    certify(world, blind, box_reach().sources, tmp_path / "blind.cert")
    data = (tmp_path / "blind.cert").read_bytes()
    head, _, rest = data.partition(b"\nscene -")
    size = int.from_bytes(data[data.index(b"obstacles") - 8 :][:8], "little")
    own = head + rest[: len(rest) - 8 - size]
    assert not accepts(with_digest(own, box_reach().inputs()), box_reach().inputs())
