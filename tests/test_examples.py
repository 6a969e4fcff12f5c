"""What the README and the examples show is run here, word for word."""

import re
import runpy
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from evenroad.cli import main
from evenroad.research.mazes import load_maze

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def _blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


@pytest.fixture(autouse=True)
def _maps_of_the_readme(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(load_maze(3).path, "maze.png")
    Image.fromarray(np.full((200, 200), 254, dtype=np.uint8)).save("office.pgm")
    Path("office.yaml").write_text(
        "image: office.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )


def test_the_readmes_python_runs_and_is_five_lines_long(capsys):
    (code,) = _blocks("python")
    assert len([line for line in code.splitlines() if line.strip()]) <= 5
    exec(compile(code, "README.md", "exec"), {})
    assert "solved" in capsys.readouterr().out
    assert Path("plan.png").exists()


def test_the_readmes_commands_are_understood():
    commands = [
        line for block in _blocks("sh") for line in block.splitlines() if line.startswith("evenroad ")
    ]
    assert len(commands) >= 2
    for command in commands:
        # A maze that these few points do not solve is an answer (1); a misspelt option would be 2.
        assert main(shlex.split(command, comments=True)[1:]) in (0, 1)


def test_the_readmes_make_targets_exist():
    targets = {
        line.split(":")[0] for line in (ROOT / "Makefile").read_text().splitlines() if re.match(r"\w+:", line)
    }
    assert set(re.findall(r"^make (\w+)", README, flags=re.MULTILINE)) <= targets


def test_links_of_the_readme_and_the_docs_lead_somewhere():
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_the_example_runs(path, capsys):
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out


def test_prose_of_the_documents_is_at_most_120_characters_wide():
    too_wide = []
    for path in [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]:
        in_code = False
        for number, line in enumerate(path.read_text().splitlines(), start=1):
            in_code ^= line.startswith("```")
            # What a terminal printed is shown as it was, and tables cannot be wrapped.
            if len(line) > 120 and not in_code and not line.startswith("|"):
                too_wide.append(f"{path.name}:{number}")
    assert too_wide == []
