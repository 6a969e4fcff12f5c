"""Whatever the native kernel is given, it answers or refuses: it reads nothing outside, does not crash, and ends.

Every class, method, function and property of the stubs `_native/*.pyi` is called, so a new one is covered by itself.
Arguments are random, or mutants of what the package itself passes.  A refusal says what is wrong, and that is mended
until the kernel takes the arguments: only then are its loops tried.  `make test` runs this under sanitizers, too;
`make fuzz` does so for long.
"""

import ast
import faulthandler
import os
import re
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from evenroad import _native
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.planning import plan_many
from evenroad.planning.connectors import ARM_TREES
from evenroad.robot import ArmWorld, load_robot
from evenroad.scenes.scene import Scene
from evenroad.world.gridmap.gridmap import GridMap
from tests.robots.kernel_arms import random_scene
from tests.robots.mesh_arms import write_fork_arm
from tests.robots.paths import GOAL, START, box_world

ROUNDS = int(os.environ.get("EVENROAD_FUZZ", "12"))
"""How often each function is tried with each seed."""
MENDED = 14
"""How often the arguments of one call are mended."""
SECONDS = 60
"""A call that takes longer hangs."""

TYPES = {"Floats": "float64", "Ints": "int64", "Ints32": "int32", "Bools": "bool", "States": "int8", "Int8s": "int8"}
WILD = {
    "f": (0.0, 1.0, -1.0, 0.5, np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-300, 1e18),
    "i": (0, 1, 2, 3, 7, -1, 100, 2**31 - 1, -(2**31), 2**62, -(2**63)),
    "b": (False, True),
}

COUNTS = (100, -1, 2**62, -(2**63))
"""None between: so much memory, or so many motions, may be asked for, but not by a test."""


@dataclass(frozen=True)
class Callable:
    """What the stubs say of something that is called: its place, e.g. roadmap.Graph.with_links, and its arguments."""

    name: str
    owner: str
    arguments: tuple[ast.expr, ...]
    is_property: bool = False

    @property
    def makes(self) -> str:
        """The class that the call makes an instance of, or nothing."""
        return self.owner if self.name.endswith(".__init__") else ""


def callables():
    """All that the stubs declare, but the time limit: it would end all calls after it."""
    for stub in sorted(Path(_native.__file__).parent.glob("[!_]*.pyi")):
        if stub.stem == "time_limit":
            continue
        for node in ast.parse(stub.read_text()).body:
            if isinstance(node, ast.FunctionDef):
                yield Callable(f"{stub.stem}.{node.name}", "", tuple(each.annotation for each in node.args.args))
            elif isinstance(node, ast.ClassDef):
                yield from members(f"{stub.stem}.{node.name}", node)


def members(of, node):
    """All that a class of a stub declares."""
    for each in node.body:
        if isinstance(each, ast.AnnAssign):
            yield Callable(f"{of}.{each.target.id}", of, (), is_property=True)
        elif isinstance(each, ast.FunctionDef):
            marks = {mark.id for mark in each.decorator_list}
            of_class = "staticmethod" in marks
            arguments = each.args.args[0 if of_class else 1 :]
            annotations = tuple(argument.annotation for argument in arguments)
            yield Callable(f"{of}.{each.name}", "" if of_class else of, annotations, is_property="property" in marks)


CALLABLES = tuple(callables())
CLASSES = list(dict.fromkeys(each.owner for each in CALLABLES if each.owner))


@dataclass
class Leaf:
    """An array among the arguments, which is mended in place."""

    array: np.ndarray


def filled(given, change):
    """The same arguments with each leaf, or array, changed."""
    if isinstance(given, Leaf | np.ndarray):
        return change(given)
    if isinstance(given, dict):
        return {key: filled(value, change) for key, value in given.items()}
    if isinstance(given, list | tuple):
        return type(given)(filled(value, change) for value in given)
    return given


