"""Certificates of paths: are all accepted, how large are they, and how long do writing and checking take?

    python -m studies.benchmarks.path_certificates FOLDER... --queries 100 --out out/certificates.csv
    python -m studies.benchmarks.path_certificates ur5 panda --queries 1000      # robots by their names

Each robot's file is tried in scenes with one kind of obstacle each: boxes, other primitives, a mesh, a cloud, a height
map, boxes with clearance, boxes with an object in the hand, and boxes around a base that moves in the plane.  Obstacles
are drawn anew for each query, between two free configurations.  A row is one path that evenroad proved; `reason` says
why it has no certificate, or why a checker refuses it.  Times are of processors: of the plan, of the writer, of a check
without reading files, and of the checker in C as a command, which reads all (`make checker` compiles it).
"""

from __future__ import annotations

import argparse
import csv
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from studies.benchmarks.robots import robots_in
from studies.benchmarks.rows import parser_of, write_rows

import evenroad as er
from evenroad.certificates.certify import Sources, certify
from evenroad.errors import EvenroadError
from evenroad.geometry.mesh import convex_hull, height_map
from evenroad.loading.load import RobotOptions, load_model
from evenroad.loading.model import RobotModel
from evenroad.robots.kinematics import capsule_endpoints
from evenroad_verify.certificate import read_certificate
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import verify
from evenroad_verify.errors import BadInput, Refused

COLUMNS = (
    "robot",
    "kind",
    "query",
    "joints",
    "motions",
    "plan_ms",
    "write_ms",
    "check_ms",
    "c_ms",
    "bytes",
    "answer",
    "reason",
)
SECONDS = 2.0
TRIES = 10
IN_C = Path("out/evenroad-verify")
BASE = "sweep"
BASE_SRDF = """<robot name="{name}">
  <virtual_joint name="{base}" type="planar" parent_frame="floor" child_link="{root}"/>
  <group name="all">{joints}</group>
</robot>"""


@dataclass(frozen=True)
class Around:
    """Where a robot's links are: the obstacles of a scene are drawn there."""

    rng: np.random.Generator
    low: np.ndarray
    high: np.ndarray

    def place(self) -> np.ndarray:
        return self.rng.uniform(self.low, self.high)

    def size(self, share: float = 0.15) -> float:
        return float(share * np.max(self.high - self.low) * self.rng.uniform(0.3, 1.0))


def boxes(around: Around) -> list[er.Shape]:
    return [
        er.Box([around.size() for _ in range(3)], xyz=around.place(), rpy=around.rng.normal(size=3)) for _ in range(5)
    ]


def primitives(around: Around) -> list[er.Shape]:
    sphere, place = er.Sphere(around.size(0.1), xyz=around.place()), around.place
    turned = {"rpy": tuple(around.rng.normal(size=3))}
    cylinder = er.Cylinder(around.size(0.05), around.size(0.5), xyz=place(), **turned)
    return [sphere, cylinder, er.Capsule(around.size(0.05), around.size(0.5), xyz=place(), **turned)]


def mesh(around: Around) -> list[er.Shape]:
    points = around.rng.normal(size=(30, 3))
    hull = convex_hull(around.size() * points / np.linalg.norm(points, axis=1, keepdims=True))
    return [er.Mesh(hull, xyz=around.place()) for _ in range(2)]


def cloud(around: Around) -> list[er.Shape]:
    points = around.place() + around.size() * around.rng.uniform(-1.0, 1.0, (2000, 3))
    return [er.PointCloud(points, radius=0.01)]


def ground(around: Around) -> list[er.Shape]:
    heights = around.rng.uniform(0.0, around.size(0.1), (20, 20))
    side = float(np.max(around.high - around.low))
    return [er.Mesh(height_map(heights, side / 19.0, depth=0.2), xyz=(*around.low[:2], around.low[2]))]


KINDS: dict[str, Callable[[Around], list[er.Shape]]] = {
    "boxes": boxes,
    "primitives": primitives,
    "mesh": mesh,
    "cloud": cloud,
    "ground": ground,
    "clearance": boxes,
    "held": boxes,
    "base": boxes,
}


