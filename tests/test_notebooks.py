"""The notebooks run, cell by cell, in an empty folder; what a cell shows is kept in its file."""

import json
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "docs" / "notebooks"


def _notebook(name):
    return json.loads((FOLDER / f"{name}.ipynb").read_text())


def _code(book):
    return ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]


@pytest.mark.parametrize("name", ["arm", "benchmark", "map", "points"])
def test_the_notebook_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {"__name__": name}
    for number, code in enumerate(_code(_notebook(name)), start=1):
        # A world is smaller here: fewer runs say as much about whether the code runs.
        smaller = code.replace("range(5)", "range(1)").replace("load_maze(2), 20", "load_maze(2), 2")
        exec(compile(smaller, f"{name}, cell {number}", "exec"), names)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_is_small_and_was_run_without_an_error(path):
    book = json.loads(path.read_text())
    outputs = [output for cell in book["cells"] for output in cell.get("outputs", [])]
    assert book["nbformat"] == 4
    assert outputs
    assert all(output["output_type"] != "error" for output in outputs)
    assert path.stat().st_size < 250_000
