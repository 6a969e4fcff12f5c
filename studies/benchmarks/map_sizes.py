"""What a plan of a disk costs by the size of the map: the same short way, a long way, and in memory.

    python -m studies.benchmarks.map_sizes OUT.csv OUT.png [--most 16000]

Cities of n by n pixels: houses of 30 to 120 pixels, streets of 6 to 24, a disk of radius 3.  The short way is 45 pixels
long, around a wall on a square in the middle; the long one as far as 2000 pixels, or across the map where that is
nearer; the last one across the map.  Every row is a process of its own.  Times are of its processor: the world with the
first plan, and the median of plans of the same query after it.  Memory is what the process holds more after all of
them, the map's array left out (Linux alone).  `--peer` puts `pyastar2d` beside it: random queries in the city of 2000
pixels, with the cells that are surely free as its map.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import numpy.typing as npt
from studies.benchmarks.sizes import alone, draw_costs, held, shown, sizes_parser, write_table

from evenroad.planning import plan
from evenroad.world import GridMap

Floats = npt.NDArray[np.float64]
SIZES = (500, 1000, 2000, 4000, 8000, 16_000)
RADIUS = 3.0
WAYS = {"short": 45.0, "long": 2000.0, "across": np.inf}
COLUMNS = ("way", "size", "straight [px]", "path [px]", "world and first plan [ms]", "plan [ms]", "memory [MB]")
Row = tuple[str, int, float, float, float, float, float]


def city(size: int, seed: int) -> npt.NDArray[np.bool_]:
    """Return the houses of a city, which neither change nor can be changed."""
    rng, occupied = np.random.default_rng(seed), np.zeros((size, size), dtype=bool)
    top = 0
    while top < size:
        high, left = int(rng.integers(30, 120)), int(rng.integers(0, 30))
        while left < size:
            wide = int(rng.integers(30, 120))
            if rng.random() < 0.8:
                above, below = rng.integers(0, 12, 2)
                occupied[top + above : top + high - below, left : left + wide] = True
            left += wide + int(rng.integers(6, 24))
        top += high + int(rng.integers(6, 24))
    middle = size // 2
    occupied[middle - 30 : middle + 30, middle - 30 : middle + 30] = False
    occupied[middle - 5 : middle + 5, middle] = True
    occupied.setflags(write=False)
    return occupied


def ends(occupied: npt.NDArray[np.bool_], apart: float) -> tuple[Floats, Floats]:
    """Return two free places about so far apart, along a diagonal around the middle of the map."""
    middle, by = len(occupied) / 2, min(apart, 1.2 * len(occupied)) / np.sqrt(8)
    if apart < 60.0:
        return np.array([middle - apart / 2, middle + 0.2]), np.array([middle + apart / 2, middle + 0.4])
    found = []
    for at in (middle - by, middle + by):
        corner = max(int(at) - 100, 0)
        part = GridMap(occupied[corner : corner + 200, corner : corner + 200])
        free = part.world(RADIUS).nearest_free(np.array([at - corner, at - corner]))
        assert free is not None
        found.append(free + corner)
    return found[0], found[1]


def measured(way: str, size: int) -> Row:
    """Return a row of the table."""
    plan(GridMap(city(300, 0)).world(RADIUS), *ends(city(300, 0), 45.0))  # loads compiled code
    occupied = city(size, 1)
    start, goal = ends(occupied, WAYS[way])
    before, times = held(), []
    begin = time.process_time()
    world = GridMap(occupied).world(RADIUS)
    for _ in range(501 if way == "short" else 6):
        result = plan(world, start, goal, seconds=100.0)
        times.append(time.process_time() - begin)
        begin = time.process_time()
    assert result.solved
    straight = float(np.hypot(*(goal - start)))
    return way, size, straight, result.cost, 1e3 * times[0], 1e3 * float(np.median(times[1:])), held() - before


def beside(count: int) -> None:
    """Print random queries in a city of 2000 pixels beside pyastar2d, which is asked from cell to cell."""
    import pyastar2d

    occupied, rng = city(2000, 2), np.random.default_rng(3)
    world = GridMap(occupied).world(RADIUS)
    places = rng.random((40 * count, 2)) * 2000
    component = np.array([world.component(place) if world.valid(place) else 0 for place in places])
    places = places[component == np.bincount(component[component > 0]).argmax()][: 2 * count]
    weights = np.where(world.disk.cells()[1:-1, 1:-1] > 0, 1, np.inf).astype(np.float32)
    rows = []
    for start, goal in zip(places[::2], places[1::2], strict=True):
        begin = time.process_time()
        length = plan(world, start, goal).cost
        middle = time.process_time()
        cells = [(int(y), int(x)) for x, y in (start, goal)]
        path = pyastar2d.astar_path(weights, *cells, allow_diagonal=True)
        rows.append((middle - begin, time.process_time() - middle, length, np.hypot(*np.diff(path, axis=0).T).sum()))
    ours, theirs, length, other = np.array(rows).T
    print(f"{len(rows)} queries: evenroad {1e3 * ours.mean():.1f} ms (median {1e3 * np.median(ours):.1f}),", end=" ")
    print(f"pyastar2d {1e3 * theirs.mean():.1f} ms (median {1e3 * np.median(theirs):.1f});", end=" ")
    print(f"ratio of times, median {np.median(ours / theirs):.2f}, of lengths {np.mean(length / other):.3f}")


def draw(rows: list[Row], file: Path) -> None:
    """Draw times and memory against the size."""
    titles = ("a plan in a known world [ms]", "world and first plan [ms]", "memory [MB]")
    curves = {f"{way} way": [(row[1], row[5], row[4], row[6]) for row in rows if row[0] == way] for way in WAYS}
    draw_costs(file, "rows and columns of the map", titles, curves)


def main() -> None:
    """Measure, write and draw."""
    parser = sizes_parser(__doc__, SIZES[-1])
    parser.add_argument("--peer", type=int, default=0, help="queries beside pyastar2d")
    args = parser.parse_args()
    if args.peer:
        beside(args.peer)
    rows = [shown(alone(measured, way, size)) for way in WAYS for size in SIZES if size <= args.most]
    write_table(args.table, COLUMNS, rows)
    draw(rows, args.picture)


if __name__ == "__main__":
    main()
