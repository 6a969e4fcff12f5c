"""Fixtures of tests that type commands."""

import signal

import pytest

from evenroad.cli import main


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
        said = [
            line
            for line in captured.err.splitlines(keepends=True)
            if "compiling for this machine" not in line
        ]
        return code, captured.out, "".join(said)

    return run


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
