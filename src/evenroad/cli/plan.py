"""The options of ``evenroad plan``, for a disk on a map or for an arm in a scene, and of ``evenroad demo``."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from evenroad.cli.map_times import CarTimes, MapTimes
from evenroad.cli.options import Positional, Repeatable, option_names
from evenroad.cli.read_options import HELP, given_options, require_known_options
from evenroad.cli.sampler import SamplerOptions
from evenroad.errors import InvalidValue

if TYPE_CHECKING:
    from evenroad.certificates.sources import Sources
    from evenroad.loading.model import RobotModel

OF_ROBOTS: dict[str, tuple[str, ...]] = {
    "the robot's files": ("srdf", "group", "bodies", "use_visuals", "upright_meshes", "package", "xacro", "padding")
}
"""Title of the group of options of a robot's file -> these options."""


@dataclass(frozen=True, kw_only=True)
class PlanOptions(SamplerOptions):
    """The options of every plan."""

    groups: ClassVar[dict[str, tuple[str, ...]]] = {
        "from where to where": (
            *("help", "world", "robot_radius", "robot", "roadmap", "start", "goal", "goal_pose"),
            *("goal_radius", "goal_within"),
            *("footprint", "turning_radius", "forward_only", "holonomic", "cusp_cost"),
            *("tip", "frame", "free_axis", "tolerance", "deg"),
            *("clearance", "prefer_clearance", "unknown_is_free", "rules"),
        ),
        "on the way": ("via", "straight", "away", "upright", "upright_axis", "constraint"),
        "search": ("time", "improve", "certified", "resolution", "seed", "raw"),
        "a roadmap of points (PRM), in place of the default search": (
            *("n", "sampler", "k", "connect_radius", "guarantees", "plain", "skip", "allow_fewer"),
        ),
        "times": (
            *("timed", "trajectory", "speed", "acceleration", "lateral", "curvature_rate", "angular_speed"),
            *("angular_acceleration", "limits", "torque", "tip_speed", "tip_acceleration"),
            *("start_velocity", "goal_velocity", "deviation", "step", "controller_joints"),
        ),
        **OF_ROBOTS,
        "results": ("out", "no_picture", "json", "csv", "certificate", "embed"),
    }
    """Title of a group of the help -> its options."""
    planner: ClassVar[str]
    """Function that plans, ``module:name``, loaded on call."""

    world: Positional[Path]
    """The file of the world."""
    start: tuple[str, ...]
    """Where to start."""
    goal: Repeatable[tuple[tuple[str, ...], ...]]
    """Where to go."""
    n: Annotated[int | None, "-n"] = None
    """Plan with PRM on exactly this many points; 512 if only other options of a roadmap are given.  Default: no
    roadmap; search until a path, a proof that there is none, or the end of the time."""
    time: float | None = None
    """Time limit in seconds, > 0 (default 5; with PRM 60)."""
    improve: bool = False
    """Use all of the time: plan again with other seeds, and keep the shortest path.  Not with PRM."""
    certified: bool = False
    """Require a proof that the whole path is free; if a motion has none, the answer names it."""
    k: Annotated[int | None, "-k"] = None
    """Connect each milestone with its k nearest, in both directions (default 10; 20 from six joints on)."""
    connect_radius: float | None = None
    """Connect milestones up to this distance instead, in map units or radians."""
    seed: int = 0
    """Seed of everything random; the same command gives the same path."""
    raw: bool = False
    """Leave the path as it was found, without smoothing."""
    out: Annotated[Path | None, "-o"] = None
    """Files to write: OUT.json, OUT.png and, for an arm, OUT.csv; OUT may end in one of these.
    Default: the name of WORLD in the current folder, with -plan added where that would overwrite an input."""
    no_picture: bool = False
    """Draw no picture."""
    json: bool = False
    """Print the plan as JSON instead of a table."""

    def run(self) -> int:
        """Plan, write, report; return 0 when solved, else 1."""
        module, _, name = self.planner.partition(":")
        code: int = getattr(import_module(module), name)(self)
        return code


