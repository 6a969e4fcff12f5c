"""Files that commands write, and files that they read."""

import pytest

from evenroad.cli import main

COMMANDS = {
    "robot arm.urdf --write-srdf arm.urdf": "--write-srdf would overwrite the file arm.urdf",
    "robot arm.urdf --srdf arm.srdf --write-srdf ./arm.srdf": "--write-srdf would overwrite the file arm.srdf",
    "certify-path path.csv --robot ur5 --certificate path.csv": "--certificate would overwrite the file path.csv",
    "run task.yaml --certificate task.yaml": "--certificate would overwrite the file task.yaml",
    "run task.yaml --srdf arm.srdf -o arm.json -o task.yaml": "--out would overwrite the file task.yaml",
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_that_is_read_is_not_overwritten(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = ("arm.urdf", "arm.srdf", "path.csv", "task.yaml")
    for name in names:
        (tmp_path / name).write_text(name)
    assert main(command.split()) == 2
    assert COMMANDS[command] in capsys.readouterr().err
    assert [(tmp_path / name).read_text() for name in names] == [*names]
