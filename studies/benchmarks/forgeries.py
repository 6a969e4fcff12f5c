"""Forged and broken certificates, which both checkers must judge alike, and none of which may hide a contact.

    python -m studies.benchmarks.forgeries --count 100000            # forgeries: files changed, digests remade or not
    python -m studies.benchmarks.forgeries --count 0 --flips 1000000 # flipped bytes: no crash, no hang

A forgery changes a certificate (a waypoint, an answer, a direction, a joint's name, what is kept) or its scene (an
obstacle grown or moved, a contact no longer allowed, narrower limits, another scene).  Both checkers must
agree on each.  Without a new digest, a changed scene must be refused.  Of those that are accepted, one in twenty is
sampled by the oracle of the tests: none may touch by more than 2 um.  Flipped bytes go to the checker in C, compiled
with sanitizers; the one in Python sees every hundredth, and a tenth of those that are accepted.
"""

from __future__ import annotations

import argparse
import itertools
import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from tests.certificates.checker_in_c import ManyChecks
from tests.certificates.small import certificate_in, inputs_of
from tests.certificates.written import Written, accepts, box_reach, joined, parts_of, shelf, with_digest
from tests.robots.oracle import clearance

CONTACT = 2e-6
WALL = """obstacles:
  wall: {shape: box, size: [0.2, 0.2, 0.2], xyz: [1.25, 0.0, 0.0]}
  post: {shape: cylinder, radius: 0.05, length: 1, xyz: [0.8, 0.4, 0]}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=2000, help="number of forgeries")
    parser.add_argument("--flips", type=int, default=20_000, help="number of files with flipped bytes")
    options = parser.parse_args()
    began = time.process_time()
    if options.count:
        print_forgeries(options.count)
    if options.flips:
        print_flips(options.flips)
    print(f"{time.process_time() - began:.0f} s of processor time")


def print_forgeries(count: int) -> None:
    """Forge both shipped plans, and print what the checkers said."""
    said: Counter[str] = Counter()
    rng = np.random.default_rng(53)
    with ManyChecks() as in_c, tempfile.TemporaryDirectory() as folder:
        for written, other in ((box_reach(), shelf()), (shelf(), box_reach())):
            for scene, number in scenes_of(written, rng, Path(folder), count // 2):
                inputs = written.inputs(scene=scene)
                assert in_c.read(written.sources.robot, scene or written.sources.scene, written.sources.srdf) == 0
                for _ in range(number):
                    kind, data, waypoints = forged(written, other, rng)
                    is_new = rng.random() < 0.8
                    data = with_digest(data, inputs) if is_new else data
                    accepted = accepts(data, inputs)
                    said["disagree"] += in_c.accepts(data) != accepted
                    said["forgeries"] += 1
                    said["accepted"] += accepted
                    said[f"accepted, {kind}"] += accepted
                    said["accepted, scene changed without a new digest"] += bool(accepted and scene and not is_new)
                    if accepted and said["accepted"] % 20 == 0 and scene is None:
                        said["judged"] += 1
                        said["touches"] += touches(written, waypoints)
    for key, number in sorted(said.items()):
        print(f"{key}: {number}")


def scenes_of(
    written: Written, rng: np.random.Generator, folder: Path, count: int
) -> Iterator[tuple[Path | None, int]]:
    """Yield changed scenes, None for the plan's own, and how many forgeries are made in each."""
    text, made = written.sources.scene.read_text(), 0
    while made < count:
        number = min(50, count - made)
        made += number
        if rng.random() < 0.5:
            yield None, number
            continue
        changed, size = folder / f"{made}.yaml", 10.0 ** rng.uniform(-6, -1)
        numbers = list(re.finditer(r"-?\d+\.\d+", text.split("states:")[0]))
        at = numbers[rng.integers(len(numbers))]
        new = text[: at.start()] + f"{float(at.group()) + size:.9f}" + text[at.end() :]
        if rng.random() < 0.2:
            new = new.replace(", shoulder_link]", "]")
        if rng.random() < 0.2:
            new = new.replace("elbow_joint: [-3.14", "elbow_joint: [-1.14")
        changed.write_text(new)
        yield changed, number