@dataclass(frozen=True)
class Tried:
    """A robot as its file is read, with an SRDF or none."""

    model: RobotModel
    sources: Sources

    @classmethod
    def read(cls, path: Path | str, srdf: Path | None = None, group: str | None = None) -> Tried:
        options: RobotOptions = {"srdf": srdf, "group": group}
        try:
            model = load_model(path, **options)
        except EvenroadError as error:
            if "--use-visuals" not in str(error):
                raise
            options["use_visuals"] = True
            model = load_model(path, **options)
        visuals = options.get("use_visuals", False)
        return cls(model, Sources.named(path, None, srdf, embed=True, use_visuals=visuals))

    def on_a_base(self, folder: Path) -> Tried:
        """Return the same robot on a base that moves in the plane."""
        robot = self.model.robot
        joints = "".join(f'<joint name="{name}"/>' for name in (BASE, *robot.group))
        srdf = folder / "base.srdf"
        srdf.write_text(BASE_SRDF.format(name=robot.name, base=BASE, root=robot.links[0], joints=joints))
        return self.read(self.sources.robot, srdf, "all")


def rows_of(path: Path | str, queries: int, seed: int) -> Iterator[dict[str, Any]]:
    """Yield a row for each path of a robot that is planned."""
    tried = Tried.read(path)
    rng = np.random.default_rng(seed)
    empty = er.ArmWorld(tried.model.robot)
    q = empty.space.from_cube(rng.random((200, empty.space.cube_dim)))
    endpoints = capsule_endpoints(tried.model.robot, q).reshape(-1, 3)
    low, high = np.quantile(endpoints, [0.02, 0.98], axis=0)
    with tempfile.TemporaryDirectory() as folder:
        moving: Tried | None = None
        for query in range(queries):
            kind = list(KINDS)[query % len(KINDS)]
            around = Around(np.random.default_rng([seed, query]), low, high + 0.05)
            row = {"kind": kind, "query": query, "joints": empty.space.dim}
            try:
                if kind == "base":
                    moving = moving or tried.on_a_base(Path(folder))
                yield row | _tried(moving if moving and kind == "base" else tried, kind, around, Path(folder))
            except EvenroadError as error:
                yield row | {"answer": "none", "reason": str(error)[:200]}


