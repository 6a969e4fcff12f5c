"""Parts that plans of disks and arms share: points, time, files, and the table of results."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from evenroad._checks import require_positive
from evenroad._seal import with_digest
from evenroad._terminal import print_table
from evenroad.cli.outputs import require_output
from evenroad.cli.plan import PlanOptions
from evenroad.cli.sampler import TAKES, chosen_rule, chosen_sampler, draw_points, require_seed
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.io import save_json, save_path_csv
from evenroad.planning.plan import solve
from evenroad.planning.planners.prm import PRM
from evenroad.planning.planners.trees import RRTConnect, default_planner
from evenroad.planning.problem import Interrupted, Planner, Problem
from evenroad.planning.result import PlanResult
from evenroad.roadmap import Budget, Roadmap, Rule
from evenroad.world import NamesNearest, World

DEFAULT_N = 512

PROOFS = {
    "exact": "exact: no motion touches anything, up to rounding",
    "certified": "certified: the robot's {} touch nothing anywhere along the path",
    "resolution": "resolution: motions are free at states close together; what lies between them is not seen",
}


KEPT = {
    "via": list,
    "constraint": list,
    "straight": str | None,
    "away": str | None,
    "upright": float | int | None,
    "upright_axis": str | None,
    "tip": str,
    "deg": bool,
}
"""Options of what a path keeps on its way, as a plan records them, and their types there."""


@dataclass(frozen=True)
class Search:
    """How a path is searched and how long: by the default of its world, or along a roadmap of `n` points."""

    budget: Budget
    n: int | None = None
    rule: Rule | None = None


def chosen_search(plan: PlanOptions) -> Search:
    """Return how the options say that a path is searched; InvalidValue for some that do not go together."""
    rule = chosen_rule(plan.k, plan.connect_radius)
    named = plan.sampler not in (None, "auto") or any(getattr(plan, option) for option in TAKES)
    if plan.n is None and rule is None and not named:
        n, seconds = None, RRTConnect.seconds
        require_seed(plan.seed)
    else:
        n, seconds = DEFAULT_N if plan.n is None else plan.n, PRM.seconds
        chosen_sampler(plan, n)
        if plan.improve:
            raise InvalidValue("--improve goes without points: a roadmap of a given number has one best path")
    return Search(Budget(seconds=seconds if plan.time is None else require_positive("time", plan.time)), n, rule)


def chosen_planner(
    plan: PlanOptions, how: Search, world: World, *, search: str = "lazy", certify: bool = False
) -> Planner:
    """Return the planner of the options: a roadmap of points, else the default of the world."""
    if how.n is None:
        return default_planner(world, improve=plan.improve)
    points = draw_points(plan, how.n, world.space.cube_dim)
    return PRM(points, rule=how.rule, search=search, certify=certify)


def output_files(plan: PlanOptions, inputs: Iterable[Path], suffixes: Sequence[str]) -> dict[str, Path]:
    """Return the files of results, suffix -> file; InvalidValue for one that would overwrite an input."""
    if plan.out is not None and not plan.out.name:
        raise InvalidValue(f"--out must end with a file name, got {str(plan.out)!r}")
    suffixes = [*suffixes, *(() if plan.no_picture else ("png",))]
    taken = {source.resolve() for source in inputs}

    def named(stem: Path) -> dict[str, Path]:
        return {suffix: stem.with_name(f"{stem.name}.{suffix}") for suffix in suffixes}

    stem = plan.out if plan.out is not None else Path(plan.world.stem)
    if plan.out is not None and stem.suffix[1:] in (*suffixes, "png"):
        # The name of one of the files stands for all.
        stem = stem.with_suffix("")
    if plan.out is None and any(path.resolve() in taken for path in named(stem).values()):
        stem = Path(f"{plan.world.stem}-plan")
    files = named(stem)
    for path in files.values():
        require_output(f"--out {stem}", path, taken)
    return files


def common_query(plan: PlanOptions, how: Search) -> dict[str, object]:
    """Return the options that every plan has, for the record."""
    names = ("n", "improve", "certified", "sampler", "plain", "skip", "allow_fewer", "seed", "raw")
    return {name: getattr(plan, name) for name in names} | {"time": how.budget.seconds}


def made_of(world: World, **names: str | None) -> dict[str, dict[str, str | None]]:
    """Return the record of what a plan was made in: the name of each file, and the SHA-256 of what was read of it."""
    if isinstance(world, ArmWorld):
        digests = {"robot": world.robot.fingerprint(), "scene": world.scene.fingerprint()}
    else:
        # Imported late: a plan of an arm has no map.
        from evenroad.driving.car_world import CarWorld
        from evenroad.world.gridmap.disk_world import DiskWorld

        assert isinstance(world, DiskWorld | CarWorld), "a plan is of an arm, a disk or a car"
        digests = {"map": world.fingerprint()}
    return {name: {"name": names.get(name), "sha256": digest} for name, digest in digests.items()}


def solve_until_stopped(problem: Problem, planner: Planner | Roadmap | None) -> tuple[PlanResult, bool]:
    """Return a plan, and whether Ctrl-C ended it early: of a path that becomes shorter the best one is kept."""
    try:
        return solve(problem, planner), False
    except Interrupted as stop:
        return stop.best, True


def finish(
    files: dict[str, Path],
    result: PlanResult,
    record: dict[str, object],
    columns: Sequence[str],
    draw: Callable[[Path], None],
    more: Sequence[tuple[str, str]] = (),
    *,
    as_json: bool = False,
) -> int:
    """Write record and path, print a table or the record, draw the picture; return 0 when solved, else 1."""
    before = {path for path in files.values() if path.exists()}
    save_json(files["json"], with_digest(record))
    if "csv" in files:
        # The path of an earlier run, or one in collision, must not pass for this one.
        files["csv"].unlink(missing_ok=True)
        if result.path is None or not result.solved:
            del files["csv"]
        else:
            save_path_csv(files["csv"], result.path, columns)
    if as_json:
        print(json.dumps(record, indent=2, allow_nan=False))
    else:
        print_plan(result, [f"{path} (replaced)" if path in before else str(path) for path in files.values()], more)
    if "png" in files:
        # Last, since it loads and takes longest.
        draw(files["png"])
    return 0 if result.solved else 1


def print_plan(result: PlanResult, files: Iterable[str], more: Sequence[tuple[str, str]] = ()) -> None:
    """Print a plan as a table of two columns, with `more` rows."""
    rows = [("status", f"{result.status}: {result.message}")]
    counts = result.counts
    if result.rule != "none":
        rows.append(("points", str(result.origin)))
    elif "nodes" in counts:
        rows.append(
            (
                "planner",
                f"{result.planner}: {counts['nodes']} nodes, {counts['edges_checked']} motions checked",
            )
        )
    if result.roadmap is not None:
        edges = f"{counts['edges_free']} free of {counts['edges_checked']} checked ({result.rule})"
        rows += [("milestones", f"{counts['valid']} valid of {counts['points']}"), ("edges", edges)]
    if result.cost is not None and result.milestone_cost is not None:
        before = "before it was straightened" if result.roadmap is None else "along the roadmap"
        rows.append(("cost", f"{result.cost:.6g} ({before} {result.milestone_cost:.6g})"))
    if result.stages and result.cost is not None and "rounds" in counts:
        first = result.stages[0]
        after = f"{first.cost:.6g} after {1e3 * first.seconds:.1f} ms"
        rows.append(("improved", f"from {after}, in {counts['rounds']} rounds"))
    if result.proof is not None:
        rows.append(("proved", PROOFS[result.proof].format(result.bodies)))
    if result.clearance is not None:
        # An arm's is in metres, a disk's in units of its map.
        pair, of_arm = result.nearest, isinstance(result.world, NamesNearest)
        least = " m at least" if of_arm else " at least"
        least += "" if pair is None else f", between {pair[0]!r} and {pair[1]!r}"
        rows.append(("clearance", f"{result.clearance:.6g}{least}"))
    # Few digits, so that all phases fit into one line.
    times = {phase: 1e3 * seconds for phase, seconds in result.timings.items()}
    if times:
        spent = ", ".join(f"{phase} {ms:.{int(ms < 10)}f}" for phase, ms in times.items())
        rows.append(("time [ms]", spent))
    rows += [("note", note) for note in result.notes]
    rows += [*more, ("files", ", ".join(files))]
    print_table(rows, first="green" if result.solved else "red")