@dataclass(frozen=True, kw_only=True)
class PlanDisk(PlanOptions, MapTimes):
    """Plan a short path for a disk on a map, write a JSON result and a picture.

    A disk (--robot-radius) moves on a bare image (.png, .pgm, .bmp): unit = pixel, x right, y DOWN, origin in the
    top-left corner, dark = obstacle; on a map of the MovingAI benchmarks (.map): the same, a letter a pixel; or on a
    ROS map_server file (.yaml): unit = metre, map frame, y up.

    For an arm in a scene give --robot instead; its options: evenroad plan --help robot; for a car --footprint.

    Example: evenroad plan office.yaml --start 1 2 --goal 8.5 3 --robot-radius 0.25
    """

    planner = "evenroad.cli.plan_disk:plan_disk"

    world: Positional[Path]
    """A map: a .png, .pgm or .bmp image, a ROS map_server .yaml, or a MovingAI .map."""
    start: tuple[str, ...]
    """Where to start: x y in map units."""
    goal: Repeatable[tuple[tuple[str, ...], ...]]
    """Where to go: x y in map units.  You can give several: the path ends at the first one reached, with PRM or
    --improve at the one with the shortest path."""
    robot_radius: float
    """Plan for a disk of this radius, > 0, in map units."""
    clearance: float = 0.0
    """Distance to keep from every obstacle, beside the radius, >= 0, in map units."""
    prefer_clearance: float = 0.0
    """Distance to keep from obstacles where there is room, >= 0, in map units; a length at one counts three times."""
    unknown_is_free: bool = False
    """Treat unknown cells of a ROS map as free."""
    rules: str | None = None
    """Read a ROS map by the rules of nav2 (since April 2025; the default) or ros1 (and nav2 before)."""
    csv: bool = False
    """Also write the path as OUT.csv."""
    guarantees: bool = False
    """Print what the roadmap guarantees: from which clearance on it has a path if one exists, and how long that path
    is at most.  With PRM; the sampler cover guarantees most."""


@dataclass(frozen=True, kw_only=True)
class PlanCar(PlanOptions, CarTimes):
    """Plan a short path for a car or another footprint on a map, write a JSON result and a picture of what it sweeps.

    All that the footprint sweeps along its curves is tested exactly.  Poses are x y angle, an angle of 0 along x.

    Example: evenroad plan office.yaml --footprint "[[-0.45, -0.31], [0.45, -0.31], [0.45, 0.31], [-0.45, 0.31]]"
    --turning-radius 0.6 --start 1 2 90 --goal 8.5 3 0 --deg
    """

    planner = "evenroad.cli.plan_car:plan_car"

    world: Positional[Path]
    """A map: a .png, .pgm or .bmp image, a ROS map_server .yaml, or a MovingAI .map; or polygons: GeoJSON (.geojson,
    .json), or a parking case of TPCAP (.csv)."""
    start: tuple[str, ...]
    """Where to start: x y angle in map units and radians."""
    goal: Repeatable[tuple[tuple[str, ...], ...]]
    """Where to go: x y angle.  You can give several: the path ends at the first one reached."""
    goal_radius: float | None = None
    """Go to any position within this distance of the goal, >= 0; a goal of x y alone then has any angle."""
    goal_within: float = 0.0
    """By how much the angle at such a goal may differ, 0 to pi."""
    footprint: str
    """Plan for this footprint: corners "[[x, y], ...]" around the reference point, x forwards, y to the left, in map
    units; or a list of several polygons."""
    turning_radius: float = 0.0
    """Least radius of a turn, >= 0, in map units; 0 turns on the spot."""
    forward_only: bool = False
    """Never drive backwards."""
    holonomic: bool = False
    """Move in every direction, and turn on the way."""
    cusp_cost: float | None = None
    """Length that a change between forwards and backwards counts, >= 0 (default: the turning radius)."""
    deg: bool = False
    """Read angles in degrees."""
    clearance: float = 0.0
    """Distance to keep from every obstacle, >= 0, in map units; at corners of the footprint up to 2 % more."""
    prefer_clearance: float = 0.0
    """Distance to keep from obstacles where there is room, >= 0, in map units; a length at one counts three times."""
    unknown_is_free: bool = False
    """Treat unknown cells of a ROS map as free."""
    rules: str | None = None
    """Read a ROS map by the rules of nav2 (since April 2025; the default) or ros1 (and nav2 before)."""
    csv: bool = False
    """Also write the path as OUT.csv: poses x, y, angle, a cell apart."""


