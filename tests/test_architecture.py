"""The shape of the package: who may import whom, and how long a module may be."""

import ast
import re
import subprocess
import sys
import tomllib
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import evenroad
from evenroad.cli.verbs import ENTRY_POINTS, OF_STUDIES
from evenroad.points.bank import TRAINED_FAMILIES
from evenroad.points.bank.bank import MAKERS

ROOT = Path(evenroad.__file__).parent

BASE = {
    *("errors", "_arrays", "_call", "_checks", "_files", "_fingerprint", "_hints", "_lazy"),
    *("_native", "_npz", "_rng", "_rows", "_seal", "_shared", "_terminal", "_threads", "_time_limit", "_understood"),
    *("_yaml", "_yaml_values"),
}
VALUES = ["points", "space", "geometry", "world"]
OF_ARMS = ["robots", "loading", "scenes", "collision", "poses", "infeasibility"]
"""Each may import those before it."""
MAY_IMPORT = {
    "points": BASE,
    "space": BASE,
    "spaces": BASE | {"space"},
    "geometry": BASE,
    "world": BASE | {"space", "geometry"},
    "driving": BASE | {"space", "world"},
    "flight": BASE | {"space", "geometry", "world", "scenes"},
    **{part: BASE | {*VALUES, *OF_ARMS[:i]} for i, part in enumerate(OF_ARMS)},
    "robot": BASE | {"geometry", *OF_ARMS},
    "constraints": BASE | {*VALUES, *OF_ARMS},
    "saved": BASE | {"space", "geometry", "world", *OF_ARMS, "driving", "flight", "constraints"},
    "roadmap": BASE | {"points", "space", "world"},
    "planning": BASE | {"saved", *VALUES, *OF_ARMS, "driving", "flight", "constraints", "roadmap"},
    "trajectory": BASE | {"saved", "space", "geometry", "world", "driving", "flight", *OF_ARMS, "constraints"},
    "certificates": BASE | {*VALUES, *OF_ARMS, "constraints", "trajectory"},
    "task": BASE | {"io", "saved", *VALUES, *OF_ARMS, "constraints", "roadmap", "planning", "trajectory"},
    "datasets": BASE | {*VALUES, *OF_ARMS, "roadmap", "planning", "trajectory"},
    "qmc": BASE | {"points"},
    "_load": BASE
    | {*VALUES, "driving", "flight", "loading", "scenes", "roadmap", "planning", "trajectory", "task", "io"},
    "io": BASE | {"saved", *VALUES, *OF_ARMS, "roadmap", "planning", "trajectory"},
    "testing": BASE | {"space", "world"},
    "viz": BASE
    | {*VALUES, *OF_ARMS, "driving", "flight", "constraints", "roadmap", "planning", "trajectory", "task", "_load"},
    "adapters": BASE | {*VALUES, *OF_ARMS, "roadmap", "planning", "trajectory", "task"},
    "ros2": BASE | {*VALUES, *OF_ARMS, "driving", "planning", "trajectory"},
    "cli": BASE
    | {*VALUES, *OF_ARMS, "constraints", "roadmap", "planning", "trajectory", "task", "datasets", "io", "viz"}
    | {"certificates", "driving", "flight", "ros2", "saved"},
    **dict.fromkeys(BASE, BASE),
}
"""Part -> the parts it may import: the arrows of docs/design.md."""

MODULES = sorted(ROOT.rglob("*.py"))
TYPES = "for type checkers"


