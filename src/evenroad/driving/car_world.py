"""CarWorld: a robot with a footprint on a map, with exact checks of poses and of whole motions."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad._native.drive import Vehicle
from evenroad.driving.among_polygons import looser_world, vehicle_among
from evenroad.driving.car_space import CarSpace
from evenroad.driving.footprint import Footprint
from evenroad.driving.polygon_map import PolygonMap
from evenroad.errors import InvalidValue
from evenroad.space import Circle, Product
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.world.gridmap.disk_world import DiskWorld
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.one_or_many import OneOrMany, one_or_many
from evenroad.world.protocol import Apart

LARGEST_ANGLE = 4.0 * math.pi
"""Largest angle of a start or goal [rad]: a larger one is probably in degrees."""
SLICES = 144
"""Number of slices of the angle in a proof that there is no path."""
_MOST_BOXES = 1_000_000
"""Largest number of boxes that such a proof goes to: some tenths of a second."""
_MOST_DRIVEN = 30_000_000
"""The same from start and from goal, of a car that does not reverse: about a second."""
_THIRD = 1.0 / 3.0
"""Share of a footprint at either end in which a contact is at a corner or a side."""


_LEAST_DEPTH = 1e-12
"""Smallest overlap that is reported, in map units."""


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class CarWorld(OneOrMany):
    """A footprint on one map: what `GridMap.world` returns with `footprint`, and `PolygonMap.world`.

    Obstacles are the closed squares of the occupied cells and everything outside of the map; the footprint is open, so
    touching is free.  With `polygons` these are the obstacles, and the cells those that they touch.

    A pose is (x, y, angle), an angle of 0 pointing along x.  A motion is the shortest curve of the space: of Reeds and
    Shepp, or of Dubins without `reverse`; with a `turning_radius` of 0 the robot turns on the spot.  All that the
    footprint sweeps is tested, without any step length.  With `holonomic` a robot moves straight in
    any direction while it turns evenly.

    InvalidValue for a footprint or a radius that is larger than the map, and for numbers that are none.
    """

    grid: GridMap
    footprint: Footprint
    turning_radius: float = 0.0
    reverse: bool = True
    holonomic: bool = False
    clearance: float = 0.0
    polygons: PolygonMap | None = None
    space: CarSpace | Product = field(init=False, repr=False)
    vehicle: Vehicle = field(init=False, repr=False)

    def __post_init__(self) -> None:
        low, high = self.grid.bounds
        longest = math.hypot(*(high - low))
        hint = "" if self.polygons is None else "; bounds= of the PolygonMap say how far it reaches around its polygons"
        radius = require_positive("turning_radius", self.turning_radius, or_zero=True)
        clearance = require_positive("clearance", self.clearance, or_zero=True)
        if radius > longest:
            raise InvalidValue(
                f"turning_radius must be at most the diagonal of the map, {longest:.6g}, got {radius:.6g}; both are in"
                f" map units{hint}"
            )
        width = 2.0 * self.footprint.inscribed[1]
        if width > min(high - low) and width > min(self.grid.shape) * self.grid.resolution:
            raise InvalidValue(
                f"a footprint must fit on the map: a disk of diameter {width:.6g} lies in it, and the map is"
                f" {self.grid.shape[1] * self.grid.resolution:.6g} by {self.grid.shape[0] * self.grid.resolution:.6g}"
                f"{hint}"
            )
        if self.holonomic and (radius > 0.0 or not self.reverse):
            raise InvalidValue("a holonomic robot moves in every direction: turning_radius and reverse are of a car")
        space = (
            Product((self.grid.space, Circle()), (1.0, self.footprint.reach), combine="l2")
            if self.holonomic
            else CarSpace(self.grid.space, radius, self.reverse, self.footprint.reach)
        )
        set_fields(self, turning_radius=radius, clearance=clearance, space=space)
        set_fields(self, vehicle=self._vehicle(self.footprint.grown(clearance)))

    def __reduce__(self) -> tuple[type[CarWorld], tuple[object, ...]]:
        """Return what a copy is made of, here or in another process: it makes its own tables."""
        car = (self.footprint, self.turning_radius, self.reverse, self.holonomic, self.clearance)
        return type(self), (self.grid, *car, self.polygons)

    @property
    def proof(self) -> str:
        """What a check of a motion shows: ``exact``, or ``certified`` where a robot turns while it moves straight.

        Such a motion is never called free if it is not, but may be refused where it is within 1 mm (or a thousandth of
        a cell, if that is more) of an obstacle.
        """
        return "certified" if self.holonomic else "exact"

    @property
    def notes(self) -> tuple[str, ...]:
        """What was read otherwise than the files of the map may mean it."""
        return self.grid.notes

    def __repr__(self) -> str:
        rows, cols = self.grid.shape
        drives = "holonomic" if self.holonomic else f"turning radius {self.turning_radius:g}"
        forwards = "" if self.reverse else ", forwards only"
        return f"CarWorld({self.footprint!r}, {drives}{forwards}, {rows} x {cols} cells)"

    @one_or_many
    def valid(self, q: Floats) -> Bools:
        """Return whether the footprint is free at each pose, (n, 3) -> (n,); of one pose, (3,), a bool."""
        return self.vehicle.poses_free(as_batch("q", q, 3))

    @one_or_many
    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return whether the footprint sweeps no obstacle from each row of `a` to that of `b`: two (m, 3) -> (m,)."""
        first, second = as_batch_pair(a, b, 3)
        if isinstance(self.space, CarSpace):
            return self.vehicle.curves_free(self.space.steering, first, second)
        return self.vehicle.lines_free(first, second)

    def with_cells(self, occupied: Bools) -> CarWorld:
        """Return the world of the same car on a map whose cells have changed.

        Parameters
        ----------
        occupied : array_like of bool
            Of the shape of the map; unknown cells are no longer distinguished.

        Returns
        -------
        CarWorld

        Raises
        ------
        InvalidValue
            If it has another shape, or the obstacles are polygons.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> grid = er.GridMap(np.zeros((20, 30), dtype=bool), resolution=0.1)
        >>> car = grid.world(footprint=[(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)])
        >>> car.with_cells(np.ones((20, 30), dtype=bool)).valid((1, 1, 0))
        False
        """
        if self.polygons is not None:
            raise InvalidValue("polygons have no cells that change: make the world of another PolygonMap")
        return replace(self, grid=self.grid.with_cells(occupied))

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, 3), are free: (p - 1,)."""
        poses = as_batch("path", path, 3)
        return np.asarray(self.motion_valid(poses[:-1], poses[1:]))

    @one_or_many
    def distance(self, q: Floats) -> Floats:
        """Return the distance between the footprint and the nearest obstacle, in map units; 0 where it touches one.

        Parameters
        ----------
        q : array_like, shape (n, 3) or (3,)
            Poses; of one, the distance is a float.

        Returns
        -------
        ndarray, shape (n,)
            Distances of the bare footprint: the clearance of the world is not taken off.
        """
        return self._bare.gaps(as_batch("q", q, 3))

    @cached_property
    def _bare(self) -> Vehicle:
        """The footprint without its clearance."""
        return self.vehicle if self.clearance == 0.0 else self._vehicle(self.footprint)

    def explain(self, q: Floats) -> str:
        """Return, in words, which part of the footprint touches which cell at a pose, (3,), that is not free."""
        pose = as_batch("q", self._row(q)[np.newaxis], 3)[0]
        near = f", or comes nearer than the clearance of {self.clearance:g}" if self.clearance > 0.0 else ""
        corners = np.concatenate([_placed(pose[np.newaxis], each) for each in self._corners])
        if not (inside := self._on_map(corners)).all():
            return f"its {self._side(self._corners[np.argmin(inside)])} reaches beyond the map{near}"
        if self.polygons is not None:
            return self._side_touched(pose, self.polygons.names) + near
        contact = self.vehicle.contact(pose)
        if contact is None:
            return "nothing touches"
        rows, cols = self.grid.shape
        row = rows - 1 - contact.row if self.grid.frame.y_up else contact.row
        row, column = min(max(row, 0), rows - 1), min(max(contact.column, 0), cols - 1)
        cell = self.grid.frame.to_map(np.array([[column + 0.5, row + 0.5]]))[0]
        kind = "unknown cell" if self.grid.unknown[row, column] else "cell"
        by = f"by {max(contact.depth * self.grid.resolution, _LEAST_DEPTH):.3g}"
        side = self._side(self._seen_from(pose, cell))
        return f"its {side} touches the {kind} at ({cell[0]:.6g}, {cell[1]:.6g}) {by}{near}"

    def _on_map(self, points: Floats) -> Bools:
        if self.polygons is None:
            return self.grid.contains(points)
        low, high = self.polygons.bounds
        return np.asarray(((points >= low) & (points <= high)).all(axis=1))

    def _side_touched(self, pose: Floats, names: tuple[str, ...]) -> str:
        """Return in words where the footprint touches a polygon at a pose."""
        contact = self.vehicle.side_contact(pose)
        if contact is None:
            return "nothing touches"
        name = names[contact.polygon] if 0 <= contact.polygon < len(names) else "the border of the map"
        if contact.depth == 0.0:
            return f"it lies inside of {name}"
        side = self._side(self._seen_from(pose, np.array([contact.x, contact.y])))
        return f"its {side} touches {name} at ({contact.x:.6g}, {contact.y:.6g}) by {contact.depth:.3g}"

    def apart(self, start: Floats, goals: Floats, *, quickly: bool = False) -> Apart | None:
        """Return the proof that no path leads from a start, (3,), to any goal, (g, 3); None says nothing.

        The largest disk inside of the footprint comes first: where that cannot get through, the robot cannot.  Then, if
        there is time, the angle is divided into slices, and the map into boxes of a cell and a slice: the robot cannot
        be in those where all poses touch something.  For a car that does not reverse, boxes are instead joined by what
        it can drive to, at its turning radius.
        """
        poses = as_batch("start and goals", np.vstack([start, goals]), 3)
        for centre in self._footprint.inscribed[0]:
            points = _placed(poses, centre)
            if self._inscribed.apart(points[0], points[1:], quickly=quickly) is not None:
                message = (
                    "proved: there is no path; the largest disk inside of the footprint, of radius"
                    f" {self._footprint.inscribed[1]:.3g}, cannot get from start to goal either"
                )
                return Apart(message, proved=True)
        if quickly or not self.valid(poses[:1])[0]:
            return None
        free = poses[1:][self.valid(poses[1:])]
        if isinstance(self.space, CarSpace) and self.turning_radius > 0.0 and not self.reverse:
            steering = self.space.steering
            if not all(self.vehicle.is_unreachable(steering, poses[0], goal, _MOST_DRIVEN) for goal in free):
                return None
            message = (
                "proved: there is no path; forwards alone, and with its turning radius, the car does not get from start"
                " to goal"
            )
            return Apart(message, proved=True)
        if not all(self.vehicle.are_apart(poses[0], goal, SLICES, _MOST_BOXES) for goal in free):
            return None
        message = (
            f"proved: there is no path; in none of {SLICES} slices of the angle, nor from one to the next, does the"
            " footprint get from start to goal, however it moves"
        )
        return Apart(message, proved=True)

    @cached_property
    def _inscribed(self) -> DiskWorld:
        """The largest disk inside of the footprint; among polygons, one that is free wherever that is."""
        radius = self._footprint.inscribed[1]
        return self.grid.world(radius) if self.polygons is None else looser_world(self.polygons, radius)

    @cached_property
    def _footprint(self) -> Footprint:
        """The footprint with its clearance."""
        return self.footprint.grown(self.clearance)

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of map, frame, footprint and car: equal for worlds of equal results."""
        car = (self.turning_radius, self.reverse, self.holonomic, self.clearance)
        digest = hashlib.sha256(f"car {car!r} {self.grid.frame!r} {list(map(len, self.footprint.parts))}".encode())
        for part in (*self.footprint.parts, self.grid.occupied):
            digest.update(part.tobytes())
        if self.polygons is not None:
            digest.update(self.polygons.fingerprint().encode())
        return digest.hexdigest()

    def _vehicle(self, footprint: Footprint) -> Vehicle:
        if self.polygons is not None:
            return vehicle_among(self.polygons, footprint)
        frame, native = self.grid.frame, footprint.native(self.grid.resolution)
        if not frame.y_up:
            return Vehicle(self.grid.occupied, frame.coefficients(), native)
        # Rows along y, so that angles turn in the kernel as they do on the map.
        cosine, sine = math.cos(frame.yaw), math.sin(frame.yaw)
        coefficients = np.array([*frame.origin, cosine, sine, -sine, cosine, frame.resolution, 0.0])
        return Vehicle(np.ascontiguousarray(self.grid.occupied[::-1]), coefficients, native)

    @property
    def _corners(self) -> Floats:
        """The corners of the parts, with the clearance, (n, 2)."""
        return np.vstack(self._footprint.parts)

    def _seen_from(self, pose: Floats, point: Floats) -> Floats:
        """Return where a map point, (2,), lies from a pose: forwards and to the left."""
        x, y = point - pose[:2]
        cosine, sine = math.cos(pose[2]), math.sin(pose[2])
        return np.array([cosine * x + sine * y, cosine * y - sine * x])

    def _side(self, point: Floats) -> str:
        """Return in words which part of the footprint a point, (2,), seen from it is at."""
        low, high = self.footprint.bounds
        x, y = np.clip((point - low) / (high - low), 0.0, 1.0)
        along = "front" if x > 1.0 - _THIRD else "rear" if x < _THIRD else ""
        # Where y points down, what turns by positive angles turns to the right.
        left, right = ("left", "right") if self.grid.frame.y_up else ("right", "left")
        across = left if y > 1.0 - _THIRD else right if y < _THIRD else ""
        if along and across:
            return f"{along} {across} corner"
        return f"{along or across} side" if along or across else "middle"


def _placed(poses: Floats, point: Floats) -> Floats:
    """Return where a point of the footprint, (2,), is at poses, (n, 3): (n, 2)."""
    cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    by = np.column_stack([cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]])
    placed: Floats = poses[:, :2] + by
    return placed
