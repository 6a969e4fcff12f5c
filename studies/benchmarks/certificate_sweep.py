"""Certificates of paths: are all accepted, how large are they, and how long do writing and checking take?

    python -m studies.benchmarks.certificate_sweep FOLDER... --queries 3 --out out/certificates.csv
    python -m studies.benchmarks.certificate_sweep ur5 panda.urdf --queries 1300     # names or files

Each robot is asked random questions among all kinds of obstacle, with clearance, padding, allowed contacts, a held
object, a base that moves, rounded corners or a constraint (certificate_queries.py).  A row is one question; `reason`
says why its path has no certificate, or why a checker refuses it.  Times are of processors: of the plan, of the writer,
of a check without reading files, and of the checker in C as a command, which reads all (`make checker` compiles it).
Rows are written as they come.  Questions that the file already answers are not asked again; `--minutes` ends a slice.
"""

from __future__ import annotations

import argparse
import csv
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from studies.benchmarks.certificate_queries import Draw, Tried, driven, kept
from studies.benchmarks.robots import robots_in
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.certificates.certify import certify
from evenroad.errors import EvenroadError
from evenroad.roadmap import Budget
from evenroad_verify.certificate import read_certificate
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import verify
from evenroad_verify.errors import BadInput, Refused

COLUMNS = ("robot", "query", "kinds", "joints", "motions", "plan_ms", "write_ms", "check_ms", "c_ms", "bytes")
COLUMNS += ("answer", "reason")
WRITTEN = ("accepted", "refused", "refused in C", "crashed in C")
IN_C = Path("out/evenroad-verify")
PACKAGE = re.compile(r"package://([^/\"]+)/([^\"]+)\"")
AT_ONCE = 50
"""Questions that a process answers."""
PATIENCE = 120.0
"""How long a plan, and the checker in C, may take [s]."""


def rows_of(path: Path | str, numbers: Iterable[int], motions: int, keep: Path | None) -> Iterator[dict[str, Any]]:
    """Yield a row for each question about a robot; certificates that are refused are kept in a folder, if there is one.

    A robot that cannot be read raises.
    """
    tried, moving = Tried.read(path, packages_of(path)), None
    low, high = tried.box()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "path.cert"
        for number in numbers:
            draw = Draw.of(Path(path).name, number, low, high)
            row = {"query": number, "kinds": " ".join([*draw.kinds, *sorted(draw.extras)])}
            try:
                if "base" in draw.extras:
                    moving = moving or tried.on_a_base(Path(folder))
                row |= _answered(draw, moving if moving and "base" in draw.extras else tried, motions, file)
            except EvenroadError as error:
                row |= {"answer": "no question", "reason": str(error)}
            if keep and row["answer"] in WRITTEN[1:]:
                keep.mkdir(parents=True, exist_ok=True)
                (keep / f"{Path(path).stem}-{number}.cert").write_bytes(file.read_bytes())
            yield row | {"reason": " ".join(str(row.get("reason", "")).split())[:200]}


def packages_of(path: Path | str) -> dict[str, Path]:
    """Return folders of the packages that a robot's file names, which lie somewhere beside or above it."""
    found: dict[str, Path] = {}
    if not Path(path).is_file():
        return found
    for name, rest in PACKAGE.findall(Path(path).read_text("utf-8", "replace")):
        for above in [] if name in found else list(Path(path).resolve().parents)[:4]:
            whole = next((each for each in above.rglob(Path(rest).name) if str(each).endswith(f"/{rest}")), None)
            if whole is not None:
                found[name] = Path(str(whole).removesuffix(f"/{rest}"))
                break
    return found


def _answered(draw: Draw, tried: Tried, motions: int, file: Path) -> dict[str, Any]:
    """Return what becomes of one question."""
    question = draw.question(tried)
    if question is None:
        return {"answer": "no question", "reason": "no two free states"}
    begin = time.process_time()
    limits = Budget(seconds=PATIENCE, motions=motions)
    result = er.plan(question.world, question.start, question.goal, limits=limits)
    row: dict[str, Any] = {"joints": question.world.space.dim, "plan_ms": _ms(begin)}
    if not result.solved or result.path is None:
        return row | {"answer": "no path", "reason": result.status}
    row["motions"] = len(result.path) - 1
    try:
        states = driven(result) if "driven" in draw.extras else None
        begin = time.process_time()
        certify(kept(question, result.path), result.path, tried.sources, file, states=states)
    except EvenroadError as error:
        return row | {"answer": "not written", "reason": str(error)}
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
        return row | {"answer": "refused", "reason": str(error)}
    row["check_ms"] = _ms(begin)
    if IN_C.is_file():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([IN_C, file], capture_output=True, text=True, timeout=PATIENCE)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        row["c_ms"] = round(1e3 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime), 3)
        if done.returncode:
            answer = "refused in C" if done.returncode in (1, 2) else "crashed in C"
            return row | {"answer": answer, "reason": done.stdout + done.stderr}
    return row | {"answer": "accepted"}


