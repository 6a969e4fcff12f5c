import io
import struct
import zipfile
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image

from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.points import Origin, PointSet, draw, load_points, measure, save_points
from evenroad.points.randomise import Symmetry, randomise
from tests.refused import refused

unit = st.floats(0, 1, exclude_max=True, allow_subnormal=True)
arrays = hnp.arrays(np.float64, st.tuples(st.integers(0, 20), st.integers(1, 6)), elements=unit)


def test_the_array_is_a_copy_of_the_callers_and_cannot_be_written_to():
    points = PointSet([[0.5, 0.25]])
    with pytest.raises(ValueError, match="read-only"):
        points.points[0, 0] = 0.1
    given_array = np.array([[0.5, 0.25]])
    points = PointSet(given_array)
    given_array[0, 0] = 0.75
    assert points.points[0, 0] == 0.5


@pytest.mark.parametrize("bad", [np.nan, np.inf, -0.1, 1.0, 1.5])
def test_a_coordinate_outside_the_cube_is_named_with_its_place(bad):
    refused(InvalidValue, r"\[1, 0\]", PointSet, [[0.5, 0.5], [bad, 0.5]])


@pytest.mark.parametrize("shape", [(3,), (3, 0), (2, 2, 2), ()])
def test_only_matrices_are_point_sets(shape):
    refused(InvalidValue, "shape", PointSet, np.zeros(shape))


@pytest.mark.parametrize("bad", [
    [["a", "b"]], [[b"0.5", b"0.5"]], [[0.5 + 0j, 0.5]], np.array([["0.5"]], dtype=object),
    np.array([[np.complex128(0.5)]], dtype=object), np.array([[np.timedelta64(0, "s")]], dtype=object),
    np.array([[np.datetime64(0, "s")]], dtype=object), np.zeros((2, 2), dtype="m8[s]"),
    np.zeros((2, 2), dtype="M8[s]"), np.zeros((2, 2), dtype="V8"), [[None]], [[10**400]], [[0.5, 0.5], [0.5]],
])  # fmt: skip
def test_what_is_not_a_real_number_is_refused(bad):
    refused(InvalidValue, "array of numbers", PointSet, bad)


def test_an_error_repeats_only_a_little_of_a_long_value():
    for bad in ("0.5, " * 1000, ["0.5" * 1000], {"points": "0.5" * 1000}, np.array([["x" * 5000]], dtype=object)):
        with pytest.raises(InvalidValue) as caught:
            PointSet(bad)
        assert len(str(caught.value)) < 300
    for bad in ("7" * 5000, [0] * 5000):
        for arguments in ({"n": bad}, {"d": bad}, {"rng": bad}, {"name": bad}):
            with pytest.raises((InvalidValue, UnknownName)) as caught:
                draw(**{"name": "uniform", "n": 3, "d": 2, "rng": 0} | arguments)
            assert len(str(caught.value)) < 300


def test_every_kind_of_real_number_is_taken():
    for half in (0.5, np.float16(0.5), np.longdouble(0.5), Fraction(1, 2), Decimal("0.5")):
        assert PointSet([[half, 0]]) == PointSet([[0.5, 0.0]])
    assert PointSet([[False, 0]]) == PointSet([[0.0, 0.0]])


@given(arrays)
def test_equal_points_have_equal_hashes_whatever_the_layout(array):
    assert PointSet(array).hash == PointSet(np.asfortranarray(array)).hash


def test_the_hash_tells_shapes_and_values_apart():
    hashes = {PointSet(np.zeros(shape)).hash for shape in [(2, 3), (3, 2), (6, 1), (1, 6)]}
    assert len(hashes) == 4
    assert PointSet([[0.5]]).hash != PointSet([[0.5 + 1e-16 * 2]]).hash


@given(array=arrays, seed=st.none() | st.integers(0, 2**40), replica=st.none() | st.integers(0, 99))
def test_a_saved_set_comes_back_bit_for_bit_with_its_origin(tmp_path_factory, array, seed, replica):
    path = tmp_path_factory.mktemp("sets") / "set.npz"
    points = PointSet(array, Origin(family="x", method="y", objective="a+b", seed=seed, replica=replica))
    save_points(path, points)
    loaded = load_points(path)
    assert loaded == points
    assert loaded.points.tobytes() == points.points.tobytes()


