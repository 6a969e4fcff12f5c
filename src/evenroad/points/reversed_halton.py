"""Even points of balls, spheres and cubes, from Halton's with reversed digits; they drive trees and smoothing."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad._shared import once

Floats = npt.NDArray[np.float64]
_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97)
_SAMPLES = 2048
_STEPS = 2048
PAIRS = 96
"""Number of pairs of positions on a path that shortening joins."""
_MANY = 8
"""Dimension from which nearly all of a ball lies at its surface. From there the lengths of steps are spread."""
_SHORTEST = 0.6
"""Shortest of these steps, as a share of the radius."""
_FEW = 3
"""One pair of these steps in three moves only some joints: hardly any other steps leave a narrow passage."""


@once
def cube_points(dim: int) -> Floats:
    """Return the points, (2048, dim) in the unit cube, that trees grow towards."""
    return _read_only(reversed_halton(_SAMPLES, dim))


def shifted_cube_points(dim: int, shift: int) -> Floats:
    """Return the points of `cube_points`, (2048, dim), moved on the torus: as even, and others for each shift >= 1."""
    # Powers of the generalised golden ratio, x^(dim + 1) = x + 1: no two of their multiples are close.
    ratio = 2.0
    for _ in range(64):
        ratio = (1.0 + ratio) ** (1.0 / (dim + 1))
    moved = (cube_points(dim) + shift * ratio ** -np.arange(1.0, dim + 1.0)) % 1.0
    return _read_only(moved)


@once
def ball_points(dim: int) -> Floats:
    """Return 2048 points in the unit ball, (2048, dim): the steps that trees try around their nodes.

    Directions are spread evenly.  Up to 7 dimensions the points fill the ball's volume evenly.  In more dimensions such
    points would nearly all be far from the centre.  There the logarithm of the length is spread evenly, from 0.6 to 1,
    and some steps move only a few joints.
    """
    ball = _even_ball(dim)
    if dim < _MANY:
        return ball
    # Trees take steps in turn around the node that was tried least and the one nearest to a point.
    pairs = np.arange(_STEPS)[:, np.newaxis] // 2 % _FEW == 0
    inside = np.linalg.norm(ball, axis=1, keepdims=True) ** dim
    return _of_lengths(np.where(pairs & ~_some_joints(dim), 0.0, ball), _SHORTEST ** (1.0 - inside))


def _even_ball(dim: int) -> Floats:
    """Return 2048 points spread evenly in the unit ball, (2048, dim)."""
    even = reversed_halton(_STEPS, 2 * (-(-dim // 2)) + 1)
    radius, others = even[:, :1], even[:, 1:]
    # Box and Muller: two even numbers give two normal ones, whose direction is even on the sphere.
    size = np.sqrt(-2.0 * np.log(1.0 - others[:, 0::2]))
    angle = 2.0 * np.pi * others[:, 1::2]
    normal = np.concatenate([size * np.cos(angle), size * np.sin(angle)], axis=1)[:, :dim]
    return _of_lengths(normal, radius ** (1.0 / dim))


def _some_joints(dim: int) -> npt.NDArray[np.bool_]:
    """Return which joints move in each step, (2048, dim): two or more, the logarithm of their number spread evenly."""
    # Multiples of the roots of primes are even, and all different.
    even = np.outer(np.arange(1.0, _STEPS + 1.0), np.sqrt(_primes(dim + 1))) % 1.0
    number = np.rint(2.0 * (0.5 * dim) ** even[:, :1])
    return even[:, 1:].argsort(axis=1).argsort(axis=1) < number


def _of_lengths(directions: Floats, lengths: Floats) -> Floats:
    """Return vectors in these directions, (n, dim), of these lengths, (n, 1)."""
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    return _read_only(np.ascontiguousarray(unit * lengths))


@once
def sphere_points(dim: int) -> Floats:
    """Return 2048 directions of length 1 spread evenly, (2048, dim)."""
    return _of_lengths(_even_ball(dim), np.ones((_STEPS, 1)))


@once
def share_pairs(most: int = PAIRS) -> Floats:
    """Return the pairs of positions that shortening joins, as shares of a path's length, (most, 2)."""
    return _read_only(reversed_halton(most, 2))


def reversed_halton(count: int, dim: int) -> Floats:
    """Return points 1 .. count of Halton's sequence with its digits reversed, (count, dim), in [0, 1).

    Digit i of base b is replaced by b - i, and 0 stays 0 (B. Vandewoestyne and R. Cools, 2006).  Without this,
    coordinates of large bases are correlated.
    """
    points = np.zeros((count, dim))
    for k, base in enumerate(_primes(dim)):
        number, weight = np.arange(1, count + 1), 1.0 / base
        while number.any():
            digit = number % base
            points[:, k] += np.where(digit > 0, base - digit, 0) * weight
            number, weight = number // base, weight / base
    return points


def _primes(count: int) -> list[int]:
    """Return the first `count` primes."""
    primes = list(_PRIMES[:count])
    candidate = _PRIMES[-1]
    while len(primes) < count:
        candidate += 2
        if all(candidate % prime for prime in primes):
            primes.append(candidate)
    return primes


def _read_only(array: Floats) -> Floats:
    array.setflags(write=False)
    return array
