"""Running the verb of a command line; our errors become one line and exit code 2."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from textwrap import fill
from typing import TYPE_CHECKING

from evenroad import __version__
from evenroad._terminal import leave_output, table_width
from evenroad.errors import EvenroadError, NotAvailable, UnknownName, in_one_line

if TYPE_CHECKING:
    from importlib.metadata import EntryPoints

DONE = 0
BAD_INPUT = 2

VERBS = {
    "plan": ("evenroad.cli.plan:PlanDisk", "plan a path, for a disk on a map or for an arm in a scene (--robot)"),
    "fly": ("evenroad.cli.fly:Fly", "plan a flight of a ball among the obstacles of a scene"),
    "run": ("evenroad.cli.run:RunTask", "plan a task of several motions from its file, as one trajectory"),
    "roadmap": ("evenroad.cli.roadmap:MakeRoadmap", "build a roadmap of an arm's joints, for many plans"),
    "view": ("evenroad.cli.view:View", "show a plan in the browser, or write it as HTML, PNG or GIF"),
    "send": ("evenroad.cli.send:Send", "send a plan to a UR arm, checked; a dry run without --go"),
    "ros2": ("evenroad.cli.ros2:Ros2", "run a node of ROS 2 that plans on maps, or for an arm"),
    "points": ("evenroad.cli.points:Points", "write evenly spread points, for sampling-based planners"),
    "measure": ("evenroad.cli.measure:Measure", "show how evenly the points of a file are spread"),
    "certify": (
        "evenroad.cli.certify:Certify",
        "show what a roadmap of points guarantees, whatever the obstacles",
    ),
    "certify-path": (
        "evenroad.cli.certify_path:CertifyPath",
        "prove another planner's path free, or find where it first touches",
    ),
    "pairs": ("evenroad.cli.pairs:Pairs", "show whether links that are not tested ever touch, with proofs"),
    "robot": ("evenroad.cli.robot:Robot", "show an arm's joints, limits and shapes, and how fast it is checked"),
    "robots": ("evenroad.cli.lists:Robots", "list the robots that have names"),
    "scenes": ("evenroad.cli.lists:Scenes", "list the scenes that ship"),
    "maps": ("evenroad.cli.lists:Maps", "list the maps that ship"),
    "samplers": ("evenroad.cli.lists:Samplers", "list the samplers of points"),
    "generate": (
        "evenroad.cli.generate:Generate",
        "make a data set of problems with timed paths, for learning",
    ),
    "demo": ("evenroad.cli.plan:Demo", "plan through a maze that ships with evenroad"),
}
"""Name of a verb -> its class, loaded on use, and its description."""

OF_STUDIES = {
    "train": "train point sets for an objective of your own",
    "bench": "run benchmarks; one file, the store, takes the results",
    "report": "write a page, figures and tables of a store",
    "export": "write a store for OMPL's Planner Arena",
}
"""Name of a verb of the package evenroad-studies -> its description."""
ENTRY_POINTS = "evenroad.verbs"
"""Group of entry points of verbs of another package."""

GROUPS = {
    "a path, from the plan to the robot": (
        ("plan", "view", "send", "ros2", "run", "fly", "certify-path", "roadmap", "robot", "pairs", "generate", "demo"),
        (
            "evenroad plan box-reach.yaml --robot ur5 --start home --goal inside",
            "evenroad view box-reach.json --html reach.html",
        ),
    ),
    "names": (("robots", "scenes", "maps", "samplers"), ("evenroad robots",)),
    "points": (
        ("points", "measure", "certify"),
        ("evenroad points -n 512 -d 6 -o set.npy", "evenroad measure set.npy"),
    ),
    "studies, of the package evenroad-studies": (
        tuple(OF_STUDIES),
        ("evenroad bench paper --quick --only maze-1 --store results.db",),
    ),
}
"""Title of a group of verbs -> its verbs, and examples that run as they stand."""

ABOUT = {name: about for name, (_, about) in VERBS.items()} | OF_STUDIES
"""Name of every verb -> its description."""

COMPLETION = ("--print-completion", "--tyro-print-completion")
"""Options that print the completion for a shell, the earlier name last."""

DESCRIPTION = f"""usage: evenroad [-h] [--version [-v]] [--print-completion {{bash,zsh,fish}}] VERB ...

evenroad {__version__}: paths proved free for robot arms and for disks on maps, and even point sets.

