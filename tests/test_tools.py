"""Tests of the scripts in tools/."""

import importlib.util
import os
from pathlib import Path

import pytest

TOOLS = Path(__file__).parent.parent / "tools"


@pytest.fixture
def stale(monkeypatch, tmp_path):
    """The script, looking at sources of our own: `caller` imports `callee`, which imports `constants`."""
    spec = importlib.util.spec_from_file_location("forget_stale_kernels", TOOLS / "forget_stale_kernels.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    monkeypatch.setattr(script, "SOURCES", tmp_path)
    package = tmp_path / "evenroad"
    (package / "__pycache__").mkdir(parents=True)
    (package / "constants.py").write_text("TWO = 2\n")
    (package / "callee.py").write_text("from evenroad import constants\n")
    (package / "caller.py").write_text("import math\n\nfrom evenroad.callee import twice\n")
    for name in ("caller.f-3.py311.nbi", "caller.f-3.py311.1.nbc"):
        (package / "__pycache__" / name).write_text("compiled")
    for file in package.rglob("*.*"):
        os.utime(file, (1000, 1000))
    return script, package


def test_compiled_code_is_kept_while_nothing_it_calls_is_newer(stale):
    script, package = stale
    assert script.forget_stale_kernels(package.parent) == 0
    assert len(list(package.rglob("__pycache__/*"))) == 2


@pytest.mark.parametrize("edited", ["callee.py", "constants.py"])
def test_compiled_code_goes_when_something_it_calls_is_newer(stale, edited):
    script, package = stale
    os.utime(package / edited, (2000, 2000))
    assert script.forget_stale_kernels(package.parent) == 1
    assert list(package.rglob("__pycache__/*")) == []


def test_numba_itself_looks_at_the_file_of_the_function(stale):
    script, package = stale
    os.utime(package / "caller.py", (2000, 2000))
    assert script.forget_stale_kernels(package.parent) == 0