def _rewrite(path, **changes):
    with np.load(path) as archive:
        content = dict(archive) | changes
    np.savez(path, **{name: value for name, value in content.items() if value is not None})


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "set.npz"
    save_points(path, PointSet(np.linspace(0, 0.9, 10).reshape(5, 2)))
    return path


@pytest.mark.parametrize(("changes", "says"), [
    ({"points": np.zeros((5, 2))}, "do not match their hash"),
    ({"points": np.zeros((5, 2), dtype=np.float32)}, "dtype float32"),
    ({"points": np.full((5, 2), 1.5)}, "must lie in"), ({"points": np.full((5, 2), np.nan)}, "must lie in"),
    ({"points": np.zeros(10)}, "shape"), ({"hash": None}, "holds"), ({"extra": np.zeros(1)}, "holds"),
    ({"origin": "{"}, "set.npz"),
    ({"origin": '{"family": "a", "colour": "red"}'}, "keys among"),
    ({"origin": "[1]"}, "keys among"), ({"origin": "{}"}, "family"),
    ({"origin": '{"family": 3}'}, "the origin's family cannot be 3"),
    ({"origin": '{"family": "a", "seed": "1"}'}, "the origin's seed cannot be '1'"),
    ({"origin": '{"family": "a", "start": null}'}, "the origin's start cannot be None"),
    ({"origin": "[" * 100_000}, "set.npz"),
])  # fmt: skip
def test_a_file_that_was_changed_is_refused_with_the_reason(saved, changes, says):
    _rewrite(saved, **changes)
    refused(BrokenFile, says, load_points, saved)


def _three_members_that_are_empty(path):
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("points", "origin", "hash"):
            archive.writestr(f"{name}.npy", b"")


def _plain_array(path):
    with open(path, "wb") as file:
        np.save(file, np.zeros((2, 2)))


@pytest.mark.parametrize(("make", "says"), [
    (lambda path: None, r"no such file: .*set\.npz"),
    (_plain_array, "plain array"), (_three_members_that_are_empty, "points is no array"),
    (lambda path: np.savez(path, points=np.array([object()], dtype=object), origin="{}", hash=""), "npz"),
], ids=["missing", "a plain array", "members that are no arrays", "a pickle"])  # fmt: skip
def test_a_file_that_is_something_else_is_refused(tmp_path, make, says):
    make(tmp_path / "set.npz")
    refused(BrokenFile, says, load_points, tmp_path / "set.npz")


@pytest.mark.parametrize("name", ["set.npz", "set.npy", "set.csv"])
def test_points_save_themselves_and_are_read_again(tmp_path, name):
    points = draw("halton", 20, 3, rng=1)
    points.save(tmp_path / name)
    again = load_points(tmp_path / name)
    assert np.array_equal(again.points, points.points)
    assert (again.origin == points.origin) is (name == "set.npz")
    assert np.array_equal([row for row in again], points[:])  # noqa: C416
    assert again.shape == (20, 3)
    refused(UnknownName, r"\.csv, \.npy, \.npz", points.save, tmp_path / "set.txt")


