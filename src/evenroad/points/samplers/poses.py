"""Sets that are even in spaces of rotations and poses, not in the cube: by their energy on the manifold itself.

A pose is a place in a box and a direction, a unit vector: a heading, or a quaternion, of which q and -q are one.  What
repels two poses is the sum of distance^(-2 d) with ``distance^2 = |places|^2 + turn^2 |directions|^2``, the first along
the shortest way on a torus, so that no place is a border, the second a chord.  :class:`Sliced` poses are not even, and
plan best.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import as_row, require_count, require_positive
from evenroad._njit import njit
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.samplers.korobov import Korobov
from evenroad.points.samplers.plain import Sobol

STEPS = 150
"""Of Adam: ten times as many make the typical distance one per cent longer."""

POOL = 4
"""Sets that are annealed of each kind; all others are one of them, shifted and turned."""

FAR = 0.02
"""Pairs whose squared distance is more than 50 times the smallest one are left out: they push hardly at all."""


@dataclass(frozen=True)
class Poses:
    """Even poses of a body, as points of the cube of SE2 (d = 3) or SE3 (d = 6).

    Parameters
    ----------
    sides : sequence of floats, optional
        Of the box of places, > 0; default: 1 each.
    turn : float
        What a radian of the space's rotations counts in units of the sides, > 0: of a quaternion's angle in SE3.
    """

    sides: tuple[float, ...] | None = None
    turn: float = 0.3

    name = "poses"
    about = "even in SE(2) or SE(3), by energy on the manifold"

    def __post_init__(self) -> None:
        require_positive("turn", self.turn)
        if self.sides is not None:
            sides = as_row("sides", self.sides)
            if min(sides) <= 0.0:
                raise InvalidValue(f"sides must be > 0, got {self.sides!r}")
            set_fields(self, sides=sides)

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n points of the cube of SE2, d = 3, or SE3, d = 6; below a second for n = 512, growing as n^2."""
        n, d = require_count("n", n), require_count("d", d)
        if d not in (3, 6):
            raise InvalidValue(f"poses have d = 3 (SE2) or d = 6 (SE3), got d={d}")
        places = d // 2 if d == 6 else 2
        sides = (1.0,) * places if self.sides is None else self.sides
        if len(sides) != places:
            raise InvalidValue(f"sides must be {places} numbers for d={d}, got {self.sides!r}")
        random = generator(rng)
        x, q = _moved(
            *_annealed(n, sides, 4 if d == 6 else 2, d == 6, self.turn, int(random.integers(POOL))), random
        )
        turned = (
            _cube_of_quaternions(q)
            if d == 6
            else (np.arctan2(q[:, 1:], q[:, :1]) / (2.0 * np.pi) + 0.5) % 1.0
        )
        return _as_points(np.hstack([x, turned]), self.name, rng)


@dataclass(frozen=True)
class Sliced:
    """Poses in space for sparse roadmaps: scrambled Sobol points, of which a share lies in one slice, as cube of SE3.

    The slice is one rotation, drawn at random, with a Korobov lattice of places.  It has three dimensions instead of
    six, so its poses are so near to each other that few neighbours connect them, by short motions without a turn; the
    others lead there.
    """

    share: float = 1 / 3
    """Of the poses that are in the slice, 0 .. 1; random worlds of the tuning stream chose it."""

    name = "sliced"
    about = "poses in SE(3), a third of them with one rotation"

    def __post_init__(self) -> None:
        require_positive("share", self.share, or_zero=True, at_most=1.0)

    def draw(self, n: int, d: int = 6, *, rng: RngLike = 0) -> PointSet:
        """Return n points of the cube of SE3, d = 6."""
        n, d = require_count("n", n), require_count("d", d)
        if d != 6:
            raise InvalidValue(f"sliced poses have d = 6 (SE3), got d={d}")
        random = generator(rng)
        sliced = round(self.share * n)
        cube = np.empty((n, d))
        rotation = random.standard_normal((1, 4))
        cube[:sliced, 3:] = _cube_of_quaternions(rotation / np.linalg.norm(rotation))
        if sliced:
            cube[:sliced, :3] = Korobov().draw(sliced, 3, rng=random).points
        if sliced < n:
            cube[sliced:] = Sobol().draw(n - sliced, d, rng=random).points
        # In no order: some rules join each point to earlier ones.
        points = np.clip(random.permutation(cube), 0.0, np.nextafter(1.0, 0.0))
        method = f"{sliced} of one rotation, the others Sobol"
        return PointSet(points, Origin(family=self.name, method=method, seed=seed_of(rng)))


@dataclass(frozen=True)
class Rotations:
    """Even rotations of space, as points of the cube of SO3: d = 3."""

    name = "rotations"
    about = "even in SO(3), by energy on the manifold"

    def draw(self, n: int, d: int = 3, *, rng: RngLike = 0) -> PointSet:
        """Return n points of the cube of SO3."""
        n, d = require_count("n", n), require_count("d", d)
        if d != 3:
            raise InvalidValue(f"rotations have d = 3, got d={d}")
        random = generator(rng)
        _, q = _moved(*_annealed(n, (), 4, True, 1.0, int(random.integers(POOL))), random)
        return _as_points(_cube_of_quaternions(q), self.name, rng)


