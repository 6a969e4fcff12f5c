"""Sets of points for other uses than roadmaps: integrals, designs of experiments, projections on two axes.

    python -m studies.benchmarks.other_uses

Integrals: the six families of Genz (1984) with random parameters, and the root mean square error over parameters and
sets.  Designs: a Gaussian process learns functions of two of eight axes, and is asked at 1000 other points.
Projections: the mean Hickernell L2 discrepancy of all pairs of axes, and the pairs whose points lie on one line of the
torus.  Each number is over that of scrambled Sobol points, with its standard error over parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations
from math import erf

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from studies.benchmarks.rows import parser_of

from evenroad._arrays import Floats
from evenroad.errors import NotAvailable
from evenroad.points import draw
from evenroad.points.measures import MEASURES

SETS = ("sobol", "hickernell", "halton", "even", "korobov", "uniform")
DIFFICULTY = {
    "oscillatory": 9.0,
    "product peak": 7.25,
    "corner peak": 1.85,
    "gaussian": 7.03,
    "kink": 20.4,
    "step": 4.3,
}
"""Family -> sum of its parameters, after Genz."""

Genz = Callable[[Floats, Floats, Floats], tuple[Floats, float]]


def oscillatory(x: Floats, a: Floats, u: Floats) -> tuple[Floats, float]:
    """Return cos(2 pi u_1 + a x) at points, (n,), and its integral."""
    waves = np.prod((np.exp(1j * a) - 1.0) / (1j * a))
    return np.cos(2 * np.pi * u[0] + x @ a), float((np.exp(2j * np.pi * u[0]) * waves).real)


def product_peak(x: Floats, a: Floats, u: Floats) -> tuple[Floats, float]:
    """Return the product of 1 / (a^-2 + (x - u)^2), and its integral."""
    exact = np.prod(a * (np.arctan(a * (1.0 - u)) + np.arctan(a * u)))
    return 1.0 / np.prod(a**-2.0 + (x - u) ** 2, axis=1), float(exact)


def corner_peak(x: Floats, a: Floats, u: Floats) -> tuple[Floats, float]:
    """Return (1 + a x)^-(d + 1), and its integral: a sum over the corners of the cube."""
    d = len(a)
    corners = np.array(np.meshgrid(*[[0.0, 1.0]] * d)).reshape(d, -1).T
    signs = (-1.0) ** corners.sum(axis=1)
    factorial = float(np.prod(np.arange(1.0, d + 1.0)))
    return (1.0 + x @ a) ** -(d + 1.0), float((signs / (1.0 + corners @ a)).sum() / (factorial * np.prod(a)))


def gaussian(x: Floats, a: Floats, u: Floats) -> tuple[Floats, float]:
    """Return exp(-sum a^2 (x - u)^2), and its integral."""
    each = [np.sqrt(np.pi) / (2.0 * c) * (erf(c * (1.0 - w)) + erf(c * w)) for c, w in zip(a, u, strict=True)]
    return np.exp(-((a * (x - u)) ** 2).sum(axis=1)), float(np.prod(each))


def kink(x: Floats, a: Floats, u: Floats) -> tuple[Floats, float]:
    """Return exp(-sum a |x - u|), and its integral."""
    return np.exp(-np.abs(x - u) @ a), float(np.prod((2.0 - np.exp(-a * u) - np.exp(-a * (1.0 - u))) / a))


def step(x: Floats, a: Floats, u: Floats) -> tuple[Floats, float]:
    """Return exp(a x) where x_1 <= u_1 and x_2 <= u_2, else 0, and its integral."""
    top = np.concatenate([u[:2], np.ones(len(a) - 2)])
    inside = (x[:, 0] <= u[0]) & (x[:, 1] <= u[1])
    return np.where(inside, np.exp(x @ a), 0.0), float(np.prod((np.exp(a * top) - 1.0) / a))


FAMILIES: dict[str, Genz] = {
    "oscillatory": oscillatory,
    "product peak": product_peak,
    "corner peak": corner_peak,
    "gaussian": gaussian,
    "kink": kink,
    "step": step,
}


def integral_errors(sets: list[Floats], d: int, functions: int) -> dict[str, Floats]:
    """Return the mean square relative error of each family's functions over the sets, (functions,)."""
    found = {}
    for number, (name, function) in enumerate(FAMILIES.items()):
        random = np.random.default_rng([d, number])
        squares = np.empty(functions)
        for i in range(functions):
            a, u = random.random(d) + 0.05, random.random(d)
            a *= DIFFICULTY[name] / a.sum()
            exact = function(np.zeros((1, d)), a, u)[1]
            squares[i] = np.mean([(function(each, a, u)[0].mean() / exact - 1.0) ** 2 for each in sets])
        found[name] = squares
    return found


