"""``evenroad certify``: what a point set with a connection rule guarantees in every world."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from evenroad._checks import as_row, require_count, require_positive
from evenroad._files import Json
from evenroad._terminal import print_table
from evenroad.cli.options import Positional
from evenroad.cli.sampler import chosen_rule
from evenroad.errors import InvalidValue, shown
from evenroad.points.npz import load_points
from evenroad.roadmap import Certificate, default_rule
from evenroad.roadmap.certify import certify
from evenroad.space import BoxSpace

FACTORS = (3.0, 2.0, 1.5, 1.2)
"""Factors on the best path's length for which the necessary clearance is printed."""


@dataclass(frozen=True, kw_only=True)
class Certify:
    """Print what a roadmap of these points (PRM, in a box) guarantees, whatever the obstacles.

    It says from which clearance on a path is found if one exists, and how much longer than the best one that path is at
    most.  A path has clearance C if all points nearer to it than C are free.  Exit code 1 if nothing is guaranteed for
    the given clearance.

    Example: evenroad certify set.npy -k 511
    """

    set: Positional[Path]
    """A .npy array of shape (n, d), or a .npz point set."""
    k: Annotated[int | None, "-k"] = None
    """Each milestone is joined to its k nearest, in both directions (default 10; 20 from six coordinates on)."""
    connect_radius: float | None = None
    """Milestones are joined up to this distance instead."""
    sides: str | None = None
    """Lengths of the box's sides, d numbers with commas between them.  Default: 1 each."""
    goals: int = 1
    """Largest number of goals that a plan is given."""
    clearance: float | None = None
    """Say what is guaranteed where the best path has this clearance, > 0, in units of the box."""
    length: float | None = None
    """Length of that best path, > 0."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Certify and print; return 0 if something is guaranteed, else 1."""
        for name in ("clearance", "length"):
            if getattr(self, name) is not None:
                require_positive(f"--{name}", getattr(self, name))
        require_count("--goals", self.goals)
        if self.length is not None and self.clearance is None:
            raise InvalidValue("--length goes with --clearance")
        points, file = load_points(self.set), self.set
        sides = (1.0,) * points.d if self.sides is None else _sides(self.sides, points.d)
        space = BoxSpace([0.0] * points.d, sides)
        rule = chosen_rule(self.k, self.connect_radius) or default_rule(space)
        certificate = certify(points, rule, space, goals=self.goals)
        record = {"file": str(file), "n": points.n, "d": points.d, "hash": points.hash, "rule": str(rule)}
        title = f"{file}: n={points.n}, d={points.d}, {points.origin}, {rule}"
        return self._show(title, record | {"sides": list(sides)}, certificate)

    def _show(self, title: str, record: dict[str, object], certificate: Certificate) -> int:
        record |= guarantees(certificate)
        rows = guarantee_rows(certificate)
        held = certificate.complete
        if self.clearance is not None:
            factor = certificate.factor(self.clearance)
            held = held and self.clearance >= certificate.dispersion
            record |= {"clearance": self.clearance, "guaranteed": held, "factor": _finite(factor)}
            text = f"at most {factor:.6g} times the best one" if math.isfinite(factor) else "no bound on its length"
            text = f"a path is found, {text}" if held else "nothing is guaranteed"
            if self.length is not None:
                longest = certificate.longest(self.length, self.clearance)
                record |= {"length": self.length, "longest": _finite(longest)}
                text += f"; at most {longest:.6g} long where the best is {self.length:g}" if held else ""
            rows.append((f"with {self.clearance:g}", text))
        if self.json:
            print(json.dumps(record, indent=2, allow_nan=False))
        else:
            print_table(rows, (), title)
        return 0 if held else 1


def guarantees(certificate: Certificate) -> dict[str, Json]:
    """Return a certificate as plain JSON values."""
    least = certificate.dispersion if certificate.complete else math.inf
    clearances = {factor: certificate.clearance_for(factor) for factor in FACTORS}
    return {
        "dispersion": certificate.dispersion,
        "dispersion_at_least": certificate.at_least,
        "between": _finite(certificate.between),
        "ends": _finite(certificate.to_terminals),
        "complete": certificate.complete,
        "complete_from_clearance": _finite(least),
        "clearance_for_factor": {f"{factor:g}": _finite(value) for factor, value in clearances.items()},
    }


def guarantee_rows(certificate: Certificate) -> list[tuple[str, str]]:
    """Return a certificate as rows of a table."""
    said = guarantees(certificate)
    needed = f"all motions up to {2 * certificate.dispersion:.6g} have to be tried"
    enough = math.ceil(1e4 * 2.0 * certificate.dispersion + 1e-3) / 1e4
    path = f"nothing is guaranteed: {needed}; --connect-radius {enough:g} does, or more points need less"
    if (least := said["complete_from_clearance"]) is not None:
        path = f"if one of clearance {least:.6g} does; if none is found, none does"
    between, to_terminals = (
        f"up to {most:.6g}" if math.isfinite(most) else "of any length"
        for most in (certificate.between, certificate.to_terminals)
    )
    tried = f"all free ones {between}, from start and goal {to_terminals}"
    return [
        ("largest hole", f"{certificate.dispersion:.6g} at most, {certificate.at_least:.6g} at least"),
        ("motions tried", tried),
        ("a path exists", path),
        *(
            (f"{factor} x the best", f"at most, of those with clearance {clearance:.6g}")
            for factor, clearance in said["clearance_for_factor"].items()
            if clearance is not None
        ),
    ]


def _sides(text: str, d: int) -> tuple[float, ...]:
    try:
        sides = as_row("--sides", [float(word) for word in text.split(",")], d)
    except ValueError:
        sides = ()
    if not sides or min(sides) <= 0.0:
        raise InvalidValue(f"--sides must be {d} numbers > 0 with commas between them, got {shown(text)}")
    return sides


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