UPWARD = {
    ("collision.arm_world", "ArmWorld.apart"): {"infeasibility.proof"},
    ("planning.result", "PlanResult.certify"): {"certificates.certify", "certificates.no_path"},
    ("planning.result", TYPES): {"trajectory"},
    ("planning.result", "PlanResult.save"): {"io"},
    ("planning.result", "PlanResult.load"): {"io"},
    ("planning.result", "PlanResult.plot"): {"viz.result"},
    ("planning.result", "PlanResult.trajectory"): {"trajectory.of_plan"},
    ("points.pointset", "PointSet.plot"): {"viz.points"},
    ("driving.polygon_map", "PolygonMap.world"): {"driving.car_world"},
    ("driving.polygon_map", TYPES): {"driving.car_world"},
    ("points.pointset", "PointSet.save"): {"points.npz"},
    ("roadmap.roadmap", "Roadmap.save"): {"roadmap.npz"},
    ("roadmap.roadmap", "Roadmap.within"): {"planning.world_roadmap"},
    ("roadmap.roadmap", TYPES): {"planning.world_roadmap"},
    ("robots.robot", "Robot.configuration"): {"scenes.states"},
    ("robots.robot", "Robot.fk"): {"poses.robot_queries"},
    ("robots.robot", "Robot.ik"): {"poses.robot_queries"},
    ("robots.robot", "Robot.jacobian"): {"poses.robot_queries"},
    ("robots.robot", "Robot.random"): {"poses.robot_queries"},
    ("robots.robot", "Robot.with_padding"): {"loading.padding"},
    ("robots.robot", "Robot.with_tool"): {"robots.tool"},
    ("robots.robot", TYPES): {"poses.pose_goal", "scenes.scene"},
    ("scenes.scene", "Scene.__init__"): {"scenes.scene_file"},
    ("scenes.scene", "Scene.save"): {"scenes.written"},
    ("task.result", "TaskResult.plot"): {"viz.result"},
    ("task.result", "TaskResult.save"): {"task.save"},
    ("task.task", "Task.plan"): {"task.solve"},
    ("trajectory.car_states", "CarTrajectory.save"): {"trajectory.formats"},
    ("trajectory.trajectory", "Trajectory.save"): {"trajectory.formats"},
    ("trajectory.trajectory", "Trajectory.to_ros"): {"ros2.messages", "trajectory.formats"},
    ("world.gridmap.gridmap", "GridMap.plot"): {"viz.result"},
    ("world.gridmap.gridmap", "GridMap.world"): {
        *("driving.car_world", "driving.footprint", "world.gridmap.disk_world"),
    },
    ("world.gridmap.gridmap", TYPES): {
        *("driving.car_world", "driving.footprint", "world.gridmap.disk_world"),
    },
}
"""Module and method -> modules above it that the method imports: values have methods for what users type most."""


def _name_of(path):
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def _imports(path):
    """Yield each import of a file within evenroad as (method, module, name): the method that it stands in, if any."""

    def within(node, method):
        for child in ast.iter_child_nodes(node):
            inner = method
            if isinstance(child, ast.FunctionDef) and isinstance(node, ast.ClassDef):
                inner = f"{node.name}.{child.name}"
            elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
                inner = TYPES
            if isinstance(child, ast.Import):
                yield from ((inner, alias.name, "") for alias in child.names)
            elif isinstance(child, ast.ImportFrom):
                assert child.level == 0, f"{path}: imports are absolute"
                yield from ((inner, child.module, alias.name) for alias in child.names)
            yield from within(child, inner)

    for method, module, name in within(ast.parse(path.read_text()), ""):
        top, _, rest = module.partition(".")
        if top == "evenroad":
            yield method, rest, name


def _imported_modules(path, known):
    """Yield (method, module) for the modules of `known` that a file imports, also in functions."""
    for method, module, name in _imports(path):
        # What a package hands on is imported from the package; a submodule is a module of its own.
        inner = f"{module}.{name}".strip(".")
        found = inner if inner in known else module
        if found in known:
            yield method, found


def test_imports_go_in_one_direction():
    known = {_name_of(path) for path in MODULES} | BASE
    against = []
    for path in MODULES:
        name = _name_of(path)
        part = name.partition(".")[0]
        if part in ("__init__", "__main__"):
            continue
        assert part in MAY_IMPORT, f"{part} is new: give it a place in MAY_IMPORT and docs/design.md"
        for method, other in _imported_modules(path, known):
            parts = {part} | MAY_IMPORT[part]
            if other.partition(".")[0] not in parts and other not in UPWARD.get((name, method), ()):
                against.append(f"{name} imports {other}")
    assert against == []


def test_no_modules_import_each_other_in_a_circle():
    # What a package hands on stands in its stub.  The package itself takes its names when they are asked for.
    paths = {_name_of(path): stub if (stub := path.with_suffix(".pyi")).exists() else path for path in MODULES}
    del paths["__init__"]
    imports = {
        name: sorted(
            {other for method, other in _imported_modules(path, paths) if other not in UPWARD.get((name, method), ())}
            - {name}
        )
        for name, path in paths.items()
    }
    # Raises CycleError, which names one.
    TopologicalSorter(imports).prepare()


