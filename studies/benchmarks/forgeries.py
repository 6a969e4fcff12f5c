"""Forged and broken certificates, which both checkers must judge alike, and none of which may hide a contact.

    python -m studies.benchmarks.forgeries --count 100000            # forgeries: files changed, digests remade or not
    python -m studies.benchmarks.forgeries --count 0 --flips 1000000 # flipped bytes: no crash, no hang

A forgery changes a certificate (a waypoint, an answer, a direction, a joint's name, what is kept, a ball, a witness, a
cell, a goal; or it is another scene's) or its files (a number of the robot or scene, limits, an allowed contact, a pair
of the SRDF, a mesh, a cloud).  There are paths, curves and constraints, with and without carried files, and proofs of
no path to configurations and poses.  Both checkers must agree on each.  Without a new digest, changed files must be
refused.  Those that are accepted although files or motions have changed are sampled by the oracle of the tests: none
may touch by more than 2 um.  Flipped bytes go to the checker in C, compiled with sanitizers; the one in Python sees
every hundredth, and a tenth of those that are accepted.
"""

from __future__ import annotations

import argparse
import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh
from tests.certificates.checker_in_c import ACCEPTED, ManyChecks
from tests.certificates.no_path import Parts as NoPathParts
from tests.certificates.no_path import accepts as accepts_no_path
from tests.certificates.written import accepts, joined, parts_of, with_digest

from evenroad.certificates.certify import Sources
from evenroad_verify.certificate import read_certificate
from evenroad_verify.claim import Inputs
from evenroad_verify.errors import BadInput, Refused

from .forgery_cases import Case, cases, pairs_case

