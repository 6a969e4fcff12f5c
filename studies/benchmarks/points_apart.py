"""Which points plan best: success of candidates in families of random worlds, world by world.

    python -m studies.benchmarks.points_apart --use tuning -d 3 --worlds 60 --csv OUT.csv
    python -m studies.benchmarks.points_apart --family fair --use reporting -d 3 --worlds 150
    python -m studies.benchmarks.points_apart --family arms --use reporting --only sobol uniform --beside sobol

The family ``apart`` has start and goal at opposite faces: slots, forests, rooms with doors, caves, bars.  ``fair`` is
the periodic one: balls and boxes.  ``anywhere`` has start and goal anywhere, among blocks that bound all axes and in
corridors, and ``arms`` has arms among boxes: three that ship, and a Panda where the extra [robots] is installed.

Roadmaps are ``k symmetrised``; start and goal are joined by the rule alone ("rule"), and to the 100 nearest milestones
as well, as a plan does ("plan").  All candidates see the same worlds.  A difference is from `--beside`, in points,
paired by world, with its standard error.

World after world takes the next of eight numbers of points, 0.88 to 1.12 times that of the family: which lattice is
the best one depends on the number by chance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of, write_rows

from evenroad._arrays import Bools
from evenroad.errors import NotAvailable
from evenroad_studies.bench.task import Problem
from evenroad_studies.candidates import CANDIDATES
from evenroad_studies.connected import connected
from evenroad_studies.problems import anywhere, apart, fair
from evenroad_studies.problems.apart import Use

KS = (4, 6, 10, 20)
HOW = ("rule", "plan")
CELLS = [f"{how} {k}" for how in HOW for k in KS]
FIRST_FAIR = 1_200_000
"""Number of the first periodic world: lower ones were looked at before."""
TIMES = (0.88, 0.92, 0.95, 0.98, 1.0, 1.03, 1.07, 1.12)
"""Numbers of points over that of the family."""
Make = Callable[[int], Problem]


FAMILIES = ("apart", "fair", "anywhere", "arms")
ARM_JOINTS = sorted({d for _, d in anywhere.ARMS.values()})


def problems(use: Use, d: int, family: str) -> Iterator[tuple[str, Make]]:
    """Yield the kinds of worlds of a family, with what makes the problem of a number."""
    if family == "fair":
        stream = fair.Stream.TUNING if use is Use.TUNING else fair.Stream.REPORTING
        for each in (fair.Family.BALLS, fair.Family.BOXES):
            size = fair.SIZES[each, d][1]
            yield each.name.lower(), lambda i, f=each, s=size: fair.make_instance(stream, f, d, 50, s, FIRST_FAIR + i)
    elif family == "apart":
        for kind in apart.Kind:
            size = apart.SIZES[use, kind, d]
            yield kind.name.lower(), lambda i, k=kind, s=size: apart.make(use, k, d, s, i)
    else:
        for place in anywhere.Kind:
            if (place in anywhere.ARMS) != (family == "arms") or not anywhere.is_here(place):
                continue
            if (place, d) in anywhere.COUNTS:
                size = anywhere.SIZES[use, place, d]
                yield place.name.lower(), lambda i, k=place, s=size: anywhere.make(use, k, d, s, i)


def number_of_points(family: str, d: int) -> int:
    """Return the number of points of the worlds of a family's calibration."""
    return apart.COUNTS[d] if family != "arms" else anywhere.ARM_POINTS


def measured(make_problem: Make, names: list[str], counts: Sequence[int], d: int, worlds: range) -> Bools:
    """Return whether each candidate joins start and goal, (worlds, candidates, 2, ks)."""
    found = np.zeros((len(worlds), len(names), 2, len(KS)), dtype=np.bool_)
    for i, number in enumerate(worlds):
        problem, n = make_problem(number), counts[number % len(counts)]
        for j, name in enumerate(names):
            found[i, j] = connected(problem, CANDIDATES[name](n, d, number), KS)
    return found


def available(names: Sequence[str], n: int, d: int) -> list[str]:
    """Return the candidates that have sets of this size."""
    kept = []
    for name in names:
        try:
            CANDIDATES[name](n, d, 0)
        except NotAvailable:
            continue
        kept.append(name)
    return kept


def rows_of(found: Bools, names: list[str], beside: str) -> Iterator[dict[str, str]]:
    """Yield the success of each candidate [%] and how much more that is than another's, with its standard error."""
    base = found[:, names.index(beside)].astype(float)
    for j, name in enumerate(names):
        row = {"set": name, "worlds": str(len(found))}
        here = found[:, j].astype(float)
        more = here - base
        error = more.std(axis=0, ddof=1) / np.sqrt(len(more))
        for link, how in enumerate(HOW):
            for at, k in enumerate(KS):
                row[f"{how} {k}"] = f"{100 * here[:, link, at].mean():.1f}"
                row[f"{how} {k} more"] = f"{100 * more[:, link, at].mean():+.1f}"
                row[f"{how} {k} error"] = f"{100 * error[link, at]:.1f}"
        yield row


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--use", choices=[use.name.lower() for use in Use], default="tuning")
    parser.add_argument("--family", choices=FAMILIES, default="apart")
    parser.add_argument("-d", type=int, nargs="*", help="dimensions; default: all of the family")
    numbers = parser.add_mutually_exclusive_group()
    numbers.add_argument("-n", type=int, help="points; default: eight numbers about those of the calibration")
    numbers.add_argument("--about", type=int, help="eight numbers about this one")
    parser.add_argument("--worlds", type=int, default=60, help="of each kind")
    parser.add_argument("--first", type=int, default=0, help="number of the first world")
    parser.add_argument("--kinds", nargs="*", help="of worlds; default: all of the family")
    parser.add_argument("--only", nargs="*", default=list(CANDIDATES))
    parser.add_argument("--beside", default="even")
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    use, rows = Use[options.use.upper()], []
    worlds = range(options.first, options.first + options.worlds)
    for d in options.d or (ARM_JOINTS if options.family == "arms" else apart.COUNTS):
        n = options.n or options.about or number_of_points(options.family, d)
        counts = [n] if options.n else [round(share * n) for share in TIMES]
        names = available(options.only, counts[0], d)
        kinds = problems(use, d, options.family)
        asked = [(kind, make) for kind, make in kinds if options.kinds is None or kind in options.kinds]
        found = {kind: measured(make, names, counts, d, worlds) for kind, make in asked}
        found["all"] = np.concatenate(list(found.values()))
        here = {"use": options.use, "family": options.family, "d": str(d)}
        here["n"] = " ".join(map(str, counts))
        for kind, each in found.items():
            rows += [here | {"kind": kind} | row for row in rows_of(each, names, options.beside)]
        for row in rows[-len(names) :]:
            cells = [f"{row[c]:>5} {row[f'{c} more']:>5} ({row[f'{c} error']})" for c in CELLS]
            print(f"d={d} n={n} {row['set']:16}", *cells, flush=True)
        # After each dimension, so that a long run leaves what it has.
        write_rows(options.csv, list(rows[0]), rows)


if __name__ == "__main__":
    main()