class Fuzzer:
    """Calls what the stubs declare, and keeps what was made for the calls that follow."""

    def __init__(self, seed, recorded):
        self.rng = np.random.default_rng(seed)
        self.recorded = recorded
        self.made = defaultdict(list)
        for name, calls in recorded.items():
            for arguments in calls:
                made = place_of(name)(*arguments)
                self.made[self.class_of(made)].append(made)
        self.accepted = set()
        self.sizes = (1,)

    def pick(self, choices):
        return choices[self.rng.integers(len(choices))]

    def array(self, kind, axes):
        """Entries of one kind: all of them tame, or some of them wild."""
        shape = tuple(int(self.pick(self.sizes)) for _ in range(axes))
        kind = np.dtype(kind)
        tame = self.rng.random(shape) if kind.kind == "f" else self.rng.integers(0, 2, shape)
        made = tame.astype(kind)
        return self.mutated(made) if self.rng.random() < 0.3 else made

    def mutated(self, array):
        """A copy with one to three other entries, of another shape, or not contiguous."""
        array = array.copy()
        change = self.rng.random()
        if change < 0.8 and array.size:
            limits = np.iinfo(array.dtype) if array.dtype.kind == "i" else None
            for _ in range(self.rng.integers(1, 4)):
                value = self.pick(WILD["i" if array.dtype.kind == "u" else array.dtype.kind])
                if limits:
                    value = min(max(value, limits.min), limits.max)
                array.flat[self.rng.integers(array.size)] = value % 256 if array.dtype.kind == "u" else value
            return array
        if change < 0.9 and array.ndim:
            axis = self.rng.integers(array.ndim)
            return np.repeat(array, 2, axis=axis) if self.rng.random() < 0.5 else np.delete(array, slice(1), axis)
        return array[..., ::2] if array.ndim else array

    def drawn(self, part, annotation):
        """A value of the annotated type, now and then of another one."""
        if isinstance(annotation, ast.BinOp):
            return self.drawn(part, self.pick((annotation.left, annotation.right)))
        if isinstance(annotation, ast.Subscript):
            return self.several(part, annotation.value.id, annotation.slice)
        name = ast.unparse(annotation)
        if name in TYPES or name == "object":
            return Leaf(self.array(TYPES.get(name, "float64"), self.rng.integers(1, 3)))
        if name == "bool":
            return bool(self.rng.random() < 0.5)
        if name in ("int", "float"):
            tame, wild = (int(self.rng.integers(4)), COUNTS) if name == "int" else (self.rng.random(), WILD["f"])
            return self.pick(wild) if self.rng.random() < 0.3 else tame
        owner = next((each for each in CLASSES if each.endswith(f".{name}")), "")
        if name in ("None", "Arrays") or not self.made[owner] or self.rng.random() < 0.03:
            return {} if name == "Arrays" else None
        return self.pick(self.made[owner])

    def several(self, part, kind, parts):
        """A tuple, a list or a dictionary."""
        if kind == "Mapping":
            return {}
        if kind == "Literal":
            return ast.literal_eval(self.pick(parts.elts))
        if kind == "tuple" and not isinstance(parts.elts[-1], ast.Constant):
            values = tuple(self.drawn(part, each) for each in parts.elts)
            return values[:-1] if self.rng.random() < 0.02 else values
        each = parts.elts[0] if kind == "tuple" else parts
        values = [self.drawn(part, each) for _ in range(self.rng.integers(4))]
        return tuple(values) if kind == "tuple" else values

    def arguments(self, called):
        """Random ones, or mutants of those with which the package called."""
        known = self.recorded.get(called.makes or called.name)
        if not known:
            return [self.drawn(called.name.split(".")[0], each) for each in called.arguments]
        share = self.pick((0.0, 0.05, 0.3))
        change = lambda array: Leaf(self.mutated(array) if self.rng.random() < share else array.copy())  # noqa: E731
        given = list(filled(self.pick(known), change))
        for i, annotation in enumerate(called.arguments):
            if self.rng.random() < 0.2 and ast.unparse(annotation) not in ("Arrays", "Mapping[str, object]"):
                given[i] = self.drawn(called.name.split(".")[0], annotation)
        return given

    def call(self, called):
        """Call with random arguments until they are taken, or mending does not help."""
        self.sizes = self.rng.choice(9, self.pick((1, 1, 2, 3)))
        target = place_of(called.owner if called.owner else called.name)
        owner = self.pick(self.made[called.owner]) if called.owner and not called.makes else None
        if called.is_property:
            getattr(owner, called.name.rpartition(".")[2])
            self.accepted.add(called.name)
            return
        if owner is not None:
            target = getattr(owner, called.name.rpartition(".")[2])
        given = self.arguments(called)
        for _ in range(MENDED):
            leaves = []
            filled(given, leaves.append)
            try:
                result = target(*filled(given, lambda leaf: leaf.array))
            except InvalidValue as error:
                self.mend(str(error), leaves)
            except TypeError as error:
                # Another class, or a number that its C++ type does not hold; nanobind refuses that.
                if "incompatible function arguments" not in str(error):
                    raise
                return
            else:
                self.accepted.add(called.name)
                self.keep(called.makes or self.class_of(result), result)
                return

    def class_of(self, result):
        kind = type(result)
        return f"{kind.__module__.rpartition('.')[2]}.{kind.__name__}"

    def keep(self, name, made):
        if name in CLASSES:
            kept = self.made[name]
            kept.append(made)
            if len(kept) > 12:
                # What the package made stays.
                del kept[self.rng.integers(len(self.recorded.get(name, ())), len(kept))]

    def mend(self, text, leaves):
        """Do what a refusal asks for."""
        if not leaves:
            return
        leaf = self.pick(leaves)
        if found := re.search(r"array of (\w+) with (\d) ax\w+, got an array of (\w+), shape (\(.*\))$", text):
            kind, axes, *got = found.groups()
            alike = [each for each in leaves if [str(each.array.dtype), str(each.array.shape)] == got]
            self.pick(alike or leaves).array = self.array(kind, int(axes))
        elif found := re.search(r"must have shape (\(.*?\)), got (\(.*?\))$", text):
            wanted, got = map(ast.literal_eval, found.groups())
            leaf = self.pick([each for each in leaves if each.array.shape == got] or leaves)
            leaf.array = np.resize(leaf.array, wanted)
        elif found := re.search(r" must be (\d+) or more, got (\d+)$", text):
            wanted, got = map(int, found.groups())
            leaf = self.pick([each for each in leaves if each.array.shape == (got,)] or leaves)
            leaf.array = np.resize(leaf.array, wanted)
        elif found := re.search(r"must be .*?below (\d+), got (-?\d+)$", text):
            limit, got = map(int, found.groups())
            for leaf in leaves:
                if limit and leaf.array.dtype.kind == "i" and (leaf.array == got).any():
                    leaf.array = leaf.array % min(limit, 127)
        else:
            leaf.array = np.sort(self.array(leaf.array.dtype, leaf.array.ndim), axis=-1)


