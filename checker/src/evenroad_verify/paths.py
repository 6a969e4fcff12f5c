"""The table of a path or a trajectory, which must be what a certificate is about."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from evenroad_verify.certificate import Certificate
from evenroad_verify.errors import BadInput, Floats, demand, require

_UNIT, _TIME = " [rad or m]", "time [s]"
_ABOVE = 1e-6
"""By how much a limit may be exceeded [rad or m, and s], and which share of a step two may differ by."""
_ROWS = re.compile(r"[-+.,eE0-9 \t\r\n]*")
"""What the lines below the first one of a table consist of."""
_FINE = 64
"""Parts into which a curve is divided to find what is near it."""


def require_same_path(certificate: Certificate, path: Path) -> None:
    """Raise Refused unless the rows of a CSV are the certificate's waypoints or, of curves, near these in their order.

    Of curves the straight ways between rows are near, too.  Columns of joints that stand still must say where.
    """
    names, table = _read_table(path)
    demand(not certificate.limits or names.count(_TIME) == 1, f"{path} has no times, or two columns of them")
    places = [name.removesuffix(_UNIT) if "/s" not in name and name != _TIME else "" for name in names]
    once = all(places.count(name) == 1 for name in certificate.joints)
    demand(once, f"{path} has other joints than the certificate, or one of them twice")
    for i, name in enumerate(places):
        if name and name not in certificate.joints:
            still = np.abs(table[:, i] - certificate.held.get(name, 0.0)) <= 1e-9
            demand(still.all(), f"{path} has {name} elsewhere than the certificate")
    rows, strays = table[:, [places.index(name) for name in certificate.joints]], 0.0
    if certificate.limits:
        _require_slow(certificate, rows, table[:, names.index(_TIME)])
        # The spline of which limits hold is so far from the straight ways between rows, at most.
        strays = float(np.linalg.norm(np.diff(rows, 2, axis=0), axis=1).max(initial=0.0)) / 8.0
    if certificate.tolerance:
        demand(len(rows) and _are_near(certificate, rows, strays), f"{path} leaves the curves of the certificate")
        return
    demand(not certificate.limits, "it has no tolerance: limits hold of a spline near the waypoints")
    first, middle, last = np.moveaxis(certificate.curves, 1, 0)
    is_straight = np.abs(middle - 0.5 * (first + last)).max() < 1e-12
    demand(is_straight, "it proves curves, which no table of waypoints gives")
    points = np.concatenate([certificate.curves[:, 0], certificate.curves[-1:, 2]])
    demand(rows.shape == points.shape and (rows == points).all(), f"{path} has other waypoints than the certificate")


def _read_table(path: Path) -> tuple[list[str], Floats]:
    """Return the names of columns and the rows of a CSV, (n, columns); BadInput for what is none."""
    first, _, rest = path.read_bytes().decode("utf-8", "replace").replace("\r", "\n").lstrip("\n").partition("\n")
    names, lines = first.split(","), [line.split(",") for line in rest.split("\n") if line]
    is_table = first and "\0" not in first and all(len(line) == len(names) for line in lines)
    require(is_table and _ROWS.fullmatch(rest), f"{path} is no table")
    try:
        table = np.array(lines, float).reshape(-1, len(names))
    except ValueError as error:
        raise BadInput(f"{path}: {error}") from None
    require((np.abs(table) < 1e9).all(), f"{path} has a number that is too large")
    return names, table


def _require_slow(certificate: Certificate, rows: Floats, times: Floats) -> None:
    """Raise Refused unless all limits hold of the spline of degree 2 in time whose control points are the rows.

    Its control points are equal steps apart, and the first and the last one come twice: it begins and ends at rest.
    """
    steps = np.diff(times)
    equal = len(steps) > 0 and steps.min() > 0.0 and steps.max() <= (1.0 + _ABOVE) * steps.min()
    demand(equal, "times do not rise by equal steps")
    velocity = np.diff(np.concatenate([rows[:1], rows, rows[-1:]]), axis=0) / steps.min()
    acceleration = np.diff(velocity, axis=0) / steps.min()
    for name, fast, hard in certificate.limits:
        column = certificate.joints.index(name)
        keeps = (np.abs(velocity[:, column]) <= fast + _ABOVE).all()
        keeps &= (np.abs(acceleration[:, column]) <= hard + _ABOVE).all()
        demand(keeps, f"{name} exceeds its limit of velocity or acceleration")


def _are_near(certificate: Certificate, rows: Floats, strays: float) -> bool:
    """Return whether all that strays so far from straight ways between rows follows the curves in their tolerance."""
    t = (np.arange(_FINE) / _FINE)[:, None]
    first, middle, last = np.moveaxis(certificate.curves, 1, 0)[:, :, None]
    places = ((1 - t) ** 2 * first + 2 * t * (1 - t) * middle + t**2 * last).reshape(-1, rows.shape[1])
    places = np.concatenate([places, certificate.curves[-1:, 2]])
    # Between two places a curve is as far from its chord as its second derivative allows.
    bend = np.linalg.norm(2 * (last - 2 * middle + first), axis=-1).max()
    near, at = certificate.tolerance - bend / _FINE**2 / 8.0 - strays, 0
    for i in range(len(rows)):
        before = at
        while at + 2 < len(places) and _distance(rows[i], places[at + 1 : at + 3]) < _distance(
            rows[i], places[at : at + 2]
        ):
            at += 1
        if not _distance(rows[i], places[at : at + 2]) <= near:
            return False
        way = rows[max(0, i - 1) : i + 1]
        if any(not _distance(place, way) <= near for place in places[before + 1 : at + 1]):
            return False
    return bool(np.linalg.norm(rows[-1] - places[-1]) <= near)


def _distance(point: Floats, ends: Floats) -> float:
    """Return the distance of a point from a segment."""
    way, apart = ends[-1] - ends[0], point - ends[0]
    share = np.clip(apart @ way / max(float(way @ way), 1e-300), 0.0, 1.0)
    return float(np.linalg.norm(apart - share * way))
