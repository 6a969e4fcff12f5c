"""The command ``evenroad-verify``."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad_verify.certificate import Certificate, read_certificate
from evenroad_verify.claim import Claim, Inputs, claim_of, read_inputs
from evenroad_verify.errors import BadInput, Floats, Refused, demand, numbers
from evenroad_verify.no_path import MAGIC as OF_NO_PATH
from evenroad_verify.no_path import Shown, read_no_path, verify_no_path
from evenroad_verify.pairs import MAGIC as OF_PAIRS
from evenroad_verify.pairs import read_pairs, verify_pairs
from evenroad_verify.paths import require_same_path
from evenroad_verify.proof import prove
from evenroad_verify.solids import require_outside

ACCEPTED, REFUSED, BAD_INPUT = 0, 1, 2
_SAME = 1e-9
"""How near a start or goal is to one that counts as the same [rad or m]."""


@dataclass(frozen=True)
class Proved:
    """An accepted certificate, what it claims, and the least gap of its answers beyond what is kept [m]."""

    certificate: Certificate
    claim: Claim
    least: float
    opened: int


def verify(certificate: bytes, inputs: Inputs) -> Proved:
    """Return what a certificate proves about a robot in a scene; Refused, with the reason, if it does not."""
    read = read_certificate(certificate)
    demand(read.inputs == inputs.digest, "robot, SRDF, scene or meshes are not the files that it was written for")
    with np.errstate(all="ignore"):
        claim = claim_of(inputs, read)
        least, tasks = prove(claim, read)
        return Proved(read, claim, least, require_outside(claim, read, tasks))


def verify_all(certificate: bytes, inputs: Inputs) -> list[str]:
    """Return what is printed of a certificate that is accepted; Refused, with the reason, if it is not."""
    if certificate.startswith(OF_NO_PATH):
        return _lines_of_no_path(verify_no_path(certificate, inputs))
    if certificate.startswith(OF_PAIRS):
        return _lines_of_pairs(Proved(*verify_pairs(certificate, inputs)))
    return _lines(verify(certificate, inputs))


def main(words: Sequence[str] | None = None) -> int:
    """Check a certificate; return 0 if it is accepted, 1 if it is refused, 2 if an input cannot be read."""
    parser = argparse.ArgumentParser(prog="evenroad-verify", description="Check a proof about the paths of a robot.")
    parser.add_argument("certificate", type=Path, help="the certificate")
    own = "; - or none: the one that the certificate carries"
    parser.add_argument("robot", type=_file, nargs="?", help=f"the robot's URDF{own}")
    parser.add_argument("scene", type=_file, nargs="?", help=f"the scene, a YAML of evenroad{own}")
    parser.add_argument("srdf", type=_file, nargs="?", help="the robot's SRDF, if the certificate was written with one")
    parser.add_argument("--write", type=Path, metavar="FOLDER", help="write the files that the certificate carries")
    parser.add_argument("--package", action="append", default=[], help="NAME=FOLDER of a ROS package with meshes")
    parser.add_argument("--path", type=Path, help="a CSV of waypoints, or of a trajectory, that must be what is proved")
    ends = "values of the joints, in the order in which they are printed:"
    parser.add_argument("--start", help=f"{ends} where all that is proved must begin")
    parser.add_argument("--goal", help=f"{ends} where the path must end, or one of the goals")
    asked = parser.parse_args(words)
    packages = {name: Path(folder) for name, _, folder in (each.partition("=") for each in asked.package)}
    try:
        data = asked.certificate.read_bytes()
        is_of_path = not data.startswith((OF_NO_PATH, OF_PAIRS))
        if data.startswith(OF_NO_PATH):
            of_none = read_no_path(data)
            carrier, goals = of_none.terminals, of_none.terminals.curves[: of_none.goals, 2]
        else:
            carrier = read_certificate(data) if is_of_path else read_pairs(data)
            goals = carrier.curves[-1:, 2]
        inputs = read_inputs(asked.robot, asked.scene, asked.srdf, packages, carrier)
        lines = verify_all(data, inputs)
        if asked.path is not None:
            demand(is_of_path, "it is about no path")
            require_same_path(carrier, asked.path)
            lines[1:1] = [
                f"  {name}: at most {fast:.6g} per second and {hard:.6g} per second^2, from rest to rest"
                for name, fast, hard in carrier.limits
            ]
        if carrier.limits and asked.path is None:
            lines.append("  limits of velocity and acceleration: the table that has the times is not given")
        _require_end("start", asked.start, carrier.curves[:1, 0])
        _require_end("goal", asked.goal, goals)
        if asked.write is not None:
            _write(asked.write, inputs.carried)
    except Refused as error:
        _print([f"REFUSED: {error}"])
        return REFUSED
    except (BadInput, OSError, RecursionError) as error:
        print(f"evenroad-verify: {error}", file=sys.stderr)
        return BAD_INPUT
    _print(lines)
    return ACCEPTED


def _print(lines: list[str]) -> None:
    """Print lines, as many as somebody reads: `head` closes the output early, and the exit code stays the answer."""
    try:
        print("\n".join(lines), flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at the end of Python


def _file(word: str) -> Path | None:
    return None if word == "-" else Path(word)


def _require_end(name: str, said: str | None, known: Floats) -> None:
    """Raise Refused unless a start or goal, if it is given, is one of those of a certificate, (n, joints)."""
    if said is not None:
        same = (np.abs(known - numbers(said, known.shape[1])) <= _SAME).all(axis=1).any()
        demand(same, f"it is about another {name}")


def _write(folder: Path, carried: Sequence[tuple[str, bytes]]) -> None:
    """Write files that a certificate carries; other files of the same name have a number before it."""
    folder.mkdir(parents=True, exist_ok=True)
    written: dict[str, bytes] = {}
    for name, content in carried:
        own, count = name, 1
        while written.setdefault(own, content) != content:
            count += 1
            own = f"{count}-{name}"
        (folder / f"{own}.part").write_bytes(content)
        (folder / f"{own}.part").replace(folder / own)


def _lines_of_no_path(shown: Shown) -> list[str]:
    """Return what is printed of an accepted certificate of no path."""
    terminals = shown.certificate.terminals
    read = shown.certificate
    lines = [f"PROVED: no path leads from the start to any goal: each one touches something{_kept(terminals)}"]
    lines += [f"  goals: {read.goals} configurations"] if read.goals else []
    for each in read.poses:
        turned = "" if each.xyzw is None else f", turned by the quaternion {_row(each.xyzw)} within {each.tilt:g} rad"
        near = f"{each.link} within {each.near:g} m of {_row(each.point)}"
        lines.append(f"  goal: {near}{turned}, however the joints reach it")
    for name, start, goals in zip(terminals.joints, terminals.start, terminals.curves[: read.goals, 2].T, strict=True):
        to = " to " + " or ".join(f"{value:.6g}" for value in goals) if read.goals else ""
        lines.append(f"  {name}: from {start:.6g}{to}")
    lines.append(f"  whatever other joints than these do: {', '.join(shown.joints)}")
    lines.append(f"  {shown.blocked} cells are blocked; smallest overlap of a cell: {shown.least:.3g} m")
    lines.append(f"pairs that block the way ({len(shown.pairs)}):")
    lines += [f"  {first} - {second}" for first, second in shown.pairs]
    return [*lines, "not claimed:", *(f"  {line}" for line in shown.silent)]


def _kept(read: Certificate) -> str:
    """Return what is said of clearance and padding."""
    kept = f", {read.clearance:g} m from all obstacles" if read.clearance else ""
    return kept + "".join(f", {link} {metres:g} m more" for link, metres in read.padding.items())


def _row(values: Floats) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"


def _lines(proved: Proved) -> list[str]:
    """Return what is printed of an accepted certificate."""
    read = proved.certificate
    straight = np.abs(read.curves[:, 1] - 0.5 * (read.curves[:, 0] + read.curves[:, 2])).max() < 1e-12
    kind = "straight motions" if straight else "curves"
    lines = [f"PROVED: {len(read.curves)} {kind} touch nothing{_kept(read)}"]
    for name, first, last in zip(read.joints, read.curves[0, 0], read.curves[-1, 2], strict=True):
        lines.append(f"  {name}: from {first:.6g} to {last:.6g}")
    lines.append(f"  smallest gap of a step of the proof: {proved.least:.3g} m")
    for kept in read.kept:
        box = f"the box {_row(kept.low)} to {_row(kept.high)}, turned by the quaternion {_row(kept.xyzw)}"
        within = f"{kept.within:g} rad of {_row(kept.low)}" if kept.is_axis else f"{kept.within:g} m of {box}"
        lines.append(f"  the {'axis' if kept.is_axis else 'point'} {_row(kept.part)} of {kept.link} is within {within}")
    if read.tolerance:
        lines.append(f"  joints may be {read.tolerance:g} off the curves, by the root of the sum of squares")
    return lines + _lines_of_claim(proved)


def _lines_of_pairs(proved: Proved) -> list[str]:
    """Return what is printed of an accepted certificate of pairs."""
    lines = ["PROVED: pairs of links never touch, whatever the joints do"]
    for name, low, high in zip(proved.certificate.joints, *proved.certificate.curves[0, [0, 2]], strict=True):
        lines.append(f"  {name}: from {low:.6g} to {high:.6g}")
    lines.append(f"  smallest gap of a step of the proof: {proved.least:.3g} m")
    return lines + _lines_of_claim(proved)


def _lines_of_claim(proved: Proved) -> list[str]:
    pairs, silent = proved.claim.pairs, proved.claim.silent
    lines = [f"pairs proved apart ({len(pairs)}):"]
    lines += [f"  {first} - {second}" for first, second in (pair.names for pair in pairs)]
    lines.append("not claimed:")
    lines += [f"  {line}" for line in silent]
    if proved.opened:
        lines.append(f"  what is inside of surfaces with holes: {proved.opened}")
    return lines