@dataclass(frozen=True, kw_only=True)
class RobotOptions:
    """The options of a robot's file."""

    groups: ClassVar[dict[str, tuple[str, ...]]] = OF_ROBOTS

    srdf: Path | None = None
    """The robot's SRDF: groups, named states and pairs of links without a test."""
    group: Repeatable[tuple[str, ...]] = ()
    """What to plan for: a group of the SRDF, or joints separated by commas; you can give several, in this order.  Other
    joints stay where the named states of start and goal have them, else at 0, or where nothing touches."""
    bodies: Path | None = None
    """What stands for the links: shapes, as the file has them (default); capsules, fitted around these; or a YAML file
    of capsules and spheres."""
    use_visuals: bool = False
    """Use the visual geometry of links that have no collision geometry."""
    upright_meshes: bool = False
    """Turn the glTF meshes of links: their y axis, which is up, becomes z."""
    package: Repeatable[tuple[str, ...]] = ()
    """NAME=FOLDER: the folder of a ROS package with meshes; you can give several."""
    xacro: Repeatable[tuple[str, ...]] = ()
    """NAME=VALUE: an argument of a xacro, VALUE may be empty; you can give several."""
    padding: Repeatable[tuple[str, ...]] = ()
    """Extra distance of links to obstacles: METRES; LINK=METRES, you can give several; or MoveIt's YAML file."""

    def options(self) -> dict[str, Any]:
        """Return the options of `load_model`; fitting reports on standard error."""
        return {
            "srdf": self.srdf,
            "group": ",".join(self.group) if self.group else None,
            "bodies": self.bodies,
            "use_visuals": self.use_visuals,
            "upright_meshes": self.upright_meshes,
            "packages": _pairs("--package", "NAME=FOLDER", self.package),
            "arguments": _pairs("--xacro", "NAME=VALUE", self.xacro, may_be_empty=True),
            "progress": say_fitting,
            "padding": self._padding(),
        }

    def sources(self, robot: str, scene: Path | None, embed: bool) -> Sources:
        """Return the files that a certificate is about."""
        from evenroad.certificates.sources import Sources

        made = self.options()
        reading = {name: made[name] for name in ("packages", "arguments", "use_visuals", "upright_meshes")}
        return Sources.named(robot, scene, self.srdf, embed=embed, **reading)

    def read_robot(self, source: str) -> RobotModel:
        """Return a robot and how it was made."""
        from evenroad.loading.load import load_model

        return load_model(source, **self.options())

    def _padding(self) -> float | dict[str, float] | str | None:
        """Return the argument `padding`."""
        if len(self.padding) == 1 and "=" not in self.padding[0]:
            with suppress(ValueError):
                return float(self.padding[0])
            return self.padding[0]
        try:
            pairs = _pairs("--padding", "LINK=METRES", self.padding)
            return {link: float(metres) for link, metres in pairs.items()} or None
        except ValueError:
            raise InvalidValue(f"--padding must be numbers, got {' '.join(self.padding)!r}") from None


