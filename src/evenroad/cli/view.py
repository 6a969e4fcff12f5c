"""``evenroad view``: an arm in its scene and its path, on a page in the browser or as a GIF."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from evenroad._arrays import Floats
from evenroad._files import require_writable_folder
from evenroad.cli.plan import RobotOptions
from evenroad.cli.roadmap import load_arm_roadmap
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.io import load_plan
from evenroad.planning import PRM
from evenroad.planning.plan import Options, solve
from evenroad.planning.read_request import arm_request
from evenroad.planning.request import Reading, Request
from evenroad.roadmap import Budget, PlanResult
from evenroad.robot import find_robot, load_scene
from evenroad.robot.goals import Goals
from evenroad.robot.urdf_xml import RobotFile
from evenroad.robot_roadmap.static_scene import joined_scenes

FILES = {
    "srdf": str | None,
    "bodies": str | None,
    "use_visuals": bool | None,
    "packages": dict | None,
    "arguments": dict | None,
}
"""Fields of a plan about its robot's files, and their types; plans of earlier versions have fewer."""
SECONDS = 0.5
"""Time limit for planning again while a start or goal is dragged [s]."""


@dataclass(frozen=True, kw_only=True)
class View(RobotOptions):
    """Show an arm in its scene with its path and a slider, on a page that this computer serves.

    You can drag start and goal; the path is planned again as they move.  Ctrl-C ends it.
    """

    world: tyro.conf.Positional[Path]
    """A plan of evenroad plan --robot (.json); or a scene (.yaml), with --robot."""
    robot: str | None = None
    """A URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others.
    Default: that of the plan."""
    start: str = "home"
    """With a scene: one number per joint, separated by commas, name=value,..., or a named state."""
    goal: str | None = None
    """As start.  Default: the start."""
    n: Annotated[int | None, tyro.conf.arg(aliases=["-n"])] = None
    """Plan again on this number of points, whose roadmap can be shown; default: with trees."""
    port: int = 8080
    """Port of the page; 0 takes any free one."""
    gif: Path | None = None
    """Write an animation to this file instead of serving a page."""

    def run(self) -> int:
        """Show until Ctrl-C, or write the picture; return 0."""
        if not 0 <= self.port < 65536:
            raise InvalidValue(f"port must be from 0 to 65535, got {self.port}")
        if self.gif is not None:
            if self.gif.suffix.lower() != ".gif":
                raise InvalidValue(f"--gif must name a .gif, got {str(self.gif)!r}")
            require_writable_folder(self.gif)
        request, result = self.request()
        if self.gif is not None:
            from evenroad.viz.solid import save_arm_gif

            save_arm_gif(self.gif, result, request.world)
            print(f"wrote {self.gif}")
            return 0
        from evenroad.viz.page import ArmPage

        def plan(start: Floats, goal: Floats) -> PlanResult:
            goals = goal[np.newaxis]
            return self._planned(replace(request, start=start, goals=goals, given=Goals(goals, ("",))))

        file = request.source
        if file is None and self.robot is not None:
            file = RobotFile(find_robot(self.robot)[0])
        page = ArmPage(request.world, result, plan, file, port=self.port)
        print(f"{page.address}   (Ctrl-C ends it)", flush=True)
        try:
            page.serve()
        finally:
            page.close()
        return 0

    def request(self) -> tuple[Request, PlanResult]:
        """Return the request of the plan, or of a scene, and the plan."""
        options = self.options()
        if self.world.suffix.lower() != ".json":
            if self.robot is None:
                raise InvalidValue("give --robot, the arm that moves in this scene")
            goal = self.start if self.goal is None else self.goal
            request = arm_request(self.robot, self.world, self.start, goal, Reading(), **options)
            return request, self._planned(request)
        result, query = load_plan(self.world)
        robot: Any = self.robot or query.get("robot")
        kept = query.get("roadmap")
        if not isinstance(robot or kept, str) or not isinstance(query.get("scene"), str):
            raise InvalidValue(f"{self.world} is not the plan of an arm: it names no robot and scene")
        _require_sound(self.world, query)
        for name in FILES:
            options[name] = options[name] or query.get(name) or options[name]
        options["group"] = options["group"] or ",".join(query["joints"])
        scene = load_scene(query["scene"])
        if kept is not None:
            roadmap = load_arm_roadmap(kept)
            scene = joined_scenes(roadmap.scene, scene)
            robot, options = (roadmap.robot, {}) if robot is None else (robot, options)
        request = arm_request(robot, scene, result.start, list(result.goals), Reading(held=query["held"]), **options)
        if self.n is not None:
            result = self._planned(request)
        return request, result

    def _planned(self, request: Request) -> PlanResult:
        planner = None if self.n is None else PRM(self.n)
        return solve(request, planner, Options(Budget(seconds=SECONDS)))


def _require_sound(file: Path, query: dict[str, Any]) -> None:
    """Raise BrokenFile where a plan does not describe its robot as `evenroad plan` does."""
    kinds = {"joints": list, "held": dict, **FILES}
    sound = all(isinstance(query.get(name), kind) for name, kind in kinds.items())
    if sound:
        pairs = [*(query.get("packages") or {}).values(), *(query.get("arguments") or {}).values()]
        sound = all(isinstance(text, str) for text in (*query["joints"], *pairs))
        sound &= all(isinstance(value, int | float) for value in query["held"].values())
    if not sound:
        raise BrokenFile(f"{file} is a damaged plan: of its robot's joints, held joints or files")