def forged(written: Written, other: Written, rng: np.random.Generator) -> tuple[str, bytes, Any]:
    """Return a kind of forgery, the file, and its waypoints."""
    lines, waypoints, packed, directions = parts_of(written.data)
    row, size = rng.integers(len(waypoints)), 10.0 ** rng.uniform(-6, 0)
    kind = str(rng.choice(["waypoint", "answer", "turned", "dropped", "joint", "kept", "held", "another", "none"]))
    if kind == "waypoint":
        waypoints[row, rng.integers(waypoints.shape[1])] += rng.choice([-size, size, 1e-3])
    elif kind == "answer":
        packed[rng.integers(len(packed))] = rng.integers(216)
    elif kind == "turned":
        directions[rng.integers(len(directions))] += rng.normal(0, size, 3)
    elif kind == "dropped":
        directions = np.delete(directions, rng.integers(len(directions)), axis=0)
        lines = [f"directions {len(directions)}" if line.startswith("directions") else line for line in lines]
    elif kind == "joint":
        names = [i for i, line in enumerate(lines) if line.startswith("joint ")]
        first, second = rng.choice(names, 2, replace=False)
        lines[first], lines[second] = lines[second], lines[first] + ("_" if rng.random() < 0.3 else "")
    elif kind == "kept":
        lines.insert(3, f"clearance {size:.9f}" if rng.random() < 0.5 else f"padding {size:.9f} forearm_link")
    elif kind == "held":
        lines.insert(3, f"held {size:.9f} {rng.choice(['ee_fixed_joint', 'elbow_joint', 'none'])}")
    elif kind == "another":
        other_lines, _, packed, directions = parts_of(other.data)
        counts = {line.split()[0]: line for line in other_lines}
        lines = [counts[key] if (key := line.split()[0]) in ("answers", "directions") else line for line in lines]
    return kind, joined(lines, waypoints, packed, directions), waypoints


def touches(written: Written, waypoints: Any, states: int = 30) -> bool:
    """Return whether the oracle sees a contact at a state of a path."""
    share = np.linspace(0.0, 1.0, states)[:, np.newaxis]
    q = np.concatenate([a + share * (b - a) for a, b in itertools.pairwise(waypoints)])
    return bool(clearance(written.world.robot, written.world.scene, q, samples=25).min() < -CONTACT)


def print_flips(count: int) -> None:
    """Flip bytes of three certificates, and print what became of them."""
    rng, said, slowest = np.random.default_rng(7), Counter[str](), 0.0
    with ManyChecks() as in_c, tempfile.TemporaryDirectory() as folder:
        sources, data = certificate_in(Path(folder), WALL, [[-0.4], [0.0], [0.1]])
        small = data, inputs_of(sources), (sources.robot, sources.scene, None)
        plans = [small] + [
            (each.data, each.inputs(), (each.sources.robot, each.sources.scene, each.sources.srdf))
            for each in (box_reach(), shelf())
        ]
        for (data, inputs, files), number in zip(
            plans, (count - 2 * (count // 4), count // 4, count // 4), strict=True
        ):
            assert in_c.read(*files) == 0
            for i in range(number):
                other = bytearray(data[: rng.integers(len(data))] if i % 50 == 0 else data)
                for place in rng.integers(len(other), size=rng.integers(1, 5)) if other else ():
                    other[place] = rng.integers(256)
                began = time.perf_counter()
                accepted = in_c.accepts(other)
                slowest = max(slowest, time.perf_counter() - began)
                said["files"] += 1
                said["accepted"] += accepted
                if i % (10 if accepted else 100) == 0:
                    said["seen by both"] += 1
                    said["disagree"] += accepts(bytes(other), inputs) != accepted
    print(f"flipped bytes: {dict(said)}, slowest {1e3 * slowest:.0f} ms")


if __name__ == "__main__":
    main()
