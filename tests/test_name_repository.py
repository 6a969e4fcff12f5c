"""One command writes the address of the repository into every file that has a place for it."""

import shutil
import tomllib

import pytest
import yaml
from tools.name_repository import PROJECTS, write_address
from tools.run_pages import ROOT

ADDRESS = "https://github.com/somebody/evenroad"
FILES = (*PROJECTS, "CITATION.cff", "packaging/recipe.yaml")


@pytest.fixture
def copy(tmp_path):
    for name in FILES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def test_every_file_names_the_repository_and_a_second_time_changes_nothing(copy):
    write_address(copy, ADDRESS + ".git")
    for name in PROJECTS:
        urls = tomllib.loads((copy / name).read_text())["project"]["urls"]
        assert urls == {"Repository": ADDRESS, "Issues": f"{ADDRESS}/issues", "Changelog": urls["Changelog"]}
    assert yaml.safe_load((copy / "CITATION.cff").read_text())["repository-code"] == ADDRESS
    assert f"\n  repository: {ADDRESS}\n" in (copy / "packaging/recipe.yaml").read_text()
    assert not any("example.org" in (copy / name).read_text() for name in FILES)
    assert write_address(copy, ADDRESS) == []
    assert len(write_address(copy, "https://example.org/evenroad")) == len(FILES)
    assert all((copy / name).read_bytes() == (ROOT / name).read_bytes() for name in FILES)


@pytest.mark.parametrize("address", ["github.com/somebody/evenroad", "https://github.com", 'https://a/b"\n', ""])
def test_what_is_no_address_is_refused(copy, address):
    with pytest.raises(SystemExit, match="must be like https"):
        write_address(copy, address)


def test_classifiers_are_those_of_the_index():
    classifiers = pytest.importorskip("trove_classifiers").classifiers
    assert set(tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["classifiers"]) <= set(classifiers)


def test_workflows_are_yaml_with_jobs():
    for file in (ROOT / ".github" / "workflows").glob("*.yml"):
        assert yaml.safe_load(file.read_text())["jobs"], file