def _tried(tried: Tried, kind: str, around: Around, folder: Path) -> dict[str, Any]:
    """Return what becomes of one query."""
    clearance, robot = 0.01 if kind == "clearance" else 0.0, tried.model.robot
    if kind == "held":
        body = er.Box([around.size(0.1) for _ in range(3)], xyz=0.05 * around.rng.normal(size=3))
        robot = robot.holding(er.robot.HeldObject("held", body, robot.links[-1], robot.links[len(robot.links) // 2 :]))
    limits = {f"{BASE}/{each}": (-0.5, 0.5) for each in "xy"} if kind == "base" else {}
    for _ in range(TRIES):
        scene = er.Scene(KINDS[kind](around), limits=limits)
        world = er.ArmWorld(er.robot.in_scene(robot, scene), scene, clearance=clearance)
        q = world.space.from_cube(around.rng.random((60, world.space.cube_dim)))
        free = q[world.valid(q)]
        if len(free) > 1:
            break
    else:
        return {"answer": "no query"}
    begin = time.process_time()
    result = er.plan(world, free[0], free[-1], seconds=SECONDS)
    row: dict[str, Any] = {"plan_ms": _ms(begin), "motions": 0 if result.path is None else len(result.path) - 1}
    if not result.solved or result.path is None:
        return row | {"answer": "no path"}
    file, begin = folder / "path.cert", time.process_time()
    try:
        certify(world, result.path, tried.sources, file)
    except EvenroadError as error:
        return row | {"answer": "not written", "reason": str(error)[:200]}
    row["write_ms"] = _ms(begin)
    return row | _checked(file)


def _checked(file: Path) -> dict[str, Any]:
    """Return what both checkers say of a certificate."""
    data = file.read_bytes()
    read = read_certificate(data)
    row: dict[str, Any] = {"bytes": len(data) - sum(8 + len(each) for each in read.carried)}
    try:
        inputs = read_inputs(None, None, None, {}, read)
        begin = time.process_time()
        verify(data, inputs)
    except (Refused, BadInput) as error:
        return row | {"answer": "refused", "reason": str(error)[:200]}
    row["check_ms"] = _ms(begin)
    if IN_C.is_file():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([IN_C, file], capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        row["c_ms"] = round(1e3 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime), 3)
        if done.returncode:
            said = (done.stdout + done.stderr).strip()
            return row | {"answer": "refused in C", "reason": said[:200]}
    return row | {"answer": "accepted"}


def _ms(begin: float) -> float:
    return round(1e3 * (time.process_time() - begin), 3)


def summary(rows: list[dict[str, Any]]) -> str:
    """Return what rows say together."""
    written = [row for row in rows if row["answer"] in ("accepted", "refused", "refused in C")]
    accepted = [row for row in written if row["answer"] == "accepted"]
    if not accepted:
        return f"{len(rows)} queries, {len(written)} written, none accepted"

    def of(name: str) -> np.ndarray:
        return np.array([float(row[name]) for row in accepted])

    check, plan, write, size = of("check_ms"), of("plan_ms"), of("write_ms"), of("bytes")
    in_c = np.array([float(row["c_ms"] or "nan") for row in accepted])
    failed = sum(row["answer"] == "not written" for row in rows)
    return (
        f"{len(written)} written, {failed} not; {100.0 * len(accepted) / len(written):.2f} % accepted; bytes: median"
        f" {np.median(size):.0f}, most {size.max():.0f}; check: median {np.median(check):.1f} ms, most"
        f" {check.max():.0f}; by planning: median {np.median(check / plan):.1f}; in C: median {np.median(in_c):.1f} ms;"
        f" writer: first {write[0]:.1f} ms, median {np.median(write):.1f}, by planning {np.median(write / plan):.1f}"
    )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("robots", nargs="*", help="folders, files, or names")
    parser.add_argument("--queries", type=int, default=12, help="of each robot")
    parser.add_argument("--out", type=Path, default=Path("out/path_certificates.csv"))
    parser.add_argument("--limit", type=float, default=300.0, help="seconds for one robot")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        warnings.simplefilter("ignore")
        for row in rows_of(options.one, options.queries, 0):
            csv.DictWriter(sys.stdout, COLUMNS, restval="").writerow({"robot": options.one, **row})
            sys.stdout.flush()
        return
    options.out.parent.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    for name, path in _chosen(options.robots):
        command = [sys.executable, "-m", "studies.benchmarks.path_certificates", "--one", str(path)]
        command += ["--queries", str(options.queries)]
        with tempfile.TemporaryFile("w+") as out:
            try:
                done = subprocess.run(command, stdout=out, stderr=subprocess.PIPE, text=True, timeout=options.limit)
                failed = done.stderr.strip().splitlines()[-1:] if done.returncode else []
            except subprocess.TimeoutExpired:
                failed = [f"out of time: {options.limit:g} s"]
            out.seek(0)
            mine = [row | {"robot": name} for row in csv.DictReader(out, COLUMNS)]
        mine += [{"robot": name, "answer": "failed", "reason": text[:200]} for text in failed]
        rows += mine
        print(f"{name:50} {summary(mine)} {' '.join(failed)[:100]}", flush=True)
        write_rows(options.out, COLUMNS, rows)
    print(f"{len({row['robot'] for row in rows})} robots: {summary(rows)}")


def _chosen(robots: list[str]) -> Iterator[tuple[str, Path | str]]:
    for each in robots:
        if Path(each).is_dir():
            yield from robots_in([Path(each)])
        else:
            yield each, each


if __name__ == "__main__":
    main()
