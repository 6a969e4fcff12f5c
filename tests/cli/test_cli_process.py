"""The command as a process: how it is started, interrupted, and run where nothing can be kept."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import evenroad

PACKAGE = Path(evenroad.__file__).parent


def python(*arguments, **environment):
    return subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=False, env={**os.environ, **environment}
    )


def test_the_package_can_be_run_as_a_module():
    done = python("-m", "evenroad", "--version")
    assert (done.returncode, done.stdout, done.stderr) == (0, f"evenroad {evenroad.__version__}\n", "")


INTERRUPTED = (130, "evenroad: interrupted; what was finished is kept\n")


@pytest.mark.parametrize("module", ["evenroad.cli.options", "evenroad.cli.verbs", "numpy", "PIL"])
def test_an_interrupt_while_modules_are_imported_exits_with_130_and_one_line(module):
    code = f"""
import sys
class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupt())
sys.argv = ["evenroad", "demo", "-n", "16"]
from evenroad.cli import main
raise SystemExit(main())
"""
    done = python("-c", code)
    assert (done.returncode, done.stderr) == INTERRUPTED


def test_hardly_anything_is_loaded_before_an_interrupt_is_looked_after():
    """What Python itself does before our first line cannot be helped; ours takes a few milliseconds."""
    code = (
        "import sys; before = set(sys.modules); import evenroad.cli;"
        "print(sum('evenroad' not in name for name in set(sys.modules) - before),"
        " {'pathlib', 'dataclasses', 'inspect', 'numpy'} & set(sys.modules))"
    )
    loaded, heavy = python("-S", "-c", code, PYTHONPATH=str(PACKAGE.parent)).stdout.split(maxsplit=1)
    assert int(loaded) < 60
    assert heavy == "set()\n"


def with_verbs_that(run):
    """Run the command with a function in the place of what its verbs do."""
    start = "import ctypes, signal, sys, time\nimport evenroad.cli.verbs\n"
    end = """
evenroad.cli.verbs.run = run
code = evenroad.cli.main()
assert code != 130 or signal.getsignal(signal.SIGINT) == signal.SIG_IGN
raise SystemExit(code)
"""
    return python("-c", start + run + end)


IN_A_CALLBACK = """
def run(arguments):
    ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))()
    {}
"""
IN_CYTHON = """
import numpy.lib._npyio_impl as files
from scipy.stats import qmc
def run(arguments):
    files.NpzFile.__getitem__ = lambda self, key: signal.raise_signal(signal.SIGINT)
    assert (qmc.Sobol(2, scramble=False).random(4) == 0).all()
    while True:
        time.sleep(0.01)
"""
LATE = """
class Late:
    seen = False
    def __call__(self, *what):
        if not self.seen:
            self.seen = True
            raise KeyboardInterrupt
        return set_handler(*what)
def run(arguments):
    signal.signal = Late()
    raise KeyboardInterrupt
set_handler = signal.signal
"""


@pytest.mark.parametrize("run", [
    # Compiled code that calls Python drops what that raises.
    IN_A_CALLBACK.format("while True: time.sleep(0.01)"),
    IN_A_CALLBACK.format("raise RuntimeError('no compiled object yet')"),
    # SciPy's Sobol points come out as zeros after it; Cython prints what it drops.
    IN_CYTHON,
    # A second one while files are closed: the next who looks for signals is the call that turns them off.
    LATE,
], ids=["in a callback", "in a callback that fails", "in Cython", "while leaving"])  # fmt: skip
def test_an_interrupt_that_others_drop_is_not_lost_and_leaves_no_traceback(run):
    done = with_verbs_that(run)
    assert (done.returncode, done.stderr) == INTERRUPTED


def test_an_error_of_our_own_is_never_exit_code_1():
    done = with_verbs_that("def run(arguments):\n    raise KeyError('slip')\n")
    assert done.returncode == 70
    assert done.stderr.startswith("Traceback")
    assert done.stderr.endswith(
        "KeyError: 'slip'\nevenroad: internal error: please report the lines above; this is no answer\n"
    )


def test_a_version_says_what_it_runs_on_and_where_things_are_kept(tmp_path):
    done = python("-m", "evenroad", "--version", "-v", EVENROAD_CACHE=str(tmp_path))
    rows = dict(line.split(maxsplit=1) for line in done.stdout.splitlines()[1:3])
    assert done.stdout.startswith(f"evenroad {evenroad.__version__}\n")
    assert "numpy" in rows["runs"]
    assert str(tmp_path) in done.stdout
    refused = python("-m", "evenroad", "--version", "-x")
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == "evenroad: error: unknown option of --version: '-x'; known: --verbose, -v\n"


ARM = "plan box-reach --robot ur5 --start home --goal inside"
MAP = "plan office.yaml --start 1 2 --goal 8.5 3 --robot-radius 0.25"
HEAVY = {"scipy.linalg", "scipy.ndimage", "scipy.optimize", "scipy.spatial", "scipy.stats", "matplotlib", "trimesh"}


@pytest.mark.parametrize(("words", "unused"), [
    (ARM, {"html", "multiprocessing", "evenroad.world.gridmap.load"}),
    (f"{ARM} --no-picture", {"PIL"}),
    (MAP, {"evenroad.cli.certify", "evenroad.points.samplers.even"}),
], ids=["arm", "arm without a picture", "map"])  # fmt: skip
def test_a_plan_loads_nothing_that_it_does_not_use(words, unused, tmp_path):
    code = f"""
import sys
from evenroad.cli.verbs import run
assert run("{words} --out {tmp_path}/a".split()) == 0
print(sorted({HEAVY | unused!r} & set(sys.modules)))
"""
    assert python("-c", code).stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
def test_output_fits_into_every_encoding(tmp_path, encoding):
    file = tmp_path / "arm.urdf"
    text = (PACKAGE / "loading" / "data" / "ur5.urdf").read_text()
    file.write_text(text.replace("wrist_3_joint", "手首_ž").replace('name="ur5"', 'name="ромашка"'), encoding="utf-8")
    for command in (["robot", str(file)], ["plan", "empty.yaml", "--robot", str(tmp_path / "не.urdf")]):
        given = [sys.executable, "-m", "evenroad", *command]
        done = subprocess.run(given, capture_output=True, env={**os.environ, "PYTHONIOENCODING": encoding}, check=False)
        assert done.returncode == (0 if command[0] == "robot" else 2), done.stderr
        both = (done.stdout + done.stderr).decode(encoding)
        assert ("手首_ž" if encoding == "utf-8" else r"\u624b\u9996") in both or command[0] == "plan"