def test_every_method_that_imports_upward_still_does():
    listed = {(name, method, other) for (name, method), others in UPWARD.items() for other in others}
    known = {_name_of(path) for path in MODULES}
    there = {(_name_of(path), *found) for path in MODULES for found in _imported_modules(path, known)}
    assert listed <= there


def test_nobody_imports_the_adapters():
    assert [part for part, others in MAY_IMPORT.items() if "adapters" in others] == []


def test_evenroad_imports_nothing_of_the_studies_and_knows_their_verbs_and_network_by_entry_points():
    importing = [path for path in MODULES if "import evenroad_studies" in path.read_text()]
    importing += [path for path in MODULES if "from evenroad_studies" in path.read_text()]
    assert importing == []
    settings = tomllib.loads((ROOT.parents[1] / "studies" / "pyproject.toml").read_text(encoding="utf-8"))
    assert set(settings["project"]["entry-points"][ENTRY_POINTS]) == set(OF_STUDIES)
    assert set(settings["project"]["entry-points"][MAKERS]) < set(TRAINED_FAMILIES)


def test_files_are_at_most_350_lines_or_500_around_a_class():
    def most(path):
        classes = any(isinstance(node, ast.ClassDef) for node in ast.parse(path.read_text()).body)
        return 500 if classes and ROOT in path.parents else 350

    paths = [*MODULES, *(ROOT.parents[1] / "tests").rglob("*.py")]
    assert [path for path in paths if len(path.read_text().splitlines()) > most(path)] == []


def test_functions_are_at_most_60_lines_and_take_at_most_8_arguments():
    long, wide = [], []
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef):
                body = node.body[1:] if ast.get_docstring(node) else node.body
                long += [f"{_name_of(path)}.{node.name}"] if body and node.end_lineno - body[0].lineno >= 60 else []
                arguments = len(node.args.posonlyargs) + len(node.args.args) + len(node.args.kwonlyargs)
                wide += [f"{_name_of(path)}.{node.name}"] if arguments > 8 else []
    # What people type most has everything by keyword.
    assert (long, wide) == ([], ["planning.plan.plan"])


def test_test_modules_import_helpers_and_not_each_other():
    imports = re.compile(r"^\s*(?:from|import) .*\btest_\w+", flags=re.MULTILINE)
    folders = [path for name in ("tests", "tests_peers", "studies") for path in (ROOT.parents[1] / name).rglob("*.py")]
    assert [path for path in folders if imports.search(path.read_text())] == []


def test_nothing_takes_numba():
    imports = re.compile(r"^\s*(?:from|import) (?:numba|llvmlite)\b", flags=re.MULTILINE)
    folders = [path for name in ("src", "tests", "studies") for path in (ROOT.parents[1] / name).rglob("*.py")]
    assert [path for path in folders if imports.search(path.read_text())] == []


def test_importing_evenroad_loads_nothing_heavy():
    heavy = {"numpy", "scipy", "matplotlib", "torch", "PIL"}
    code = f"import sys, evenroad; print(sorted({heavy!r} & set(sys.modules)))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == "[]"


def test_every_public_name_can_be_loaded_and_all_fit_in_a_head():
    for name in evenroad.__all__:
        assert getattr(evenroad, name) is not None
    assert len(set(evenroad.__all__) - {"__version__"}) <= 47


def test_the_stub_says_where_every_public_name_is_and_nothing_else():
    """What type checkers read is what is loaded: the package itself takes its names from the stub."""
    stub = ast.parse((ROOT / "__init__.pyi").read_text())
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    for node in imports:
        (alias,) = node.names
        assert alias.name == alias.asname, "X as X is what makes a name public to a type checker"
        if node.module != "evenroad":
            assert getattr(evenroad, alias.name) is getattr(sys.modules[node.module], alias.name)
    assert {"__version__", *(node.names[0].name for node in imports)} == set(evenroad.__all__)
    assert len(stub.body) == len(imports) + 1


def test_an_unknown_public_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="nonsense"):
        _ = evenroad.nonsense


def test_planning_on_a_shipped_set_does_not_wait_for_scipy_stats():
    code = "import sys, evenroad.viz.plan, evenroad.cli.plan_disk; print('scipy.stats' in sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == "False"
