"""Sets that are even on the manifold itself, beside those that are even in the cube: dispersion, and planning.

    python -m benchmarks.poses --csv docs/data/poses.csv
    python -m benchmarks.poses --plane --worlds 400 -n 256 --csv docs/data/poses_plane.csv
    python -m benchmarks.poses --tune --worlds 400 -n 512
    python -m benchmarks.poses --fresh --worlds 600 -n 128 256 512 1024 --csv docs/data/poses_fresh.csv
    python -m benchmarks.poses --puzzles --draws 200 -n 1024 --csv docs/data/poses_puzzles.csv

SO(3): the largest angle of a rotation from the nearest of the set, and the smallest between two of the set, in degrees;
the first by 200 000 random rotations, so a little too small, for all alike.  "hopf" is the product grid of HEALPix and
the circle (Yershova, Jain, LaValle and Mitchell 2010), of 72 and 576 rotations; "images" the one of Mitchell's
successive orthogonal images (2008) with the same directions, as we read it.

SE(3): success in the fair suite's worlds of the reporting stream, every sampler in the same worlds, k nearest as in
the suite; "+-" is the standard error of the difference from scrambled Sobol, paired by world.  "sliced" is what a
planner takes, "even" the lattice in the cube that is mapped to poses.  `--puzzles` asks the two of the paper's suite,
whose sets give the rotation, too: there differences are not paired, since all sets meet the same obstacles.
`--plane` asks the same in SE(2), and how large the holes of even directions of the sphere are.
`--fresh` is the slice against scrambled Sobol once more, in worlds that nobody had seen when everything was decided,
others for each N.  `--tune` compares shares of poses in the slice, in worlds of the tuning stream, which chose the
share.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.nested_k import smallest_k
from evenroad._arrays import Floats
from evenroad.points import draw
from evenroad.points.samplers.poses import Poses, Rotations, Sliced, spread_directions
from evenroad.space import SO3
from evenroad_studies.problems import source_named
from evenroad_studies.problems.fair import ROTATION_WEIGHT, SIZES, Family, Stream, make_instance

SAMPLERS = ("sliced", "poses", "even", "sobol", "hickernell", "uniform")
IN_PLANE = ("poses", "even", "sobol", "hickernell", "uniform")
SHARES = {"a sixth": 1 / 6, "a third": 1 / 3, "half": 0.5, "all": 1.0}
RULES = (4, 6, 10, 20)
FRESH = 1_000_000
"""Number of the first world that nobody had seen."""
PUZZLES = ("cubicles-6d", "twistycool-6d")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--worlds", type=int, default=200)
    parser.add_argument("--draws", type=int, default=2, help="sets a world")
    parser.add_argument("-n", type=int, nargs="*", default=[256, 512])
    parser.add_argument("--tune", action="store_true")
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--puzzles", action="store_true")
    parser.add_argument("--plane", action="store_true")
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    if options.tune:
        samplers, stream = (*SHARES, "even", "sobol"), Stream.TUNING
    else:
        samplers, stream = SAMPLERS, Stream.REPORTING
    rows: list[tuple[object, ...]] = []
    if options.fresh:
        rows = fresh(options.n, options.worlds)
    elif options.puzzles:
        rows = [row for name in PUZZLES for n in options.n for row in puzzle(name, n, options.draws)]
    elif options.plane:
        rows = [row for n in (48, 192) for row in directions(n)]
        rows += [
            row for n in options.n for row in planning(n, options.worlds, options.draws, IN_PLANE, stream, 3)
        ]
    else:
        rows = [] if options.tune else [row for n in (72, 576) for row in rotations(n)]
        rows += [
            row for n in options.n for row in planning(n, options.worlds, options.draws, samplers, stream)
        ]
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["what", "n", "k", "sampler", "value", "difference", "error"])
            writer.writerows(rows)


def rotations(n: int) -> list[tuple[object, ...]]:
    """Print and return dispersion and separation of sets of n rotations [degrees]; the median of five draws."""
    probes = np.random.default_rng(0).standard_normal((200_000, 4)).astype(np.float32)
    probes /= np.linalg.norm(probes, axis=1, keepdims=True)
    rows: list[tuple[object, ...]] = []
    grids = {"hopf": hopf_grid, "images": orthogonal_images}
    for sampler in ("rotations", *grids, "even", "sobol", "uniform"):
        values = []
        for seed in range(1 if sampler in grids else 5):
            if sampler in grids:
                q = grids[sampler](n)
            else:
                points = (
                    Rotations().draw(n, rng=seed) if sampler == "rotations" else draw(sampler, n, 3, rng=seed)
                )
                q = SO3().from_cube(points.points)
            cosines = [np.abs(some @ q.T.astype(np.float32)).max(1).min() for some in np.split(probes, 100)]
            among = np.abs(q @ q.T) - 2.0 * np.eye(n)
            values.append(np.degrees(2.0 * np.arccos(np.minimum([min(cosines), among.max()], 1.0))))
        hole, gap = np.median(values, axis=0)
        print(
            f"SO(3) n={n} {sampler:10} largest hole {hole:5.1f}, smallest distance {gap:5.1f} degrees",
            flush=True,
        )
        rows += [
            ("hole", n, "", sampler, f"{hole:.2f}", "", ""),
            ("gap", n, "", sampler, f"{gap:.2f}", "", ""),
        ]
    return rows


def directions(n: int) -> list[tuple[object, ...]]:
    """Print and return the largest hole of n directions of the sphere [degrees]; the median of five draws."""
    probes = np.random.default_rng(0).standard_normal((200_000, 3))
    probes /= np.linalg.norm(probes, axis=1, keepdims=True)
    rows: list[tuple[object, ...]] = []
    for sampler in ("directions", "healpix", "even", "sobol", "uniform"):
        holes = []
        for seed in range(5):
            if sampler == "directions":
                u = spread_directions(n, 3, rng=seed)
            else:
                around = healpix(round((n / 12) ** 0.5))
                if sampler != "healpix":
                    around = [
                        (2 * z - 1, 2 * np.pi * turn) for z, turn in draw(sampler, n, 2, rng=seed).points
                    ]
                z, phi = np.array(around).T
                flat = np.sqrt(1 - z * z)
                u = np.column_stack([z, flat * np.cos(phi), flat * np.sin(phi)])
            nearest = min((some @ u.T).max(1).min() for some in np.split(probes, 100))
            holes.append(np.degrees(np.arccos(nearest)))
        print(f"S^2 n={n} {sampler:10} largest hole {np.median(holes):5.1f} degrees", flush=True)
        rows.append(("hole of directions", n, "", sampler, f"{np.median(holes):.2f}", "", ""))
    return rows


def healpix(s: int) -> list[tuple[float, float]]:
    """Return height and heading of 12 s^2 directions (Gorski et al. 2005)."""
    directions: list[tuple[float, float]] = []
    for p in range(12 * s * s):
        half = (p + 1) / 2
        if p < 2 * s * (s - 1):
            ring = int(np.sqrt(half - np.sqrt(int(half)))) + 1
            z, phi = 1 - ring**2 / (3 * s * s), np.pi / (2 * ring) * (p + 1 - 2 * ring * (ring - 1) - 0.5)
        elif p < 2 * s * (5 * s + 1):
            inner = p - 2 * s * (s - 1)
            ring = inner // (4 * s) + s
            z = (2 * s - ring) * 2 / (3 * s)
            phi = np.pi / (2 * s) * (inner % (4 * s) + 1 - 0.5 * (1 + (ring + s) % 2))
        else:
            z, phi = -directions[12 * s * s - 1 - p][0], -directions[12 * s * s - 1 - p][1]
        directions.append((z, phi))
    return directions


def hopf_grid(n: int) -> Floats:
    """Return 12 s^2 directions times 6 s turns about them, n = 72 s^3, as quaternions, (n, 4)."""
    s = round((n / 72) ** (1 / 3))
    grid = []
    for z, phi in healpix(s):
        theta = np.arccos(z)
        for turn in 2 * np.pi * (np.arange(6 * s) + 0.5) / (6 * s):
            c, v = np.cos(theta / 2), np.sin(theta / 2)
            grid.append(
                [
                    c * np.cos(turn / 2),
                    c * np.sin(turn / 2),
                    v * np.cos(phi + turn / 2),
                    v * np.sin(phi + turn / 2),
                ]
            )
    return np.array(grid)


def orthogonal_images(n: int) -> Floats:
    """Return as many: the first column is a direction, the others a circle's image under the reflection to there."""
    s = round((n / 72) ** (1 / 3))
    matrices = []
    for z, phi in healpix(s):
        flat = np.sqrt(1 - z * z)
        normal = np.array([z, flat * np.cos(phi), flat * np.sin(phi)]) - [1.0, 0.0, 0.0]
        reflection = np.eye(3) - 2 * np.outer(normal, normal) / (normal @ normal)
        for turn in 2 * np.pi * (np.arange(6 * s) + 0.5) / (6 * s):
            c, v = np.cos(turn), np.sin(turn)
            matrices.append(reflection @ [[1.0, 0.0, 0.0], [0.0, c, v], [0.0, v, -c]])
    return np.asarray(Rotation.from_matrix(matrices).as_quat())


