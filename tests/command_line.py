"""Fixtures of tests that type commands."""

import json
import shutil
import signal
from pathlib import Path

import pytest

from evenroad.cli import main

CELL = """\
obstacles:
  table: {shape: box, size: [1, 1.2, 0.05], xyz: [0.25, 0, -0.025], cell: true}
allowed:
  table: [base_link, shoulder_link]
"""


@pytest.fixture(scope="session")
def built_roadmap(tmp_path_factory):
    """A roadmap of the UR5, 64 milestones, and a table to plan on; built once."""
    folder = tmp_path_factory.mktemp("roadmap")
    (folder / "cell.yaml").write_text(CELL)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        # What is known of the robot comes along.
        patch.setenv("EVENROAD_CACHE", str(folder / ".cache"))
        assert main(["roadmap", "ur5", "--cell", "box-reach.yaml", "-n", "64", "-o", "my.roadmap"]) == 0
    return folder


@pytest.fixture
def made(built_roadmap, in_an_empty_folder, tmp_path):
    """The test's folder with `cell.yaml` and `my.roadmap` in it."""
    shutil.copytree(built_roadmap, tmp_path, dirs_exist_ok=True)
    return tmp_path


@pytest.fixture
def run(capsys):
    """Run the command line in this process; return exit code, standard output and standard error."""

    def run(*arguments):
        try:
            code = main([str(each) for each in arguments])
        except SystemExit as leave:
            code = leave.code
        captured = capsys.readouterr()
        # Said by whichever test is the first on a machine.
        said = [line for line in captured.err.splitlines(keepends=True) if "compiling for this machine" not in line]
        return code, captured.out, "".join(said)

    return run


@pytest.fixture
def answer(run):
    """Run a plan without a picture; return the record that it wrote and what it said, as one line."""

    def answer(*words, code=0, out="a"):
        found, said, err = run(*words, "--no-picture", "--out", out)
        assert (found, err) == (code, "")
        return json.loads(Path(f"{out}.json").read_text()), " ".join(said.split())

    return answer


@pytest.fixture
def refuse(run):
    """Run what must be refused with exit code 2, in one line, and with nothing written; return the line."""

    def there_is():
        return sorted((path, path.stat().st_mtime_ns) for path in Path.cwd().rglob("*") if ".cache" not in path.parts)

    def refuse(*words):
        before = there_is()
        code, out, err = run(*words)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert err.startswith("evenroad: error: ")
        assert there_is() == before
        return err

    return refuse


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path / ".cache"))


@pytest.fixture(autouse=True)
def ctrl_c_interrupts():
    """Give commands a Ctrl-C, also where the tests themselves run with SIGINT ignored, as `nohup` and `&` have it."""
    before = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
