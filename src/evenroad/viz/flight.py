"""A picture of a flight from above: obstacles, the ball along its flight, start and goal."""

from __future__ import annotations

import numpy as np
from PIL import Image

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.flight.flight_trajectory import FlightTrajectory
from evenroad.flight.flight_world import FlightWorld
from evenroad.planning.result import PlanResult
from evenroad.viz import style
from evenroad.viz.plan import LEAST_WIDTH, LONG_SIDE
from evenroad.viz.sheet import Entry, Sheet, View
from evenroad.viz.surfaces import surface_of

_EVERY = 0.2
"""Time between two balls that are drawn along a flight [s]."""
_BALL = (166, 206, 240)
"""Colour of the ball."""
_MARGIN = 1.0
"""Margin around what is shown [m]."""
_STEPS = 2000
"""Largest number of lines that a flight is drawn by."""


def draw_flight_plan(result: PlanResult, world: FlightWorld) -> Image.Image:
    """Return a picture of a flight from above, in metres; obstacles are where they are at time 0."""
    flight = None if result.path is None else result.trajectory()
    return _drawn(world, np.vstack([result.start, result.goal]), flight, f"{result.status}: {result.message}")


def draw_flight(flight: FlightTrajectory) -> Image.Image:
    """Return a picture of a trajectory, as that of its plan."""
    if not isinstance(flight.world, FlightWorld):
        raise InvalidValue("this trajectory does not know its world, without which it cannot be shown")
    return _drawn(flight.world, flight.positions[[0, -1]], flight, f"trajectory of {flight.duration:.4g} s")


def _drawn(world: FlightWorld, terminals: Floats, flight: FlightTrajectory | None, title: str) -> Image.Image:
    """Return the picture of a flight, or of its start and goal alone, the two rows of `terminals`."""
    shown = terminals[:, :2] if flight is None else flight.positions[:, :2]
    low, high = shown.min(axis=0) - _MARGIN, shown.max(axis=0) + _MARGIN
    # A flight that is nearly straight is shown with what is beside it.
    widest = float((high - low).max())
    middle, half = 0.5 * (low + high), 0.5 * np.maximum(high - low, 0.4 * widest)
    low, high = middle - half, middle + half
    view = View(low, high, LONG_SIDE / float((high - low).max()))
    for obstacle in world.scene.obstacles:
        vertices, triangles = surface_of(obstacle.body)
        if (vertices[:, :2].max(axis=0) < low).any() or (vertices[:, :2].min(axis=0) > high).any():
            continue
        for triangle in triangles:
            view.polygon(vertices[triangle, :2], style.OBSTACLE)
    entries: list[Entry] = []
    if flight is not None:
        for at in flight.at(np.arange(0.0, flight.duration, _EVERY)):
            view.circle(at[:2], world.radius, _BALL)
        view.line(flight.at(np.linspace(0.0, flight.duration, _STEPS))[:, :2], style.PATH, 3)
        entries = [(f"ball, every {_EVERY:g} s", _BALL, "white"), ("flight", style.PATH, None)]
    for state, colour in zip(terminals, (style.START, style.GOAL), strict=True):
        view.dot(state[:2], colour, 6)
    entries += [("start", style.START, "white"), ("goal", style.GOAL, "white")]
    return Sheet.of_view(view, LEAST_WIDTH, title, "from above", ("x [m]", "y [m]"), entries).image