def planning(
    n: int, worlds: int, draws: int, samplers: tuple[str, ...], stream: Stream, d: int = 6
) -> list[tuple[object, ...]]:
    """Print and return the success in SE(3), or SE(2) for d = 3, of difficulty 50."""
    family, space = (Family.SE3, "SE(3)") if d == 6 else (Family.SE2, "SE(2)")
    solved = {(sampler, k): np.zeros(worlds) for sampler in samplers for k in RULES}
    for number in range(worlds):
        problem = make_instance(stream, family, d, 50, SIZES[family, d][1], number)
        for sampler in samplers:
            for run in range(draws):
                cube = _cube(sampler, n, draws * number + run, (1.0,) * (3 if d == 6 else 2))
                least = smallest_k(problem, cube, RULES[-1])
                for k in RULES:
                    solved[sampler, k][number] += (least <= k) / draws
    rows: list[tuple[object, ...]] = []
    for k in RULES:
        for sampler in samplers:
            mine, gain = solved[sampler, k], solved[sampler, k] - solved["sobol", k]
            error = gain.std(ddof=1) / np.sqrt(worlds)
            text = f"{100 * mine.mean():5.1f} %, {100 * gain.mean():+5.1f} +- {100 * error:.1f} on Sobol"
            print(f"{space} n={n} k={k:2} {sampler:10} {text}", flush=True)
            rows.append(
                (
                    "success" if d == 6 else "success in SE(2)",
                    n,
                    k,
                    sampler,
                    f"{mine.mean():.4f}",
                    f"{gain.mean():.4f}",
                    f"{error:.4f}",
                )
            )
    return rows


