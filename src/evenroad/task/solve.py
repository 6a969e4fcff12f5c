"""Planning of tasks: choices for all motions are found first, and the cheapest ones are then planned."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice
from time import perf_counter as now

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._rng import RngLike
from evenroad._time_limit import BudgetSpent, Deadline, look_at_clock, off_the_clock, until, within
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, UnknownName, shown
from evenroad.planning.connector import Smooth
from evenroad.planning.make_result import make_result
from evenroad.planning.plan import budget_of, solve
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import problem_in
from evenroad.planning.reading import Reading
from evenroad.planning.result import PlanResult, Status
from evenroad.poses.constraint import Constraint
from evenroad.poses.posture_layers import follow
from evenroad.roadmap.budget import Budget
from evenroad.robots.robot import ConfigurationLike
from evenroad.task.curves import follower_of
from evenroad.task.fingers import arm_alone, finger_leg, finger_values, moved_links, touching
from evenroad.task.gripper import Close, OfFingers, Open
from evenroad.task.motion import Leg, Motion, PlanBetween, along, choices
from evenroad.task.result import TaskResult
from evenroad.task.stage import Contacts, Stage, carrier_of, touches
from evenroad.task.steps import AlongCurve, Attach, Detach, Move, MoveTo, Step, Wait

WIDTHS = 2, 8, 32
"""Numbers of choices kept for each motion; a larger one is tried if a smaller one does not suffice."""


@dataclass(eq=False)
class _Branch:
    """A stage of the task before the step `number`, and the choices that led there; later choices are found lazily."""

    stage: Stage
    number: int
    legs: tuple[Leg, ...] = ()
    cost: float = 0.0
    later: list[_Branch] = field(default_factory=list)
    rest: Iterator[_Branch] | None = None

    @property
    def failed(self) -> bool:
        """Whether the plan of one of its motions failed."""
        return any(leg.planned is not None and not leg.planned.parts[-1].solved for leg in self.legs)


@dataclass(eq=False)
class _Search:
    """A search over the choices for all motions, level by level, which keeps the cheapest of each level."""

    steps: tuple[Step, ...]
    reading: Reading
    deadline: Deadline
    tried: int = 0
    deepest: int = -1
    why: PlanResult | None = None

    def whole(self, first: _Branch, width: int) -> list[_Branch]:
        """Return choices for all motions, cheapest first, with `width` choices kept for each motion."""
        level = [first]
        while any(isinstance(step, Move) for step in self.steps[level[0].number :]):
            begun = (branch for branch in level if not self.deadline.is_over)
            level = [later for branch in begun for later in self._later(branch, width) if not later.failed]
            level = sorted(level, key=lambda branch: branch.cost)[:width]
            if not level:
                return []
        for branch in level:
            # Objects that are attached or detached after the last motion must exist, too.
            self._acted(branch)
        return level

    def note(self, number: int, why: PlanResult) -> None:
        """Store why a step cannot be done; the failure after most steps says most."""
        if number > self.deepest:
            self.deepest, self.why = number, why

    def _later(self, branch: _Branch, count: int) -> list[_Branch]:
        """Return the first choices for the next motion of a branch, up to `count`."""
        if branch.rest is None:
            branch.rest = self._choices(branch)
        branch.later += islice(branch.rest, max(0, count - len(branch.later)))
        return branch.later

    def _choices(self, branch: _Branch) -> Iterator[_Branch]:
        """Yield the choices for the next motion of a branch, one by one."""
        number, stage = self._acted(branch)
        step = self.steps[number]
        last = not any(isinstance(each, Move) for each in self.steps[number + 1 :])
        assert isinstance(step, Move), "only steps that move are left"
        match step:
            case MoveTo():
                made = self._goals(number, stage, step, last)
            case Open() | Close():
                made = self._fingers(number, stage, step)
            case _:
                made = self._curve(number, stage, step)
        for choice in made:
            self.tried += 1
            if isinstance(choice, PlanResult):
                self.note(number, choice)
                continue
            after = replace(stage, q=choice.end, near_start=frozenset())
            if choice.motion.fingers:
                after = stage.with_fingers(choice.motion.fingers)
            yield _Branch(after, number + 1, (*branch.legs, choice), branch.cost + choice.cost)

    def _acted(self, branch: _Branch) -> tuple[int, Stage]:
        """Return the number of the next motion of a branch, and its stage after the gripper's actions before it."""
        stage = branch.stage
        for number, step in enumerate(self.steps[branch.number :], branch.number):
            where = f"step {number} of the task"
            if isinstance(step, Attach):
                stage = stage.attach(step, where, first=not branch.legs)
            elif isinstance(step, Detach):
                stage = stage.detach(step, where)
            elif isinstance(step, Move):
                return number, stage
        return len(self.steps), stage

    def _goals(self, number: int, stage: Stage, step: MoveTo, last: bool) -> Iterator[Leg | PlanResult]:
        look_at_clock()
        # Each line has its own contacts, so that an object lifted from a table may not end inside it.
        worlds = stage.with_contacts(stage.near_start), stage.world
        problem = problem_in(self._near_goal(number, stage), stage.q, step.goal, self.reading)
        # Lines are those of the goal's tip, else of the link that attached an object last.
        robot = stage.world.robot
        taken = [carrier_of(each, robot) for each in self.steps[:number] if isinstance(each, Attach)]
        return choices(problem, worlds, step, self.reading.tip or (taken[-1] if taken else ""), last=last)

    def _curve(self, number: int, stage: Stage, step: AlongCurve) -> Iterator[Leg | PlanResult]:
        world = self._near_goal(number, stage, stage.near_start)
        look_at_clock()
        follower = follower_of(step, world, stage.q, self.reading, f"step {number} of the task")
        if follower is None:
            yield Leg(stage.q, motion=Motion((), 0))
            return
        done = follow(follower, stage.q)
        afterwards = self._near_goal(number, stage)
        if not done.why and not afterwards.valid(done.path[-1]):
            done = replace(done, why=afterwards.explain(done.path[-1]))
        if done.why:
            message = f"{done.share:.1%} of the curve can be followed: then {done.why}"
            yield make_result(Problem(world, stage.q, stage.q[None]), Status.NOT_CONNECTED, message)
            return
        yield along(world, done, Motion((), 0, speed=step.speed, tip=follower.chain.tip))

    def _fingers(self, number: int, stage: Stage, step: OfFingers) -> Iterator[Leg | PlanResult]:
        """Yield the motion of the fingers, which may touch what is taken next and what was put down last."""
        look_at_clock()
        where, robot, scene = f"step {number} of the task", stage.world.robot, stage.world.scene
        values = finger_values(step, robot, scene, where)
        contacts, depths = self._contacts(number, stage, stage.near_start)
        if isinstance(step, Close) and step.until:
            if step.until not in scene.names:
                raise UnknownName.among(f"obstacle of {where}", step.until, scene.names)
            noticed = {(link, step.until) for link in moved_links(robot, values)}
            stops = touching(stage.with_contacts(contacts - noticed, depths), stage.q, values)
            if stops is None:
                why = f"the fingers close without touching {step.until!r}"
                yield make_result(Problem(stage.world, stage.q, stage.q[None]), Status.NOT_CONNECTED, why)
                return
            values = stops
        yield finger_leg(step, stage.with_contacts(contacts, depths), stage.q, values)

    def _near_goal(self, number: int, stage: Stage, contacts: Contacts = frozenset()) -> ArmWorld:
        """Return the world without some contacts, and without those of the line to a goal at which the gripper acts."""
        return stage.with_contacts(*self._contacts(number, stage, contacts))

    def _contacts(self, number: int, stage: Stage, contacts: Contacts) -> tuple[Contacts, dict[str, float]]:
        """Return contacts with those of the gripper's next action, and the allowed depths of these."""
        later = (step for step in self.steps[number + 1 :] if not isinstance(step, Wait | OfFingers))
        after = next(later, None)
        depths: dict[str, float] = {}
        if isinstance(after, Attach):
            robot = stage.world.robot
            links = (carrier_of(after, robot), *touches(after, robot))
            contacts |= {(link, after.object) for link in links}
            depths = {after.object: after.depth}
        if isinstance(after, Detach):
            contacts |= {(after.object, name) for name in after.onto}
        return contacts, depths


