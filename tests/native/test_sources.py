"""Sources of the kernel can be compiled several at a time, as CMakeLists.txt does, whichever stand side by side."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import evenroad

SOURCES = Path(evenroad.__file__).parent / "_native" / "cpp"
HIDDEN = re.compile(r"^namespace \{\n(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
CONSTANTS = re.compile(r"^constexpr [\w:<> ]+? (\w+(?: ?[={][^;]*)?);", re.MULTILINE)
TYPES = re.compile(r"^(?:struct|class|enum class) (\w+)[^;\n]*\{", re.MULTILINE)


def hidden_names(text: str) -> set[str]:
    """Return the constants and types of nameless namespaces."""
    names = set()
    for part in HIDDEN.findall(text):
        names |= set(TYPES.findall(part))
        for declared in CONSTANTS.findall(part):
            names |= set(re.findall(r"(?:^|, )(\w+)(?= ?[={])", declared))
    return names


def test_names_that_a_file_hides_are_found() -> None:
    text = "namespace {\n\nconstexpr double FIRST = 1.0, SECOND{2};\nstruct Third {\n  int x;\n};\n}  // namespace\n"
    assert hidden_names(text) == {"FIRST", "SECOND", "Third"}


def test_no_two_files_of_a_folder_hide_the_same_name() -> None:
    folders = [folder for folder in SOURCES.iterdir() if folder.is_dir()]
    assert len(folders) > 5
    twice = []
    for folder in folders:
        counts = Counter(name for file in folder.glob("*.cpp") for name in hidden_names(file.read_text()))
        twice += [f"{folder.name}: {name}" for name, count in counts.items() if count > 1]
    assert not twice, f"give them names of their own, or one header: {twice}"