def fresh(counts: list[int], worlds: int) -> list[tuple[object, ...]]:
    """Print and return the slice minus scrambled Sobol, in unseen worlds of difficulty 50, one set of each a world."""
    gain = np.zeros((len(counts), worlds, len(RULES)))
    for i, n in enumerate(counts):
        for number in range(FRESH + i * worlds, FRESH + (i + 1) * worlds):
            size = SIZES[Family.SE3, 6][1]
            problem = make_instance(Stream.REPORTING, Family.SE3, 6, 50, size, number)
            sliced, sobol = (
                smallest_k(problem, _cube(name, n, number), RULES[-1]) for name in ("sliced", "sobol")
            )
            gain[i, number - FRESH - i * worlds] = [(sliced <= k) * 1.0 - (sobol <= k) for k in RULES]
    rows: list[tuple[object, ...]] = []
    for n, gains in [*zip(counts, gain, strict=True), ("all", gain.reshape(-1, len(RULES)))]:
        for k, some in [
            *zip(RULES, gains.T, strict=True),
            ("4 and 6", gains[:, :2].mean(1)),
            ("all", gains.mean(1)),
        ]:
            mean, error = some.mean(), some.std(ddof=1) / np.sqrt(len(some))
            low, high = mean - 1.96 * error, mean + 1.96 * error
            print(f"SE(3) n={n} k={k}: {100 * mean:+.1f} [{100 * low:.1f}, {100 * high:.1f}]", flush=True)
            rows.append(("fresh", n, k, "sliced", "", f"{mean:.4f}", f"{error:.4f}"))
    return rows


def puzzle(name: str, n: int, draws: int) -> list[tuple[object, ...]]:
    """Print and return the success in a puzzle, of so many sets of each sampler."""
    problem = source_named(name).make(0)
    places = problem.world.space.parts[0]
    sides = tuple(high - low for low, high in zip(places.low, places.high, strict=True))
    solved = {}
    for sampler in SAMPLERS:
        least = np.array(
            [smallest_k(problem, _cube(sampler, n, run, sides), RULES[-1]) for run in range(draws)]
        )
        solved |= {(sampler, k): least <= k for k in RULES}
    rows: list[tuple[object, ...]] = []
    for k in RULES:
        for sampler in SAMPLERS:
            share, other = solved[sampler, k].mean(), solved["sobol", k].mean()
            error = np.sqrt((share * (1 - share) + other * (1 - other)) / draws)
            text = f"{100 * share:5.1f} %, {100 * (share - other):+5.1f} +- {100 * error:.1f} on Sobol"
            print(f"{name} n={n} k={k:2} {sampler:10} {text}", flush=True)
            rows.append((name, n, k, sampler, f"{share:.4f}", f"{share - other:.4f}", f"{error:.4f}"))
    return rows


def _cube(sampler: str, n: int, seed: int, sides: tuple[float, ...] = (1.0, 1.0, 1.0)) -> Floats:
    d = 6 if len(sides) == 3 else 3
    if sampler == "poses":
        turn = ROTATION_WEIGHT[len(sides)] if max(sides) == 1.0 else 1.0
        return Poses(sides=sides, turn=turn).draw(n, d, rng=seed).points
    if sampler == "sliced" or sampler in SHARES:
        return Sliced(SHARES.get(sampler, 1 / 3)).draw(n, rng=seed).points
    return draw(sampler, n, d, rng=seed).points


if __name__ == "__main__":
    main()
