"""The examples of the adapters run, each in a folder and a process of its own, and say what they should."""

import subprocess
import sys
from pathlib import Path

import pytest
from tools import run_pages

EXAMPLES = Path(__file__).parents[1] / "examples"


def _run(name, folder):
    done = subprocess.run([sys.executable, EXAMPLES / name], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_with_ompl(tmp_path):
    pytest.importorskip("ompl")
    said = _run("09_with_ompl.py", tmp_path)
    assert "RRT-Connect: no path" not in said
    prm = next(line for line in said.splitlines() if line.startswith("OMPL's PRM")).split(":")
    assert prm[1].split(";")[0].strip() == prm[2].strip(), "the same roadmap, so the same length"
    assert "proof: resolution" in said


def test_with_klampt(tmp_path):
    pytest.importorskip("klampt")
    said = _run("10_with_klampt.py", tmp_path)
    assert "even points: no path" not in said
    assert "a RobotTrajectory of" in said


def test_the_page_runs(tmp_path, monkeypatch):
    """Without these wheels ``tests/test_pages.py`` leaves it out."""
    for module in run_pages.NEEDS["adapters.md"]:
        pytest.importorskip(module)
    monkeypatch.chdir(tmp_path)
    ran = [text for block, text in run_pages.run_page(run_pages.ROOT / "docs" / "adapters.md")]
    assert sum("import" in text for text in ran) == 3
