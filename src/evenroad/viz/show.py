"""Showing what there is: in the browser, or below a notebook's cell."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from types import ModuleType
from typing import TypeAlias

from PIL import Image

from evenroad.collision.arm_world import ArmWorld
from evenroad.driving.car_world import CarWorld
from evenroad.driving.polygon_map import PolygonMap
from evenroad.errors import InvalidValue, shown
from evenroad.flight.flight_trajectory import FlightTrajectory
from evenroad.flight.flight_world import FlightWorld
from evenroad.loading.cache import file_of
from evenroad.planning.plan import plan as plan_path
from evenroad.planning.result import PlanResult
from evenroad.points.pointset import PointSet
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene
from evenroad.task.motion import Motion
from evenroad.task.result import TaskResult
from evenroad.trajectory.car_states import CarTrajectory
from evenroad.trajectory.trajectory import Trajectory
from evenroad.viz.browser import how_to_open, open_browser
from evenroad.viz.page import ArmPage
from evenroad.viz.page_server import PageServer
from evenroad.viz.picture_of import opened, picture_of, plan_shown
from evenroad.viz.player import page_of
from evenroad.viz.task_page import page_of_task
from evenroad.world.gridmap import DiskWorld, GridMap

Shown: TypeAlias = (
    PlanResult
    | TaskResult
    | Trajectory
    | CarTrajectory
    | FlightTrajectory
    | Motion
    | GridMap
    | PolygonMap
    | PointSet
    | ArmWorld
    | DiskWorld
    | CarWorld
    | FlightWorld
    | Robot
    | Scene
    | str
    | os.PathLike[str]
)
"""What can be shown."""
HEIGHT = 600
"""Height of the page below a notebook's cell [pixels]."""


def show(what: Shown, q: object = None, *, port: int = 0) -> ArmPage | PageServer | Image.Image:
    """Show a plan, a trajectory or a task as a page in the browser that plays it: an arm, or a disk or car on its map.

    An arm's page plans again as start, goal and obstacles are dragged.  All else is a picture.

    A robot, also in its scene, is a picture of it at a configuration, with what touches in red.  The title says what
    touches, or which two bodies are nearest, and how far.  In a notebook all appears below the cell.  Elsewhere a page
    is served until Ctrl-C; where no browser opens, its address is printed.

    Parameters
    ----------
    what : PlanResult, Trajectory, TaskResult, Motion, Robot, Scene, GridMap, PointSet, a world, or a file of one
        A plan or a trajectory must know its world, as those of :func:`evenroad.plan` and their files do.
    q : array_like, shape (dim,), mapping or str, optional
        The configuration at which a robot is shown, as `ArmWorld.valid` takes one.  Default: the state ``home``, or
        where there is none all joints at 0, or at the nearest to it within limits.
    port : int
        Where the page is served, on this computer alone; 0 takes any that is free.

    Returns
    -------
    ArmPage, PageServer or PIL.Image.Image
        The page, which is closed unless it is shown in a notebook; or the picture.

    Raises
    ------
    InvalidValue
        If it is none of these, or `q` is not a configuration of the robot, or is given with something else.
    UnknownName
        If `q` names a state or a joint that does not exist.
    NotAvailable
        If its world cannot be drawn, or the port is taken.

    Examples
    --------
    >>> import evenroad as er
    >>> result = er.plan(er.ArmWorld("ur5"), (0, -1.5, 0, -1.5, 0, 0), (1, -1.5, 0.5, -1.5, 0, 0))
    >>> er.show(result)  # doctest: +SKIP
    >>> er.show(er.ArmWorld("ur5", "box-reach"), "inside")  # doctest: +SKIP
    """
    if isinstance(what, str | os.PathLike):
        what = opened(what)  # type: ignore[assignment]
    if q is not None and not isinstance(what, ArmWorld | Robot):
        raise InvalidValue(f"q says where a robot stands, also in an er.ArmWorld, got q={shown(q)} with something else")
    notebook = _notebook()
    if (page := _page(what, port)) is not None:
        return _served(page, notebook)
    picture = picture_of(what, q)
    if notebook is None:
        picture.show()
    else:
        notebook.display(picture)
    return picture


def _page(what: object, port: int) -> ArmPage | PageServer | None:
    """Return the page that plays a plan, a trajectory or a task; None if only a picture shows it."""
    if isinstance(what, TaskResult) and what.path is not None:
        played = page_of_task(what)
        return PageServer("127.0.0.1", port, lambda: played)
    if (result := plan_shown(what)) is None:
        return None
    world = result.world
    timed = (what.times, what.positions) if isinstance(what, Trajectory | CarTrajectory) else None
    if isinstance(world, ArmWorld):
        return ArmPage(world, result, plan_path, file_of(world.robot), timed=timed, port=port)
    if not isinstance(world, DiskWorld | CarWorld) or result.path is None:
        return None
    text = page_of(result, timed=timed)
    return PageServer("127.0.0.1", port, lambda: text)


def _served(page: ArmPage | PageServer, notebook: ModuleType | None) -> ArmPage | PageServer:
    """Serve a page until Ctrl-C, or show it below a notebook's cell."""
    if notebook is not None:
        notebook.display(notebook.IFrame(page.address, "100%", HEIGHT))
        return page
    try:
        if not open_browser(page.address):
            print(how_to_open(page.address, is_open=False), flush=True)
        page.serve()
    except KeyboardInterrupt:
        pass
    finally:
        page.close()
    return page


def _notebook() -> ModuleType | None:
    """Return what displays things in a notebook, None outside of one."""
    module = sys.modules.get("IPython")
    shell = None if module is None else module.get_ipython()
    if type(shell).__name__ != "ZMQInteractiveShell":
        return None
    return import_module("IPython.display")