def _array_file(shape):
    """Bytes of a .npy file without data whose header claims a shape, given as text."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(117).encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header


@pytest.mark.parametrize(
    "shape", ["(3, 2", "(" * 90, "(100000000000, 2)", f"({10**20}, 2)", "(-3, 2)", "(True, 2)", "{[]: 1}", "(3, 2)"]
)
def test_a_header_that_lies_or_does_not_parse_is_a_broken_file(tmp_path, shape):
    (tmp_path / "bad.npy").write_bytes(_array_file(shape))
    with zipfile.ZipFile(tmp_path / "bad.npz", "w") as archive:
        archive.writestr("points.npy", _array_file(shape))
        for name in ("origin", "hash"):
            text = io.BytesIO()
            np.save(text, np.array("{}"))
            archive.writestr(f"{name}.npy", text.getvalue())
    for name in ("bad.npy", "bad.npz"):
        with pytest.raises(BrokenFile, match=rf"{name} is not a readable") as caught:
            load_points(tmp_path / name)
        assert "\n" not in str(caught.value)


def test_a_file_with_flipped_or_missing_bytes_gives_the_same_set_or_is_a_broken_file(saved):
    original, points = saved.read_bytes(), load_points(saved)
    rng = np.random.default_rng(0)
    refusals = []
    for number in range(1500):
        content = bytearray(original)
        if number % 10 == 0:
            del content[rng.integers(len(content)) :]
        for place in rng.integers(len(content) or 1, size=1 + number % 3):
            content[place:place] = b"" if number % 7 else bytes([rng.integers(256)])
            if content:
                content[place % len(content)] ^= 1 << rng.integers(8)
        saved.write_bytes(content)
        try:
            assert load_points(saved) == points
        except BrokenFile as error:
            refusals.append(str(error))
    assert len(refusals) > 1000
    assert not any("\n" in each or len(each) > 300 for each in refusals)


@pytest.mark.parametrize("offset", [(6, 8), (8, 10)], ids=["flags", "compression"])
@pytest.mark.parametrize("value", [1, 9, 32, 255])
def test_an_archive_that_zipfile_cannot_read_is_a_broken_file(saved, offset, value):
    content = bytearray(saved.read_bytes())
    for signature, place in zip((b"PK\x03\x04", b"PK\x01\x02"), offset, strict=True):
        for start in range(len(content)):
            if content.startswith(signature, start):
                content[start + place] = value
    saved.write_bytes(content)
    with pytest.raises(BrokenFile, match="not a readable") as caught:
        load_points(saved)
    assert "\n" not in str(caught.value)


def test_a_failed_save_leaves_the_old_file_and_no_litter(saved, monkeypatch):
    before = saved.read_bytes()

    def full_disk(*_args, **_kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full_disk)
    refused(BrokenFile, "No space left", save_points, saved, PointSet([[0.5]]))
    assert saved.read_bytes() == before
    assert list(saved.parent.iterdir()) == [saved]


def test_as_single_and_half_precision_points_are_below_one():
    points = PointSet(np.array([[np.nextafter(1.0, 0.0), 0.25], [1.0 - 1e-5, 0.0]]))
    for kind in (np.float16, np.float32, np.float64):
        given = np.asarray(points, dtype=kind)
        assert given.max() < 1.0
        assert np.abs(given - points.points).max() <= np.finfo(kind).eps
    assert np.asarray(points)[0, 0] == np.nextafter(1.0, 0.0)


def test_reflected_zeros_are_below_one_in_single_precision():
    zeros = PointSet(np.zeros((2, 5)))
    flipped = [randomise(zeros, {Symmetry.REFLECTION}, rng=seed).points for seed in range(4)]
    assert max(each.max() for each in flipped) > 0.9
    assert max(each.astype(np.float32).max() for each in flipped) < 1.0


def test_points_are_drawn_in_two_of_their_axes(tmp_path):
    points = draw("even", 64, 3)
    picture = points.plot(tmp_path / "points.png", axes=(0, 2))
    with Image.open(tmp_path / "points.png") as saved:
        np.testing.assert_array_equal(np.asarray(saved), np.asarray(picture))
    with pytest.raises(InvalidValue, match="axes must be two numbers from 0 to 2"):
        points.plot(axes=(0, 3))


def test_points_are_measured_as_a_set_an_array_or_a_file(tmp_path):
    points = draw("even", 64, 2)
    points.save(tmp_path / "set.npy")
    measured = measure(points)
    assert measured == measure(points.points) == measure(tmp_path / "set.npy")
    apart = np.linalg.norm(points.points[:, None] - points.points[None], axis=2)[np.triu_indices(64, 1)]
    assert measured["separation"] == pytest.approx(apart.min())
    with pytest.raises(InvalidValue, match="points must have shape"):
        measure([1, 2])
