"""Footprints: what is read, how it is divided, and the disks around and inside of it."""

import numpy as np
import pytest

from evenroad.driving import Footprint
from evenroad.driving.convex_parts import MOST_CORNERS, convex_parts, turn
from evenroad.errors import InvalidValue
from tests.driving.oracle import BOX

ELL = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def star(corners, rng):
    """A simple polygon that is seen from the origin, counter-clockwise."""
    angles = np.sort(rng.random(corners)) * 2 * np.pi
    return np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(0.3, 1.0, corners)[:, np.newaxis]


def area(polygon):
    x, y = np.asarray(polygon, dtype=float).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def contains(polygon, points):
    """Whether points lie in a simple polygon, by counting the sides that a ray crosses."""
    inside = np.zeros(len(points), dtype=bool)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        crosses = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            inside ^= crosses & (points[:, 0] < a[0] + (points[:, 1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
    return inside


def test_a_convex_footprint_is_its_only_part_in_either_sense_closed_or_not():
    for corners in (BOX, BOX[::-1], [*BOX, BOX[0]]):
        footprint = Footprint(corners)
        (part,) = footprint.parts
        assert area(part) == pytest.approx(0.9 * 0.62)
        assert {tuple(corner) for corner in part.tolist()} == set(BOX)


def test_corners_on_a_side_and_repeated_ones_are_left_out():
    (part,) = Footprint([(0, 0), (1, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)]).parts
    assert len(part) == 4


@pytest.mark.parametrize("corners", [5, 9, 16, 40])
def test_parts_are_convex_and_make_up_the_polygon(corners):
    rng = np.random.default_rng(corners)
    for _ in range(5):
        polygon = star(corners, rng)
        if area(polygon) < 0.2:
            continue
        parts = convex_parts(polygon)
        for part in parts:
            assert 3 <= len(part) <= MOST_CORNERS
            assert all(
                turn(a, b, c) > 0 for a, b, c in zip(np.roll(part, 1, 0), part, np.roll(part, -1, 0), strict=True)
            )
        assert sum(map(area, parts)) == pytest.approx(area(polygon), rel=1e-12)
        points = rng.uniform(-1, 1, (200, 2))
        np.testing.assert_array_equal(
            sum(contains(part, points).astype(int) for part in parts), contains(polygon, points)
        )


def test_several_polygons_are_one_footprint():
    footprint = Footprint([BOX, [(0.4, -0.1), (0.8, 0), (0.4, 0.1)]])
    assert len(footprint.parts) == 2
    assert footprint.reach == pytest.approx(0.8)


@pytest.mark.parametrize(
    ("corners", "says"),
    [
        ([], "corners"),
        ("box", "corners"),
        (3.0, "corners"),
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], "corners"),
        ([(0, 0), (1, 0)], "three corners or more"),
        ([(0, 0), (0, 0), (0, 0)], "three corners or more"),
        ([(0, 0), (1, 0), (2, 0)], "three corners or more"),
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "cross itself"),
        ([(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)], "cross itself"),
        ([(0, 0), (1, 0), (float("nan"), 1)], "finite"),
        ([(0, 0), (1, 0), (float("inf"), 1)], "finite"),
        ([(0, 0), (1e9, 0), (0, 1e9)], "at most 1e"),
        (np.column_stack([np.cos(np.arange(500) / 80), np.sin(np.arange(500) / 80)]), "at most 200"),
        ([BOX, [(0, 0), (1, 1)]], "three corners or more"),
    ],
)
def test_what_is_no_footprint_is_refused_in_one_line(corners, says):
    with pytest.raises(InvalidValue, match=says) as refused:
        Footprint(corners)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("corners", [BOX, ELL, [(0, 0), (3, 0), (0, 1)]])
def test_the_inscribed_disks_touch_sides_and_are_inside(corners):
    footprint = Footprint(corners)
    centres, radius = footprint.inscribed
    angles = np.linspace(0, 2 * np.pi, 721)
    for centre in centres:
        rim = centre + (radius - 1e-9) * np.column_stack([np.cos(angles), np.sin(angles)])
        assert np.any([contains(part, rim).all() for part in footprint.parts])
    # No grid point is farther from the sides of any part.
    for part in footprint.parts:
        points = np.stack(np.meshgrid(*np.linspace(part.min(0), part.max(0), 60).T), -1).reshape(-1, 2)
        along = np.roll(part, -1, 0) - part
        normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, np.newaxis]
        assert ((normals * part).sum(1) - points @ normals.T).min(1).max() <= radius + 1e-6


def test_a_grown_footprint_holds_what_is_near_and_hardly_more():
    footprint, by = Footprint(ELL), 0.25
    (low, high), (wide_low, wide_high) = footprint.bounds, footprint.grown(by).bounds
    np.testing.assert_allclose([wide_low, wide_high], [low - by, high + by], atol=1e-12)
    angles = np.linspace(0, 2 * np.pi, 97)
    for part in footprint.parts:
        for corner in part:
            rim = corner + 0.9999 * by * np.column_stack([np.cos(angles), np.sin(angles)])
            grown = footprint.grown(by).parts
            assert np.any([contains(each, rim) for each in grown], axis=0).all()
    for part, wide in zip(footprint.parts, footprint.grown(by).parts, strict=True):
        distances = np.linalg.norm(wide[:, np.newaxis] - part, axis=2).min(axis=1)
        assert (distances <= 1.02 * by).all()
