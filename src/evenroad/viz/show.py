"""Showing a plan, a map, or an arm in its scene: in the browser, or below a notebook's cell."""

from __future__ import annotations

import sys
import webbrowser
from importlib import import_module
from types import ModuleType

from PIL import Image

from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.loading.cache import file_of
from evenroad.planning.plan import plan as plan_path
from evenroad.planning.result import PlanResult
from evenroad.viz.page import ArmPage
from evenroad.viz.posture import draw_arm_world
from evenroad.world.gridmap import GridMap

HEIGHT = 600
"""Height of the page below a notebook's cell [pixels]."""


def show(what: PlanResult | GridMap | ArmWorld, q: object = None, *, port: int = 0) -> ArmPage | Image.Image:
    """Show a plan: of an arm as a page in the browser, with its path under a slider; others and maps as a picture.

    An arm in its scene is a picture, too: the robot at a configuration, with what touches in red.  Its title says what
    touches, or which two bodies are nearest, and how far.  In a notebook all appears below the cell.  Elsewhere a page
    is served until Ctrl-C.

    Parameters
    ----------
    what : PlanResult, GridMap or ArmWorld
        A plan that knows its world, a map, or an arm in its scene.
    q : array_like, shape (dim,), mapping or str, optional
        The configuration at which an arm's world shows the robot, as `ArmWorld.valid` takes one.  Default: the state
        ``home``, or where there is none all joints at 0, or at the nearest to it within limits.
    port : int
        Where the page of an arm is served, on this computer alone; 0 takes any that is free.

    Returns
    -------
    ArmPage or PIL.Image.Image
        The page, which is closed unless it is shown in a notebook; or the picture.

    Raises
    ------
    InvalidValue
        If it is none of these, or `q` is not a configuration of the robot, or is given with a plan or a map.
    UnknownName
        If `q` names a state or a joint that does not exist.
    NotAvailable
        If its world cannot be drawn, the port is taken, or there is no browser.

    Examples
    --------
    >>> import evenroad as er
    >>> result = er.plan(er.ArmWorld("ur5"), (0, -1.5, 0, -1.5, 0, 0), (1, -1.5, 0.5, -1.5, 0, 0))
    >>> er.show(result)  # doctest: +SKIP
    >>> er.show(er.ArmWorld("ur5", "box-reach"), "inside")  # doctest: +SKIP
    """
    if not isinstance(what, PlanResult | GridMap | ArmWorld):
        kinds = "a plan or a map can be shown, as er.plan and er.load_map give it, and er.ArmWorld(robot, scene)"
        raise InvalidValue(f"{kinds}, got {shown(what)}")
    if q is not None and not isinstance(what, ArmWorld):
        raise InvalidValue(f"q says where a robot stands in an er.ArmWorld, got q={shown(q)} with a plan or a map")
    notebook = _notebook()
    if not isinstance(what, PlanResult) or not isinstance(what.world, ArmWorld):
        picture = draw_arm_world(what, q) if isinstance(what, ArmWorld) else what.plot()
        if notebook is None:
            picture.show()
        else:
            notebook.display(picture)
        return picture
    page = ArmPage(what.world, what, plan_path, file_of(what.world.robot), port=port)
    if notebook is not None:
        notebook.display(notebook.IFrame(page.address, "100%", HEIGHT))
        return page
    try:
        if not webbrowser.open(page.address):
            raise NotAvailable("there is no browser on this computer: result.plot('plan.png') draws the plan")
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
