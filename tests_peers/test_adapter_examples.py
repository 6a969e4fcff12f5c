"""The examples of the adapters run, each in a folder and a process of its own, and say what they should."""

import subprocess
import sys

import pytest
from tools import run_examples

EXAMPLES = {path.name: path for path in run_examples.EXAMPLES}


@pytest.mark.parametrize(("name", "package"), [("09_with_ompl.py", "ompl"), ("10_with_klampt.py", "klampt")])
def test_an_example_prints_what_its_page_shows_and_leaves_nothing(tmp_path, name, package):
    pytest.importorskip(package)
    done = subprocess.run([sys.executable, EXAMPLES[name]], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert run_examples.words(done.stdout) == run_examples.shown(EXAMPLES[name]), run_examples.ANEW
    assert ": no path" not in done.stdout
    assert "proof: resolution" in done.stdout
    assert list(tmp_path.iterdir()) == []
