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
    *("errors", "_above", "_arrays", "_call", "_checks", "_files", "_fingerprint", "_lazy"),
    *("_native", "_npz", "_rng", "_seal", "_shared", "_terminal", "_threads", "_yaml"),
}
MAY_IMPORT = {
    "points": BASE,
    "space": BASE,
    "spaces": BASE | {"space"},
    "geometry": BASE,
    "world": BASE | {"space", "geometry"},
    "roadmap": BASE | {"points", "space", "world"},
    "qmc": BASE | {"points"},
    "constraints": BASE | {"space", "geometry", "world", "robot"},
    "planning": BASE | {"points", "space", "geometry", "world", "robot", "roadmap", "constraints"},
    "io": BASE | {"points", "space", "world", "geometry", "robot", "roadmap"},
    "testing": BASE | {"space", "world"},
    "viz": BASE | {"points", "space", "world", "geometry", "robot", "roadmap", "planning", "constraints"},
    "robot": BASE | {"space", "geometry", "world"},
    "robot_roadmap": BASE | {"points", "space", "geometry", "world", "robot", "roadmap", "planning"},
    "trajectory": BASE | {"space", "world", "robot", "constraints"},
    "task": BASE | {"space", "geometry", "world", "robot", "roadmap", "planning", "trajectory", "constraints"},
    "adapters": BASE | {"points", "space", "geometry", "world", "robot", "roadmap", "planning", "trajectory"},
    "cli": BASE
    | {"points", "space", "world", "geometry", "robot", "roadmap", "robot_roadmap"}
    | {"planning", "io", "viz", "trajectory", "task", "constraints"},
    **dict.fromkeys(BASE, BASE),
}
"""Part -> the parts it may import: the arrows of docs/design.md."""

MODULES = sorted(ROOT.rglob("*.py"))


def _imported_parts(path):
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            names = (
                [f"{node.module}.{alias.name}" for alias in node.names] if node.module == "evenroad" else [node.module]
            )
        for name in names:
            top, _, rest = name.partition(".")
            if top == "evenroad" and rest and rest != "__version__":
                yield rest.partition(".")[0]


def test_imports_go_in_one_direction():
    against = []
    for path in MODULES:
        part = path.relative_to(ROOT).parts[0].removesuffix(".py")
        if part == "__init__" or part == "__main__":
            continue
        assert part in MAY_IMPORT, f"{part} is new: give it a place in MAY_IMPORT and docs/design.md"
        against += [
            f"{path.relative_to(ROOT)} imports {other}"
            for other in sorted(set(_imported_parts(path)) - {part} - MAY_IMPORT[part])
        ]
    assert against == []


def _imported_modules(path, known):
    """Yield the modules of `known` that a file imports anywhere, also in functions and for type checkers alone."""
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            # What a package hands on is imported from the package; a submodule is a module of its own.
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [name if name in known else node.module for name in inner]
        yield from (name for name in names if name in known)


def test_no_modules_import_each_other_in_a_circle():
    names = {}
    for path in MODULES:
        parts = ("evenroad", *path.relative_to(ROOT).with_suffix("").parts)
        # What a package hands on stands in its stub.
        path = stub if (stub := path.with_suffix(".pyi")).exists() else path
        names[".".join(parts).removesuffix(".__init__")] = path
    # The package itself is imported for its version alone, and takes its names when they are asked for.
    del names["evenroad"]
    imports = {name: sorted(set(_imported_modules(path, names)) - {name}) for name, path in names.items()}
    # Raises CycleError, which names one.
    TopologicalSorter(imports).prepare()


def test_nobody_imports_the_adapters():
    assert [part for part, others in MAY_IMPORT.items() if "adapters" in others] == []


def test_evenroad_imports_nothing_of_the_studies_and_knows_their_verbs_and_network_by_entry_points():
    importing = [path for path in MODULES if "import evenroad_studies" in path.read_text()]
    importing += [path for path in MODULES if "from evenroad_studies" in path.read_text()]
    assert importing == []
    settings = tomllib.loads((ROOT.parents[1] / "studies" / "pyproject.toml").read_text(encoding="utf-8"))
    assert set(settings["project"]["entry-points"][ENTRY_POINTS]) == set(OF_STUDIES)
    assert set(settings["project"]["entry-points"][MAKERS]) < set(TRAINED_FAMILIES)


def test_no_module_is_longer_than_400_lines_and_none_of_tests_than_350():
    both = [(path, 400) for path in MODULES] + [(path, 350) for path in (ROOT.parents[1] / "tests").rglob("*.py")]
    assert [path for path, most in both if len(path.read_text().splitlines()) > most] == []


def test_test_modules_import_helpers_and_not_each_other():
    imports = re.compile(r"^\s*(?:from|import) .*\btest_\w+", flags=re.MULTILINE)
    folders = [path for name in ("tests", "tests_peers", "studies") for path in (ROOT.parents[1] / name).rglob("*.py")]
    assert [path for path in folders if imports.search(path.read_text())] == []


def test_no_module_takes_numba():
    assert [path for path in MODULES if "numba" in path.read_text()] == []


def test_importing_evenroad_loads_nothing_heavy():
    heavy = {"numpy", "numba", "scipy", "matplotlib", "torch", "PIL"}
    code = f"import sys, evenroad; print(sorted({heavy!r} & set(sys.modules)))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == "[]"


def test_every_public_name_can_be_loaded_and_all_fit_in_a_head():
    for name in evenroad.__all__:
        assert getattr(evenroad, name) is not None
    assert len(set(evenroad.__all__) - {"__version__"}) <= 40


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


def test_methods_of_values_name_functions_that_are_there():
    from evenroad._above import FUNCTIONS, above

    assert all(callable(above(method)) for method in FUNCTIONS)