def say_fitting(step: int, steps: int, what: str) -> None:
    """Report on standard error the body that capsules are fitted to: every one on a terminal, every tenth in a log."""
    line = f"evenroad: fitting capsules, once: {step + 1}/{steps} {what}"
    if sys.stderr.isatty():
        print(f"\r\x1b[K{line}", end="\n" if step + 1 == steps else "", file=sys.stderr, flush=True)
    elif step % 10 == 0:
        print(line, file=sys.stderr, flush=True)


def _pairs(option: str, form: str, texts: Iterable[str], may_be_empty: bool = False) -> dict[str, str]:
    pairs = [text.partition("=") for text in texts]
    for name, separator, value in pairs:
        if not (name and separator and (value or may_be_empty)):
            raise InvalidValue(f"{option} must be of the form {form}, got {name + separator + value!r}")
    return {name: value for name, _, value in pairs}


@dataclass(frozen=True, kw_only=True)
class PlanArm(PlanOptions, RobotOptions):
    """Plan a short path for an arm in a scene, write a JSON result, the path as CSV and a picture.

    An arm (--robot) moves in a scene file (.yaml): metres and radians, frame of the robot's root link.
    For a disk on a map: evenroad plan --help disk

    Example: evenroad plan box-reach.yaml --robot ur5 --start home --goal inside
    """

    planner = "evenroad.cli.plan_arm:plan_arm"

    world: Positional[Path]
    """A scene (.yaml), or a name of `evenroad scenes`."""
    start: tuple[str, ...]
    """Where to start: one number per joint, separated by commas, name=value,..., or a named state."""
    robot: str
    """Plan for this arm: a URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others."""
    roadmap: Path | None = None
    """Plan along this roadmap of the arm's joints, made by evenroad roadmap."""
    goal: Repeatable[tuple[tuple[str, ...], ...]] = ()
    """Where to go, as start.  You can give several, also with --goal-pose: the path ends at the nearest if that is soon
    reached, with PRM or --improve at the one with the shortest path."""
    goal_pose: Repeatable[tuple[tuple[str, ...], ...]] = ()
    """The pose of a link: "x y z qx qy qz qw" or "x y z roll pitch yaw" (metres, radians), or "x y z" with any
    rotation.  All configurations found that reach it are goals; you can give several; "LINK: x y z ... & LINK: ..." is
    one goal of both."""
    tip: str = ""
    """The link of goal poses, --straight, --upright and --tip-speed (default: the last link)."""
    frame: str = ""
    """The frame of goal poses: a link that does not move (default: the root)."""
    free_axis: str | None = None
    """Axis of the tip about which its rotation is free: x, y, z or "x y z"."""
    tolerance: str | None = None
    """Largest error at goal poses: "0.002" (metres) or "0.002 0.01" (metres and radians)."""
    via: Repeatable[tuple[tuple[str, ...], ...]] = ()
    """Where to stop on the way, as start, or "LINK: x y z roll pitch yaw"; several in this order."""
    straight: str | None = None
    """Length of the straight lines in which the tip approaches its goal and leaves its start: "0.1" (metres) or
    "0.1 0.05", goal first."""
    away: str | None = None
    """Direction of these lines, away from start and goal: x, -x, ... or "x y z" of the tip's frame, or up
    (default: -z)."""
    upright: float | None = None
    """Largest tilt of an axis of the tip along the whole path, in radians."""
    upright_axis: str | None = None
    """That axis, in the tip's frame (default: the most upright one at the start)."""
    constraint: Repeatable[tuple[tuple[str, ...], ...]] = ()
    """What the whole path keeps: "orientation 0.01", "plane z", "line y", "box 0,0,0 1,1,1", "circle 0.8,0.3,0 z",
    "together LINK LINK" or "joints NAME=0,2"; then within=0.001, tip=LINK.  Or "differential-drive": a base that
    drives along its heading alone; x=, y= and heading= name its joints (default: base/x, base/y, base/theta)."""
    deg: bool = False
    """Read angles in degrees: of start, goal, "roll pitch yaw" and --upright."""
    resolution: float = 0.05
    """Largest step of a motion check, > 0, in radians."""
    clearance: float = 0.0
    """Distance to keep from all obstacles, 0 to 1, in metres; not from the arm itself."""
    certificate: Path | None = None
    """Write a proof of the answer here, which evenroad-verify checks."""
    embed: bool = False
    """The certificate carries robot and scene, too, not only what a checker cannot read."""
    trajectory: Repeatable[tuple[Path, ...]] = ()
    """Write a trajectory: .json, .csv, .yaml (ROS 2 JointTrajectory), .mcap (the same as a bag), .script (URScript,
    by the clock) or .movej.script (waypoint by waypoint).  You can give several."""
    timed: bool = False
    """Give the path its times, which OUT.json keeps for evenroad view and evenroad send; so does --trajectory."""
    speed: float = 1.0
    """With times: share of full speed, > 0 and at most 1."""
    limits: Path | None = None
    """With times: a MoveIt joint_limits.yaml.  Default: velocities of the URDF, full speed after 0.5 s."""
    torque: bool = False
    """With times: no joint needs more than its effort, by the masses and efforts of the robot's URDF."""
    tip_speed: float | None = None
    """With times: largest speed of the tip, > 0, in metres per second."""
    tip_acceleration: float | None = None
    """With times: largest acceleration of the tip, > 0, in m/s^2."""
    start_velocity: str | None = None
    """With times: how fast the joints move at the start, one number per joint or name=value,..., in radians (metres)
    per second (default: at rest)."""
    goal_velocity: str | None = None
    """The same at the goal."""
    deviation: float = 0.05
    """With times: largest deviation at a rounded corner, >= 0, in radians."""
    step: float = 0.008
    """With times: time between two states in seconds, > 0; 0.002 for a UR of the e-Series."""
    controller_joints: str | None = None
    """With times: all joints of the controller, in its order, separated by commas."""