LENGTH, NUGGET = 0.35, 1e-6


def design_errors(sets: list[Floats], functions: int) -> Floats:
    """Return the mean square error over the sets of learning functions of two axes, (functions,).

    A function is a sum of eight waves of two axes.  The process knows which axes are active, and its length scale.
    """
    d = sets[0].shape[1]
    random, asked = np.random.default_rng(d), np.random.default_rng(1).random((1000, 2))
    squares = np.empty(functions)
    for i in range(functions):
        axes = random.permutation(d)[:2]
        waves, phases = random.standard_normal((8, 2)) / LENGTH, 2 * np.pi * random.random(8)
        errors = []
        for each in sets:
            x = each[:, axes]
            kernel = np.exp(-0.5 * ((x[:, None] - x) ** 2).sum(axis=2) / LENGTH**2) + NUGGET * np.eye(len(x))
            weights = cho_solve(cho_factor(kernel), np.cos(x @ waves.T + phases).sum(axis=1))
            cross = np.exp(-0.5 * ((asked[:, None] - x) ** 2).sum(axis=2) / LENGTH**2)
            errors.append(np.mean((cross @ weights - np.cos(asked @ waves.T + phases).sum(axis=1)) ** 2))
        squares[i] = np.mean(errors)
    return squares


def projection_errors(sets: list[Floats]) -> tuple[Floats, float]:
    """Return the mean square discrepancy of pairs of axes, (sets,), and the mean number of pairs on one line."""
    squares, lines = np.empty(len(sets)), 0
    for i, each in enumerate(sets):
        pairs = list(combinations(range(each.shape[1]), 2))
        squares[i] = np.mean([MEASURES["hickernell"].rooted(each[:, pair]) ** 2 for pair in pairs])
        for one, other in pairs:
            turns = [np.abs(np.exp(2j * np.pi * (each[:, one] + s * each[:, other])).mean()) for s in (-1.0, 1.0)]
            lines += max(turns) > 1.0 - 1e-9
    return squares, lines / len(sets)


def sets_of(name: str, n: int, d: int, count: int) -> list[Floats]:
    """Return sets of a sampler, none if it has no set of this size in its bank."""
    try:
        return [draw(name, n, d, rng=seed).points for seed in range(count)]
    except NotAvailable:
        return []


def ratio_text(squares: Floats, beside: Floats) -> str:
    """Return the ratio of two root mean squares with its standard error, by deleting one function at a time."""
    total, other = squares.sum(), beside.sum()
    without = np.sqrt((total - squares) / (other - beside))
    error = np.sqrt((len(squares) - 1) * ((without - without.mean()) ** 2).mean())
    return f"{np.sqrt(total / other):.2f} ({error:.2f})"


def rows(options_sets: int, functions: int) -> Iterator[list[str]]:
    """Yield the rows of the table."""
    cells = [("integral", n, d) for n in (128, 512) for d in (3, 4, 8)]
    cells += [("design", n, 8) for n in (24, 64)] + [("pairs", n, d) for n in (16, 64, 512) for d in (5, 8)]
    for kind, n, d in cells:
        sets = {name: sets_of(name, n, d, options_sets) for name in SETS}
        sets = {name: each for name, each in sets.items() if each}
        if kind == "integral":
            of_set = {name: integral_errors(each, d, functions) for name, each in sets.items()}
            for family in FAMILIES:
                beside = of_set["sobol"][family]
                yield [
                    f"{family}, n = {n}, d = {d}",
                    *(ratio_text(of_set[s][family], beside) if s in sets else "" for s in SETS),
                ]
        elif kind == "design":
            squares = {name: design_errors(each, functions) for name, each in sets.items()}
            yield [
                f"design, n = {n}, d = {d}",
                *(ratio_text(squares[s], squares["sobol"]) if s in sets else "" for s in SETS),
            ]
        else:
            pairs = {name: projection_errors(each) for name, each in sets.items()}
            beside = pairs["sobol"][0]
            yield [
                f"pairs of axes, n = {n}, d = {d}",
                *(f"{ratio_text(pairs[s][0], beside)}, {pairs[s][1]:.1f}" if s in sets else "" for s in SETS),
            ]


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--sets", type=int, default=16, help="of each sampler")
    parser.add_argument("--functions", type=int, default=16, help="of each family")
    options = parser.parse_args()
    print("| over Sobol's |", " | ".join(SETS), "|", flush=True)
    print("| :-- |", " | ".join(["--:"] * len(SETS)), "|")
    for row in rows(options.sets, options.functions):
        print("|", " | ".join(row), "|", flush=True)


if __name__ == "__main__":
    main()