def place_of(name):
    """What stands at a place of the kernel."""
    found = _native.kernel
    for part in name.split("."):
        found = getattr(found, part)
    return found


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """With what the package makes a robot, surfaces, a scene, a disk and a car, answers a query, improves a path."""
    calls = defaultdict(list)
    with pytest.MonkeyPatch.context() as patch:
        for name in ("Robot", "Surface", "Scene"):
            patch.setattr(_native.robot, name, recording(f"robot.{name}", calls))
        for name in ("Improver", "Trees"):
            patch.setattr(_native.planning, name, recording(f"planning.{name}", calls))
        patch.setattr("evenroad.planning.drivers.Drivers", recording("planning.Drivers", calls))
        patch.setattr("evenroad.world.gridmap.disk_world.Disk", recording("world.Disk", calls))
        for name, of in (("Footprint", "footprint.Native"), ("Steering", "car_space."), ("Vehicle", "car_world.")):
            patch.setattr(f"evenroad.driving.{of}{name}", recording(f"drive.{name}", calls))
        patch.setattr("evenroad.collision.arm_world.Checker", recording("robot.Checker", calls))
        patch.setattr("evenroad.planning.connectors.answer", recording("planning.answer", calls))
        patch.setattr("evenroad.planning.many.ManyQueries", recording("planning.ManyQueries", calls))
        robot = load_robot(write_fork_arm(tmp_path_factory.mktemp("fork")))
        rng = np.random.default_rng(4)
        cloud = PointCloud(rng.random((40, 3)), 0.01)
        mesh = Mesh((rng.random((20, 3)), rng.permuted(np.tile(np.arange(20), (9, 1)), axis=1)[:, :3]))
        scene = random_scene(3)
        ArmWorld(robot, Scene((*scene.obstacles, cloud, mesh))).valid(np.zeros(3))
        ends = np.stack([START, GOAL])
        first = np.stack([START, START + 0.1, GOAL]), 0, 10
        ARM_TREES.improver(box_world(), ends, first, variant=0, is_smoothing=True)
        # Another variant: the sequences of the first may be kept from an earlier test.
        ARM_TREES.answer(box_world(), START, GOAL, variant=1, most_motions=100, search_seconds=1.0, smooth=True)
        ARM_TREES.connect(box_world(), START, GOAL[np.newaxis], variant=0, most_motions=100)
        plan_many(box_world(), [START] * 3, [START, START + 0.1, GOAL], limits={"motions": 50})
        for resolution in (0.1, 0.5):
            GridMap(rng.random((20, 30)) < 0.1, resolution=resolution).world(0.4).valid(np.zeros((1, 2)))
        GridMap(rng.random((20, 30)) < 0.1).world(footprint=[(-1, -1), (2, -1), (0, 2), (-1, 1)], turning_radius=2.0)
    return dict(calls)


def recording(name, calls):
    """A class or function of the kernel that notes with what it is called."""
    made = place_of(name)

    class Recording:
        def __new__(cls, *args, **kwargs):
            calls[name].append((*args, *kwargs.values()))
            return made(*args, **kwargs)

        around, of_cloud = (getattr(made, each, None) for each in ("around", "of_cloud"))

    return Recording


@pytest.mark.parametrize("seed", range(4))
def test_whatever_it_is_given_the_kernel_answers_or_refuses(seed, recorded):
    fuzzer = Fuzzer(seed, recorded)
    for turn in range(ROUNDS + 120):
        # In the end what took nothing is tried until it does.
        left = [each for each in CALLABLES if turn < ROUNDS or each.name not in fuzzer.accepted]
        for called in left:
            if called.owner and not called.makes and not fuzzer.made[called.owner]:
                continue
            if ROUNDS != 12:
                print(called.name, flush=True)
            faulthandler.dump_traceback_later(SECONDS, exit=True)
            fuzzer.call(called)
            faulthandler.cancel_dump_traceback_later()
    assert len(fuzzer.accepted) > 0.8 * len(CALLABLES), sorted({each.name for each in CALLABLES} - fuzzer.accepted)