@dataclass(frozen=True, kw_only=True)
class Demo:
    """Plan through a maze that ships with evenroad."""

    level: int = 3
    """Which maze: 1, 2 or 3; 3 is the hardest."""
    n: Annotated[int, "-n"] = 1024
    """Number of points of the roadmap."""
    out: Annotated[Path, "-o"] = Path("demo")
    """Files to write: OUT.png and OUT.json."""

    def run(self) -> int:
        """Run ``evenroad plan`` on the maze with its own start and goal."""
        from evenroad.world.gridmap.load import load_maze

        maze = load_maze(self.level)
        return PlanDisk(
            world=maze.path,
            start=tuple(map(str, maze.start)),
            goal=(tuple(map(str, maze.goal)),),
            robot_radius=maze.robot_radius,
            n=self.n,
            out=self.out,
        ).run()


_KINDS: dict[str, type[PlanOptions]] = {"--robot-radius": PlanDisk, "--robot": PlanArm, "--footprint": PlanCar}
"""The option that names a robot -> the class of its options."""


def plan_type(words: Sequence[str]) -> type[PlanOptions]:
    """Return the class of a command line by its robot; InvalidValue if its options do not go together."""
    given = given_options(words)
    named = [option for option in _KINDS if option in given]
    chosen = _KINDS[named[-1]] if named else PlanDisk
    if not HELP.isdisjoint(words):
        return chosen
    known = {option: option_names(kind) for option, kind in _KINDS.items()}
    require_known_options("evenroad plan", words, set().union(*known.values()))
    if len(named) != 1:
        text = "give --robot-radius (a disk), --footprint (a car) or --robot (an arm), exactly one of them"
        given_now = " and ".join(named) or "none"
        raise InvalidValue(f"{text}, not {given_now}; all options: evenroad plan --help")
    for option in sorted(given - known[named[0]]):
        needs = " or ".join(each for each, options in known.items() if option in options)
        raise InvalidValue(f"{option} goes with {needs} only")
    return chosen