def _ms(begin: float) -> float:
    return round(1e3 * (time.process_time() - begin), 3)


def summary(rows: list[dict[str, Any]]) -> str:
    """Return what rows say together: answers, and sizes and times by the number of joints."""
    counts = Counter(str(row["answer"]) for row in rows)
    accepted = [row for row in rows if row["answer"] == "accepted"]
    written = sum(counts[each] for each in WRITTEN)
    lines = [", ".join(f"{count} {answer}" for answer, count in counts.most_common())]
    lines += [f"{len({row['robot'] for row in accepted})} robots, {len(accepted)} of {written} certificates accepted"]
    for least, most in ((1, 3), (4, 5), (6, 6), (7, 7), (8, 13), (14, 99)):
        some = [row for row in accepted if least <= int(row["joints"]) <= most]
        if some:
            size, check, in_c, write, plan = (
                np.array([float(row[name] or "nan") for row in some])
                for name in ("bytes", "check_ms", "c_ms", "write_ms", "plan_ms")
            )
            lines.append(
                f"{least}-{most} joints, {len(some)}: bytes {np.median(size):.0f}, most {size.max():.0f}; check"
                f" {np.median(check):.1f} ms, most {check.max():.0f}, by planning {np.median(check / plan):.1f}; in C"
                f" {np.median(in_c):.1f} ms; writer by planning {np.median(write / plan):.1f}"
            )
    return "\n".join(lines)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("robots", nargs="*", help="folders, files, or names")
    parser.add_argument("--queries", type=int, default=3, help="of each robot")
    parser.add_argument("--out", type=Path, default=Path("out/certificates.csv"))
    parser.add_argument("--motions", type=int, default=10_000, help="that a plan may check: its time does not count")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds of processor for one robot, or 50 questions")
    parser.add_argument("--minutes", type=float, default=600.0, help="for this slice")
    parser.add_argument("--keep", type=Path, help="a folder for certificates that are refused")
    parser.add_argument("--one", type=int, nargs="*", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one is not None:
        warnings.simplefilter("ignore")
        writer = csv.DictWriter(sys.stdout, COLUMNS, restval="")
        for row in rows_of(options.robots[0], options.one, options.motions, options.keep):
            writer.writerow({"robot": options.robots[0], **row})
            sys.stdout.flush()
        return
    end = time.monotonic() + 60.0 * options.minutes
    more = ["--motions", str(options.motions), *(["--keep", str(options.keep)] if options.keep else [])]
    for path in _chosen(options.robots):
        mine = [row for row in _read(options.out) if row["robot"] == path]
        left = sorted(set(range(options.queries)) - {int(row["query"] or -1) for row in mine})
        failed = any(row["answer"] == "failed" for row in mine)
        for some in [] if failed else [left[i : i + AT_ONCE] for i in range(0, len(left), AT_ONCE)]:
            if time.monotonic() < end:
                _ask(path, some, more, options.limit, options.out)
    rows = _read(options.out)
    print(summary(rows))


def _ask(path: str, asked: list[int], more: list[str], limit: float, out: Path) -> None:
    """Ask a process of its own about a robot, whose rows are added to a file; what ends it early is a row, too."""
    command = [sys.executable, "-m", "studies.benchmarks.certificate_sweep", path, "--one", *map(str, asked), *more]
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("a", newline="") as file:
        if file.tell() == 0:
            csv.DictWriter(file, COLUMNS).writeheader()
        file.flush()
        try:
            done = subprocess.run(
                command,
                stdout=file,
                stderr=subprocess.PIPE,
                text=True,
                timeout=20.0 * limit,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit))),
            )
            failed = (done.stderr.strip().splitlines() or ["no reason"])[-1] if done.returncode else ""
            failed = f"out of time: {limit:.0f} s" if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else failed
        except subprocess.TimeoutExpired:
            failed = f"out of time: {limit:.0f} s"
        if failed:
            file.seek(0, 2)
            csv.DictWriter(file, COLUMNS, restval="").writerow(
                {"robot": path, "answer": "failed", "reason": failed[:200]}
            )


def _read(out: Path) -> list[dict[str, Any]]:
    if not out.exists():
        return []
    with out.open(newline="") as file:
        return list(csv.DictReader(file))


def _chosen(robots: list[str]) -> list[str]:
    """Return names and files, of all folders in an order that mixes them: what is done at any time is a sample."""
    given = [each for each in robots if not Path(each).is_dir()]
    found = [str(path) for _, path in robots_in([Path(each) for each in robots if Path(each).is_dir()])]
    return given + [found[i] for i in np.random.default_rng(0).permutation(len(found))]


if __name__ == "__main__":
    main()