def spread_directions(n: int, dim: int, *, antipodal: bool = False, rng: RngLike = 0) -> Floats:
    """Return n even unit vectors of `dim` >= 2 numbers, (n, dim): of the sphere S^(dim - 1).

    With `antipodal` u and -u are one, as quaternions of one rotation are.
    """
    n, dim = require_count("n", n), require_count("dim", dim, at_least=2)
    random = generator(rng)
    return _moved(*_annealed(n, (), dim, antipodal, 1.0, int(random.integers(POOL))), random)[1]


def _as_points(cube: Floats, family: str, rng: RngLike) -> PointSet:
    points = np.clip(cube, 0.0, np.nextafter(1.0, 0.0))
    return PointSet(points, Origin(family=family, method="annealed", objective="riesz", seed=seed_of(rng)))


def _cube_of_quaternions(q: Floats) -> Floats:
    """Return the points of the cube that Shoemake's map takes to quaternions (w, x, y, z), (n, 4) -> (n, 3)."""
    w, x, y, z = q.T
    angles = np.column_stack([np.arctan2(x, y), np.arctan2(z, w)]) / (2.0 * np.pi)
    return np.column_stack([z * z + w * w, angles % 1.0])


def _moved(x: Floats, q: Floats, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Return the places shifted around the torus, in [0, 1), and the directions turned: no distance changes."""
    turn, upper = np.linalg.qr(random.standard_normal((q.shape[1], q.shape[1])))
    return (x + random.random(x.shape[1])) % 1.0, q @ (turn * np.sign(np.diagonal(upper)))


@lru_cache(maxsize=64)
def _annealed(
    n: int, sides: tuple[float, ...], dim: int, antipodal: bool, turn: float, seed: int
) -> tuple[Floats, Floats]:
    """Return places in units of the sides, (n, places), and directions, (n, dim), of small energy."""
    random = np.random.default_rng([seed, n, dim])
    scale = np.array(sides)
    x, q = random.random((n, len(sides))) * scale, random.standard_normal((n, dim))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    sphere = 2.0 * np.pi ** (dim / 2) / math.gamma(dim / 2) / (2.0 if antipodal else 1.0)
    d = len(sides) + dim - 1
    spacing = (float(np.prod(scale)) * sphere * turn ** (dim - 1) / n) ** (1.0 / d)
    state = [(x, 0.2 * spacing), (q, 0.2 * spacing / turn)]
    moments = [(np.zeros_like(each), np.zeros_like(each)) for each, _ in state]
    best, kept = math.inf, (x.copy(), q.copy())
    for step in range(1, STEPS + 1):
        energy, *slopes = _energy(x, q, scale, turn * turn, antipodal, d)
        if energy < best:
            best, kept = energy, (x.copy(), q.copy())
        cooled = 0.0005 + 0.9995 * 0.5 * (1.0 + math.cos(math.pi * (step - 1) / STEPS))
        for (each, rate), (first, second), slope in zip(state, moments, slopes, strict=True):
            first += 0.1 * (slope - first)
            second += 0.001 * (slope * slope - second)
            move = first / (1.0 - 0.9**step) / (np.sqrt(second / (1.0 - 0.999**step)) + 1e-12)
            each += rate * cooled * (0.1 * random.standard_normal(each.shape) - move)
        x %= scale
        q /= np.linalg.norm(q, axis=1, keepdims=True)
    return kept[0] / scale, kept[1]


@njit(cache=True, nogil=True)
def _energy(x, q, sides, weight, antipodal, power):  # type: ignore[no-untyped-def]
    """Return the log of the sum of squared distance^(-power), and its slopes along the places and the directions."""
    n, places, dim = x.shape[0], x.shape[1], q.shape[1]
    squared = np.empty((n, n))
    least = np.inf
    for i in range(n):
        for j in range(i):
            total, dot = 0.0, 0.0
            for k in range(places):
                gap = abs(x[i, k] - x[j, k])
                gap = min(gap, sides[k] - gap)
                total += gap * gap
            for k in range(dim):
                dot += q[i, k] * q[j, k]
            chord = 2.0 - 2.0 * (abs(dot) if antipodal else dot)
            # The sign says which of the two antipodes is near.
            total = max(total + weight * chord, 1e-30)
            least = min(least, total)
            squared[i, j] = -total if antipodal and dot < 0.0 else total
    energy = 0.0
    along_x, along_q = np.zeros_like(x), np.zeros_like(q)
    for i in range(n):
        for j in range(i):
            total = abs(squared[i, j])
            share = least / total
            if share < FAR:
                continue
            term = share**power
            energy += term
            push = term / total
            for k in range(places):
                gap = x[i, k] - x[j, k]
                gap -= sides[k] * np.rint(gap / sides[k])
                along_x[i, k] -= push * gap
                along_x[j, k] += push * gap
            pull = weight * (push if squared[i, j] > 0.0 else -push)
            for k in range(dim):
                along_q[i, k] += pull * q[j, k]
                along_q[j, k] += pull * q[i, k]
    for i in range(n):
        outward = 0.0
        for k in range(dim):
            outward += along_q[i, k] * q[i, k]
        for k in range(dim):
            along_q[i, k] -= outward * q[i, k]
    scale = 1.0 / max(energy, 1e-300)
    return math.log(max(energy, 1e-300)) - power * math.log(least), along_x * scale, along_q * scale