IN_EACH = 40
"""Forgeries about the same changed files."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=2000, help="number of forgeries")
    parser.add_argument("--flips", type=int, default=20_000, help="number of files with flipped bytes")
    parser.add_argument("--seed", type=int, default=53)
    parser.add_argument("--judged", type=int, default=5, help="one of so many that are accepted is sampled")
    options = parser.parse_args()
    began = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        made = cases(Path(folder))
        if options.count:
            print_forgeries(made, options.count, options.judged, np.random.default_rng(options.seed))
        if options.flips:
            print_flips([*made, pairs_case(Path(folder))], options.flips, np.random.default_rng(options.seed))
    print(f"{time.process_time() - began:.0f} s of processor time")


def print_forgeries(made: list[Case], count: int, judged: int, rng: np.random.Generator) -> None:
    """Forge certificates of all kinds, and print what the checkers said, at every tenth as well."""
    said, shown = Counter[str](), count // 10
    with ManyChecks() as in_c:
        while said["forgeries"] < count:
            case = made[rng.integers(len(made))]
            number = min(count - said["forgeries"], IN_EACH if len(case.data) < 5000 else IN_EACH // 4)
            with tempfile.TemporaryDirectory(dir=case.sources.scene.parent if _is_own(case) else None) as folder:
                sources = case.sources if rng.random() < 0.4 or case.carries else changed(case, rng, Path(folder))
                forge_about(case, sources, number, made, in_c, said, judged, rng)
            if said["forgeries"] >= shown:
                shown += max(1, count // 10)
                print({key: said[key] for key in ("forgeries", "accepted", "judged", "false", "disagree")}, flush=True)
    for key, number in sorted(said.items()):
        print(f"{key}: {number}")


def _is_own(case: Case) -> bool:
    """Return whether the files of a case are its own: those of shipped robots are not written beside."""
    return (case.sources.scene.parent / "arm.urdf").exists()


def forge_about(case, sources, number, made, in_c, said, judged, rng) -> None:
    """Forge some certificates about the same files, and count what the checkers said."""
    is_read = in_c.read(sources.robot, sources.scene, sources.srdf) == ACCEPTED
    own = None if case.carries else inputs_or_none(case, case.data, sources)
    if not case.carries and is_read != (own is not None):
        said["disagree about files"] += 1
    if not is_read:
        said["files that cannot be read"] += 1
        return
    for _ in range(number):
        kind, data = forged(case, made, rng)
        has_changed, is_new = sources is not case.sources, rng.random() < 0.8
        if case.carries and rng.random() < 0.5:
            data, has_changed = with_carried_changed(data, case.data, rng), True
        inputs = inputs_or_none(case, data, sources) if case.carries else own
        data = with_digest(data, inputs) if is_new and inputs is not None else data
        accepted = inputs is not None and (accepts_no_path if case.of_no_path else accepts)(data, inputs)
        said["forgeries"] += 1
        said["disagree"] += (in_c.code(data) == ACCEPTED) != accepted
        if has_changed and not is_new:
            said["files changed without a new digest"] += 1
            said["files changed without a new digest, accepted"] += accepted
        said["accepted"] += accepted
        said[f"accepted, {kind}"] += accepted
        if accepted and not case.carries and said["accepted"] % judged == 0:
            said["judged"] += 1
            said["false"] += case.is_false(data, sources)


def inputs_or_none(case: Case, data: bytes, sources: Sources) -> Inputs | None:
    """Return what the checker in Python reads, None where it refuses to."""
    try:
        return case.inputs(data, sources)
    except (Refused, BadInput):
        return None


def changed(case: Case, rng: np.random.Generator, folder: Path) -> Sources:
    """Return files of a case of which one is changed, in a folder."""
    files = {"robot": case.sources.robot, "scene": case.sources.scene, "srdf": case.sources.srdf}
    beside = [each for each in ("wall.stl", "scan.xyz") if (case.sources.scene.parent / each).exists()]
    for name in beside:
        (folder / name).write_bytes((case.sources.scene.parent / name).read_bytes())
    kinds = ["scene"] * 3 + ["robot"] * _is_own(case) + ["srdf"] * (files["srdf"] is not None)
    kind = str(rng.choice(kinds + beside * 2))
    size = 10.0 ** rng.uniform(-6, -1) * rng.choice([-1.0, 1.0])
    if kind == "wall.stl":
        trimesh.creation.box(np.array([0.2, 0.4, 0.3]) * (1.0 + size)).export(folder / kind)
    elif kind == "scan.xyz":
        rows = np.loadtxt(folder / kind)
        rows[rng.integers(len(rows)), rng.integers(3)] += size
        np.savetxt(folder / kind, rows, "%.9f")
    copies = dict[str, Path | None]()
    for name, file in files.items():
        copies[name] = None if file is None else folder / file.name
        if file is not None:
            text = file.read_text()
            new = with_a_change(text.split("states:")[0], name, size, rng) if name == kind else text
            (folder / file.name).write_text(new)
    return Sources(copies["robot"], copies["scene"], copies["srdf"])


def with_a_change(text: str, name: str, size: float, rng: np.random.Generator) -> str:
    """Return a text with a number changed, or without one of its lines that disable or allow a contact."""
    lines = [line for line in text.split("\n") if "disable_collisions" in line or ", shoulder_link]" in line]
    if name == "srdf" or (lines and rng.random() < 0.2):
        return text.replace(str(rng.choice(lines)), "") if name == "srdf" else text.replace(", shoulder_link]", "]")
    numbers = list(re.finditer(r"-?\d+\.\d+", text))
    at = numbers[rng.integers(len(numbers))]
    return text[: at.start()] + f"{float(at.group()) + size:.9f}" + text[at.end() :]


def with_carried_changed(data: bytes, own: bytes, rng: np.random.Generator) -> bytes:
    """Return a certificate that carries what another one does, with another number in one of the texts."""
    carried = read_certificate(own).carried
    head, files = data[: len(data) - sum(8 + len(each) for each in carried)], list(carried)
    texts = [i for i, each in enumerate(files) if b"\0" not in each and re.search(rb"\d\.\d", each)]
    which = int(rng.choice(texts))
    numbers = list(re.finditer(rb"-?\d+\.\d+", files[which]))
    at = numbers[rng.integers(len(numbers))]
    size = 10.0 ** rng.uniform(-6, -1) * rng.choice([-1.0, 1.0])
    files[which] = files[which][: at.start()] + f"{float(at.group()) + size:.9f}".encode() + files[which][at.end() :]
    return head + b"".join(len(each).to_bytes(8, "little") + each for each in files)


def forged(case: Case, made: list[Case], rng: np.random.Generator) -> tuple[str, bytes]:
    """Return a kind of forgery, and the file."""
    other = made[rng.integers(len(made))]
    if rng.random() < 0.03 and other.of_no_path == case.of_no_path and other.carries == case.carries:
        return "another", with_digest_of(other.data, case.data)
    if rng.random() < 0.1:
        return "none", case.data
    return _forged_no_path(case.data, rng) if case.of_no_path else _forged_path(case.data, rng)


def with_digest_of(data: bytes, other: bytes) -> bytes:
    """Return a certificate with the digest of another one."""
    digest = re.search(rb"inputs ([0-9a-f]{64})", other)
    return re.sub(rb"inputs [0-9a-f]{64}", b"inputs " + digest.group(1), data, count=1)


def _forged_path(data: bytes, rng: np.random.Generator) -> tuple[str, bytes]:
    lines, points, packed, directions = parts_of(data)
    size = 10.0 ** rng.uniform(-6, 0)
    kinds = [
        "waypoint",
        "waypoint",
        "answer",
        "step",
        "joint",
        "kept",
        "held",
        *["turned", "dropped"] * bool(len(directions)),
    ]
    limits = [i for i, line in enumerate(lines) if line.split(" ")[0] in ("axis", "point", "tolerance", "clearance")]
    kind = str(rng.choice(kinds + ["claim"] * (3 if limits else 0)))
    counts = {line.split(" ")[0]: i for i, line in enumerate(lines)}
    if kind == "waypoint":
        points[rng.integers(len(points)), rng.integers(points.shape[1])] += rng.choice([-size, size, 1e-3, -1e-3])
    elif kind == "answer":
        packed[rng.integers(len(packed))] = rng.integers(216)
    elif kind == "step":
        number = int(lines[counts["answers"]].split(" ")[1])
        digits = [byte // step % 6 for byte in packed for step in (1, 6, 36)][:number]
        del digits[rng.integers(number)]
        digits += [0] * (-len(digits) % 3)
        packed = bytearray((np.reshape(digits, (-1, 3)) @ [1, 6, 36]).tolist())
        lines[counts["answers"]] = f"answers {number - 1}"
    elif kind == "turned":
        directions[rng.integers(len(directions))] += rng.normal(0, size, 3)
    elif kind == "dropped":
        directions = np.delete(directions, rng.integers(len(directions)), axis=0)
        lines[counts["directions"]] = f"directions {len(directions)}"
    elif kind == "joint":
        names = [i for i, line in enumerate(lines) if line.startswith("joint ")]
        first, second = rng.choice(names, 2, replace=False)
        lines[first], lines[second] = lines[second], lines[first] + ("_" if rng.random() < 0.3 else "")
    elif kind == "kept":
        link = rng.choice(["fore", "upper", "forearm_link", "none"])
        lines.insert(3, f"clearance {size:.9f}" if rng.random() < 0.5 else f"padding {size:.9f} {link}")
    elif kind == "held":
        lines.insert(3, f"held {size:.9f} {rng.choice(['ee_fixed_joint', 'elbow_joint', 'bend', 'none'])}")
    elif kind == "claim":
        words = lines[limits[rng.integers(len(limits))]].split(" ")
        row, place = lines.index(" ".join(words)), int(rng.integers(1, max(2, len(words) - 1)))
        words[place] = repr(float(words[place]) + float(rng.choice([-size, size])))
        lines[row] = " ".join(words)
    carried = data[len(joined(*parts_of(data))) :]
    return kind, joined(lines, points, packed, directions) + carried


def _forged_no_path(data: bytes, rng: np.random.Generator) -> tuple[str, bytes]:
    parts, size = NoPathParts.of(data), 10.0 ** rng.uniform(-6, 0)
    ends, balls, witnesses = parts.ends.copy(), parts.balls.copy(), parts.witnesses.copy()
    answers = [each.copy() for each in parts.answers]
    kind = str(rng.choice(["end", "end", "ball", "radius", "body", "witness", "answer", "opened", "line"]))
    row, tree = rng.integers(len(balls)), rng.integers(len(answers))
    if kind == "end":
        ends[rng.integers(len(ends)), rng.integers(ends.shape[1])] += rng.choice(
            [-size, size, 1e-3, rng.uniform(-3, 3)]
        )
    elif kind == "ball":
        balls["ball"][row, :3] += rng.normal(0, size, 3)
    elif kind == "radius":
        balls["ball"][row, 3] *= 1.0 + rng.choice([-size, size])
    elif kind == "body":
        balls["body"][row] = rng.integers(8)
    elif kind == "witness":
        witnesses[rng.integers(len(witnesses)), rng.integers(2)] = rng.integers(10)
    elif kind == "answer":
        answers[tree][rng.integers(len(answers[tree]))] = rng.integers(6)
    elif kind == "opened":
        answers[tree][rng.choice(np.flatnonzero(answers[tree]))] = 0
    lines = list(parts.lines)
    if kind == "line":
        numbers = [i for i, line in enumerate(lines) if line.split(" ")[0] in ("position", "pose")]
        if numbers:
            words = lines[numbers[0]].split(" ")
            place = int(rng.integers(1, len(words) - 1))
            words[place] = repr(float(words[place]) + float(rng.choice([-size, size])))
            lines[numbers[0]] = " ".join(words)
        else:
            lines.insert(3, f"clearance {size:.9f}" if rng.random() < 0.5 else f"padding {size:.9f} fore")
    new = replace(parts, lines=tuple(lines), ends=ends, balls=balls, witnesses=witnesses, answers=tuple(answers))
    return kind, new.data


def print_flips(made: list[Case], count: int, rng: np.random.Generator) -> None:
    """Flip bytes of certificates of all kinds, and print what became of them."""
    said, slowest = Counter[str](), 0.0
    with ManyChecks() as in_c:
        for case, data in _shares(made, count):
            inputs = inputs_or_none(case, case.data, case.sources)
            for i in range(data):
                other = bytearray(case.data[: rng.integers(len(case.data))] if i % 50 == 0 else case.data)
                for place in rng.integers(len(other), size=rng.integers(1, 5)) if other else ():
                    other[place] = rng.integers(256)
                if i == 0:
                    assert in_c.read(case.sources.robot, case.sources.scene, case.sources.srdf) == ACCEPTED
                began = time.perf_counter()
                accepted = in_c.code(other) == ACCEPTED
                slowest = max(slowest, time.perf_counter() - began)
                said["files"] += 1
                said["accepted"] += accepted
                if i % (10 if accepted else 100) == 0:
                    said["seen by both"] += 1
                    said["disagree"] += python_accepts(case, bytes(other), inputs) != accepted
            print(case.name, dict(said), flush=True)
    print(f"flipped bytes: {dict(said)}, slowest {1e3 * slowest:.0f} ms")


def _shares(made: list[Case], count: int) -> Iterator[tuple[Case, int]]:
    """Yield cases, and how many files of each: fewer of those of shipped robots."""
    small = [case for case in made if _is_own(case)]
    for case in made:
        yield case, count * 19 // (20 * len(small)) if case in small else count // (20 * (len(made) - len(small)))


def python_accepts(case: Case, data: bytes, inputs: Inputs | None) -> bool:
    """Return whether the checker in Python accepts a file, whatever its first line says now."""
    try:
        about = case.inputs(data) if case.carries else inputs
    except (Refused, BadInput):
        return False
    return about is not None and (accepts_no_path if case.of_no_path else accepts)(data, about)


if __name__ == "__main__":
    main()
