"""``evenroad view``: a plan, of an arm, a disk or a car, in the browser, as one HTML file, a picture, or a GIF."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np

from evenroad._arrays import Floats
from evenroad._files import atomic_write, read_json_file, require_writable_folder
from evenroad._time_limit import within
from evenroad.cli.options import Positional
from evenroad.cli.plan import RobotOptions
from evenroad.cli.plan_file import PlanFile, read_plan
from evenroad.cli.run import run_task_of
from evenroad.collision.arm_world import ArmWorld
from evenroad.driving.car_world import CarWorld
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.loading.find import find_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.planning.plan import solve
from evenroad.planning.planners.prm import PRM
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import arm_problem
from evenroad.planning.reading import Reading
from evenroad.planning.result import PlanResult
from evenroad.roadmap import Budget
from evenroad.saved.world_value import file_in
from evenroad.task.result import TaskResult
from evenroad.task.save import is_task, load_task_result
from evenroad.trajectory.car import are_free
from evenroad.trajectory.car_states import CarTrajectory
from evenroad.trajectory.corners import drivable
from evenroad.viz.browser import how_to_open, open_browser
from evenroad.world.gridmap import DiskWorld

if TYPE_CHECKING:
    from PIL import Image

SECONDS = 0.5
"""Time limit for planning again while a start or goal is dragged [s]."""


@dataclass(frozen=True, kw_only=True)
class View(RobotOptions):
    """Show a plan: the arm in its scene, or the disk or car on its map, along the path.

    This computer serves a page on which you move start, goal and obstacles of an arm; the path is planned again as they
    move.  Ctrl-C ends it.  A plan on a map is written as a page that plays offline, and opened in the browser.

    Examples: evenroad view box-reach.json · evenroad view box-reach.json --html reach.html
    """

    world: Positional[Path]
    """A plan, a trajectory or a task that was saved (.json); or a scene (.yaml), with --robot.  A picture is shown of a
    scene alone, a map, a robot or points."""
    html: Path | None = None
    """Write one file that plays offline: play, pause, speed, joints, clearance; nothing is opened."""
    png: Path | None = None
    """Write a picture of the whole plan to this file; nothing is opened."""
    gif: Path | None = None
    """Write an animation of an arm to this file; nothing is opened."""
    robot: str | None = None
    """A URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others.
    Default: that of the plan."""
    start: str = "home"
    """With a scene: one number per joint, separated by commas, name=value,..., or a named state."""
    goal: str | None = None
    """As start.  Default: the start."""
    n: Annotated[int | None, "-n"] = None
    """Plan again with PRM on this number of points, and show its roadmap.  Default: as evenroad plan without -n."""
    port: int = 8080
    """Port of the page that is served; 0 takes any free one."""

    def run(self) -> int:
        """Write the files that are named, or show until Ctrl-C; return 0."""
        if not 0 <= self.port < 65536:
            raise InvalidValue(f"port must be from 0 to 65535, got {self.port}")
        named = (("--png", self.png, ".png"), ("--gif", self.gif, ".gif"), ("--html", self.html, ".html"))
        for option, file, suffix in named:
            if file is not None:
                if file.suffix.lower() != suffix:
                    raise InvalidValue(f"{option} must name a {suffix}, got {str(file)!r}")
                require_writable_folder(file)
        if (done := self._task()) is not None:
            return self._show_task(done)
        if (picture := self._picture()) is not None:
            file = Path(f"{self.world.stem}-view.png") if self.png is None else self.png
            picture.save(file)
            print(f"wrote {file}")
            if self.png is None:
                open_browser(file.resolve().as_uri())
            return 0
        plan = self.plan_file()
        if plan.changed:
            print(f"evenroad: the {' and '.join(plan.changed)} changed since this was planned", file=sys.stderr)
        if not _is_free(plan):
            print("evenroad: this is not proved free in its world as that is now", file=sys.stderr)
        arm = isinstance(plan.problem.world, ArmWorld)
        if self.png is not None:
            self._save_picture(plan, self.png)
        if self.gif is not None:
            self._save_gif(plan, arm)
        if self.html is not None:
            self._write_page(self._page(plan))
        if all(file is None for _, file, _ in named):
            if arm:
                self._serve(plan)
            elif isinstance(plan.problem.world, DiskWorld | CarWorld):
                self._write_page(self._page(plan))
            else:
                self._save_picture(plan, Path(f"{self.world.stem}.png"))
        return 0

    def _task(self) -> TaskResult | None:
        """Return the answer to a task that is shown: a saved one, or that of a trajectory of evenroad run."""
        if self.world.suffix.lower() != ".json" or is_task(self.world):
            return load_task_result(self.world) if is_task(self.world) else None
        record = read_json_file(self.world, "plan or trajectory")
        source = record.get("source") if isinstance(record, dict) else None
        made_by = source.get("task") if isinstance(source, dict) else None
        return None if made_by is None else run_task_of(made_by, self.world).planned()

    def _show_task(self, done: TaskResult) -> int:
        """Play the motions of a task's answer, or draw them; return 0."""
        if self.gif is not None:
            raise NotAvailable("the answer to a task is played with --html and drawn with --png; --gif is of one plan")
        if self.png is not None:
            done.plot(self.png)
            print(f"wrote {self.png}")
        if self.html is not None or self.png is None:
            from evenroad.viz.task_page import page_of_task

            self._write_page(page_of_task(done, self._file_of_task()))
        return 0

    def _file_of_task(self) -> RobotFile | None:
        """Return the robot's file that a saved task names, if it is still there."""
        record = read_json_file(self.world, "task")
        parts = [part for motion in record["motions"] for part in motion["parts"]] if is_task(self.world) else []
        return next((file_in(part["world"]) for part in parts if isinstance(part.get("world"), dict)), None)

    def _write_page(self, text: str) -> None:
        """Write a page that plays offline; open it unless its file is named."""
        page = Path(f"{self.world.stem}.html") if self.html is None else self.html
        with atomic_write(page) as file:
            file.write(text.encode())
        print(f"wrote {page}")
        if self.html is None:
            open_browser(page.resolve().as_uri())

    def _picture(self) -> Image.Image | None:
        """Return the picture of a map, a scene or points, or of a robot; None of what is a plan, or becomes one."""
        if self.world.suffix.lower() == ".json" or self.robot is not None:
            return None
        if self.html is not None or self.gif is not None:
            raise NotAvailable(
                f"of {self.world} there is a picture, with --png; --html and --gif show a plan, as evenroad plan"
                " writes it, or one in a scene with --robot"
            )
        from evenroad.viz.picture_of import opened, picture_of

        return picture_of(opened(self.world))

    def plan_file(self) -> PlanFile:
        """Return the plan, or one that is made in the scene."""
        if self.world.suffix.lower() == ".json":
            plan = read_plan(self.world, self.robot, self.options())
            return plan if self.n is None else replace(plan, result=self._planned(plan.problem), trajectory=None)
        assert self.robot is not None, "without one there is a picture"
        goal = self.start if self.goal is None else self.goal
        problem = arm_problem(self.robot, self.world, self.start, goal, Reading(), **self.options())
        return PlanFile(problem, self._planned(problem))

    def _file(self, plan: PlanFile) -> RobotFile | None:
        if plan.drawn is not None:
            return plan.drawn
        if plan.problem.source is None and self.robot is not None:
            return RobotFile(find_robot(self.robot)[0])
        return plan.problem.source

    def _save_picture(self, plan: PlanFile, path: Path) -> None:
        from evenroad.viz.arm import save_arm_picture

        if isinstance(plan.problem.world, ArmWorld):
            save_arm_picture(path, plan.result, plan.problem.world, self._file(plan))
        else:
            plan.result.plot(path)
        print(f"wrote {path}")

    def _save_gif(self, plan: PlanFile, arm: bool) -> None:
        if not arm:
            raise NotAvailable("--gif shows arms; --html plays plans on maps, too")
        from evenroad.viz.arm import save_arm_gif

        assert self.gif is not None
        save_arm_gif(self.gif, plan.result, plan.problem.arm, self._file(plan))
        print(f"wrote {self.gif}")

    def _page(self, plan: PlanFile) -> str:
        from evenroad.viz.player import page_of

        return page_of(plan.result, file=self._file(plan), timed=_times(plan))

    def _serve(self, plan: PlanFile) -> None:
        from evenroad.viz.page import ArmPage

        problem = plan.problem

        def again(world: ArmWorld, start: Floats, goal: Floats) -> PlanResult:
            goals = goal[np.newaxis]
            return self._planned(replace(problem, world=world, start=start, goals=goals, given=None))

        page = ArmPage(problem.arm, plan.result, again, self._file(plan), timed=_times(plan), port=self.port)
        print(how_to_open(page.address, open_browser(page.address)), flush=True)
        try:
            page.serve()
        finally:
            page.close()

    def _planned(self, problem: Problem) -> PlanResult:
        planner = None if self.n is None else PRM(self.n)
        with within(SECONDS):
            return solve(replace(problem, budget=Budget(seconds=SECONDS)), planner)


def _is_free(plan: PlanFile) -> bool:
    """Return whether what is shown is proved free: a file says only that it once was."""
    world, pieces = plan.problem.world, plan.result.pieces
    if isinstance(world, CarWorld) and pieces is not None and plan.result.solved:
        driven = plan.trajectory if isinstance(plan.trajectory, CarTrajectory) else None
        return are_free(world, plan.result.start, pieces, driven)
    shown = plan.result.path if plan.trajectory is None else plan.trajectory.positions
    return shown is None or not plan.result.solved or bool(drivable(world, shown)[0].all())


def _times(plan: PlanFile) -> tuple[Floats, Floats] | None:
    return None if plan.trajectory is None else (plan.trajectory.times, plan.trajectory.positions)