Exit codes: 0 solved / done, 1 any other answer (no path), 2 bad input, 70 internal error, 130 interrupted.
Options: evenroad VERB --help
"""


def run(arguments: Sequence[str]) -> int:
    """Run the verb of the arguments and return the exit code."""
    try:
        code = _run(list(arguments))
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        leave_output()
        return DONE
    except (EvenroadError, MemoryError, OSError) as error:
        kind = "not enough memory: " if isinstance(error, MemoryError) else ""
        print(f"evenroad: error: {kind}{in_one_line(str(error))}", file=sys.stderr)
        return BAD_INPUT


def _run(arguments: list[str]) -> int:
    if arguments[:1] == ["help"]:
        arguments = [*arguments[1:], "--help"]
    verb, words = (arguments or ["--help"])[0], arguments[1:]
    if verb in ("--version", "version"):
        for word in {*words} - {"-v", "--verbose"}:
            raise UnknownName.among("option of --version:", word, ("-v", "--verbose"))
        print(f"evenroad {__version__}")
        if words:
            _print_surroundings()
        return DONE
    if verb in ("-h", "--help"):
        print(DESCRIPTION, end="")
        for title, (names, examples) in GROUPS.items():
            print(f"\n{title}:")
            for name in names:
                print(fill(f"  {name:12} {ABOUT[name]}", table_width(), subsequent_indent=" " * 15))
            print("".join(f"    $ {example}\n" for example in examples), end="")
        return DONE
    if verb in COMPLETION:
        _print_completion(words)
        return DONE
    if verb not in ABOUT:
        raise UnknownName.among("verb", verb, ABOUT)
    if verb == "plan":
        from evenroad.cli.plan_help import OVERVIEW, help_kind

        chosen = help_kind(words)
        if chosen == "":
            print(OVERVIEW, end="")
            return DONE
        words = words if chosen is None else [chosen, "--help"]
    # Imported late: version and help do without.
    from evenroad.cli.read_options import read_options

    try:
        options = read_options(verb, _kind(verb, words), words)
    except SystemExit:
        return DONE
    code: int = options.run()
    return code


def _print_surroundings() -> None:
    """Print versions, which build of the native kernel runs, and the cache folder."""
    from evenroad._files import cache_folder
    from evenroad._native import variants
    from evenroad.io import versions

    rows = {
        "runs on": ", ".join(f"{name} {version}" for name, version in versions().items()),
        "native kernel": variants.load().__name__.rpartition("._")[2].replace("_", "-"),
        "sets and meshes": str(cache_folder()),
    }
    for name, value in rows.items():
        print(f"{name:16} {value}")


def _print_completion(words: Sequence[str]) -> None:
    """Print what completes words in a shell."""
    from evenroad.cli.completion import SHELLS, completion
    from evenroad.cli.options import option_names

    shell = "".join(words[:1])
    if shell not in SHELLS:
        raise UnknownName.among("shell", shell, SHELLS)
    there = _installed()
    # A plan has other options for an arm than for a disk.
    kinds = {verb: (_kind(verb, ["--help"]), _kind(verb, ["--robot", "--help"])) for verb in there}
    names = {verb: set.union(*map(option_names, each)) for verb, each in kinds.items()}
    print(completion(shell, {verb: ABOUT[verb] for verb in there}, names, _named_values()), end="")


def _named_values() -> dict[str, list[str]]:
    """Return word -> the names that may follow it, in the list of words that a shell completes."""
    from evenroad.loading.find import list_robots
    from evenroad.points.samplers import SAMPLERS
    from evenroad.scenes.scene_file import SCENES
    from evenroad.world.gridmap.load import SHIPPED

    robots, worlds = list(list_robots()), [*(f"{name}.yaml" for name in SCENES), *SHIPPED]
    return {"--robot": robots, "robot": robots, "roadmap": robots, "plan": worlds, "--sampler": sorted(SAMPLERS)}


def _installed() -> list[str]:
    """Return the installed verbs, with those of the studies if they are."""
    there = {found.name for found in _entry_points()}
    return [name for name in ABOUT if name in VERBS or name in there]


def _entry_points() -> EntryPoints:
    # Imported late: it takes longer to load than most of evenroad, for verbs of another package.
    from importlib.metadata import entry_points

    return entry_points(group=ENTRY_POINTS)


def _kind_of_studies(verb: str) -> type:
    for found in _entry_points():
        if found.name == verb:
            kind: type = found.load()
            return kind
    raise NotAvailable(
        f"evenroad {verb} comes with the package evenroad-studies, which is not installed:"
        " pip install evenroad-studies, in a clone ./studies"
    )


def _kind(verb: str, words: Sequence[str]) -> type:
    if verb in OF_STUDIES:
        return _kind_of_studies(verb)
    module, _, name = VERBS[verb][0].partition(":")
    home = import_module(module)
    # `plan` has a class for each kind of robot.
    kind: type = home.plan_type(words) if verb == "plan" else getattr(home, name)
    return kind
