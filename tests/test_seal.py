"""What is kept comes back whole, or not at all."""

import pytest

from evenroad._seal import read_sealed, sealed


@pytest.mark.parametrize("content", [b"", b"\n", b"two\nlines\n", bytes(range(256))])
def test_what_was_sealed_comes_back(tmp_path, content):
    (tmp_path / "a").write_bytes(sealed(content, "name"))
    assert read_sealed(tmp_path / "a", "name", "it") == content


def test_what_is_missing_is_no_damage(tmp_path, caplog):
    assert read_sealed(tmp_path / "a", "name", "it") is None
    assert caplog.messages == []


def test_every_flipped_bit_and_every_cut_is_seen_said_and_removed(tmp_path, caplog):
    whole = sealed(b"radius 0.05", "name")
    cut = [whole[:end] for end in range(len(whole))]
    flipped = [
        whole[: bit // 8] + bytes([whole[bit // 8] ^ 1 << bit % 8]) + whole[bit // 8 + 1 :]
        for bit in range(8 * len(whole))
    ]
    for i, kept in enumerate((*cut, *flipped)):
        (tmp_path / "a").write_bytes(kept)
        assert read_sealed(tmp_path / "a", "name", "it") is None
        assert not (tmp_path / "a").exists()
        assert len(caplog.messages) == i + 1


def test_what_was_sealed_by_another_name_is_another_thing(tmp_path):
    (tmp_path / "a").write_bytes(sealed(b"radius 0.05", "name"))
    assert read_sealed(tmp_path / "a", "other", "it") is None