@explains_calls
def plan_task(
    steps: tuple[Step, ...],
    world: ArmWorld,
    start: ConfigurationLike,
    reading: Reading,
    *,
    seconds: float | None = None,
    limits: Budget | Mapping[str, int] | None = None,
    smooth: Smooth = True,
    rng: RngLike = 0,
) -> TaskResult:
    """Return the plan of a task; see :meth:`evenroad.task.Task.plan`."""
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"a task is planned in an ArmWorld, got {shown(world)}")
    began, budget = now(), budget_of(None, seconds, limits)
    with off_the_clock():
        _ = world.checker
    deadline = Deadline.after(budget.seconds)

    def plan_between(problem: Problem, constraints: Constraint | None) -> PlanResult:
        # Half of the remaining time, so that another choice has time, too.
        rest = budget if budget.seconds is None else replace(budget, seconds=max(0.5 * deadline.left, 1e-3))
        with within(rest.seconds):
            return solve(replace(problem, budget=rest, smooth=smooth, rng=rng, constraints=constraints))

    of_arm, world, start = arm_alone(steps, world, start, reading)
    search = _Search(of_arm, reading, deadline)
    motions, cut = None, False
    try:
        with until(deadline):
            begin = problem_in(world, start, start, reading)
            first = _Branch(Stage(begin.arm, begin.start, begin.arm.robot), 0)
            motions = _motions(search, first, plan_between)
    except BudgetSpent:
        cut = True
    timings = {"task": now() - began}
    if motions is not None:
        cost = sum(part.cost or 0.0 for motion in motions for part in motion.parts)
        message = f"{len(motions)} motions of length {cost:.6g}"
        return TaskResult(steps, Status.SOLVED, message, motions, None, timings, search.tried)
    status = Status.BUDGET_SPENT if search.why is None else search.why.status
    why = "the time is spent" if search.why is None else search.why.message
    message = f"step {max(search.deepest, 0)} of the task cannot be done: {why}"
    if search.tried > 1:
        message += f"; {search.tried} choices were tried in all"
    if search.why is not None and cut:
        message += ", then the time was spent"
    return TaskResult(steps, status, message, (), max(search.deepest, 0), timings, search.tried)


def _motions(search: _Search, first: _Branch, plan_between: PlanBetween) -> tuple[Motion, ...] | None:
    """Return the motions of the cheapest choices that can be planned, from increasing numbers of choices, or None."""
    for width in WIDTHS:
        for branch in search.whole(first, width):
            look_at_clock()
            if (motions := _planned(search, branch, first.stage.q, plan_between)) is not None:
                return motions
        look_at_clock()
    return None


def _planned(search: _Search, branch: _Branch, start: Floats, plan_between: PlanBetween) -> tuple[Motion, ...] | None:
    """Return the motions of a branch from the start, (dim,); None if one cannot be planned."""
    numbers = [number for number, step in enumerate(search.steps) if isinstance(step, Move)]
    motions, at = [], start
    for number, leg in zip(numbers, branch.legs, strict=True):
        motion = leg.plan(plan_between)
        if motion.goal is None:
            search.note(number, motion.parts[-1])
            return None
        motions.append(motion.gone_on(at))
        at = motions[-1].end if motion.parts else at
    return tuple(motions)
