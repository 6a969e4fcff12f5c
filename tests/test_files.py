"""A file that is not what was asked for is told apart by its content, whatever its name says."""

import gzip
import json
import os
import sqlite3
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from evenroad._files import atomic_write, looks_like, not_a, read_json_file
from evenroad._yaml import read_mapping
from evenroad.errors import BrokenFile
from evenroad.points.npz import load_points
from tests.refused import refused


def _saved(save, path, *arrays):
    """NumPy adds a suffix to a name, but not to an open file."""
    with path.open("wb") as file:
        save(file, *arrays)


def _database(path):
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE a (b)")
    connection.close()


MADE = {
    "empty": lambda path: path.write_bytes(b" \n"),
    "text": lambda path: path.write_text("ein Weg über Wände"),
    "XML": lambda path: path.write_text("\n<robot/>"),
    "no text": lambda path: path.write_bytes(gzip.compress(b"0" * 100)),
    "a .npy array": lambda path: _saved(np.save, path, np.zeros((2, 2))),
    "a .npz or other archive": lambda path: _saved(np.savez, path, np.zeros(2)),
    "a PNG image": lambda path: Image.new("L", (2, 2)).save(path, "PNG"),
    "a PGM image": lambda path: Image.new("L", (2, 2)).save(path, "PPM"),
    "a JPEG image": lambda path: Image.new("L", (2, 2)).save(path, "JPEG"),
    "a SQLite file": _database,
}


@pytest.mark.parametrize("what", MADE)
def test_a_file_is_told_by_its_content(tmp_path, what):
    MADE[what](tmp_path / "a.yaml")
    assert looks_like(tmp_path / "a.yaml") == what


def test_a_character_that_the_first_block_cuts_in_two_is_text_all_the_same(tmp_path):
    (tmp_path / "a").write_text("x" * 4095 + "ü" * 10)
    assert looks_like(tmp_path / "a") == "text"


def test_of_a_text_it_is_said_why_it_is_none_and_of_others_what_they_are(tmp_path):
    (tmp_path / "text").write_text("hello")
    (tmp_path / "xml").write_text("<a/>")
    assert str(not_a("a map", tmp_path / "text", "no pixels")).endswith("text is not a map: no pixels")
    assert str(not_a("a map", tmp_path / "xml", "no pixels")).endswith("xml is XML, not a map")


FOREIGN = ("codec", "unicode string", "pickle", "Expecting value: line", "EOFError", "Error(")
READERS = {
    "YAML": lambda path: read_mapping(path, "scene"),
    "JSON": lambda path: read_json_file(path, "plan"),
    "points": load_points,
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("what", MADE)
def test_whatever_is_read_the_error_is_ours(tmp_path, what, reader):
    if (what, reader) == ("a .npy array", "points"):
        pytest.skip("that is what it is")
    MADE[what](tmp_path / "a.txt")
    with pytest.raises(BrokenFile, match=r"a\.txt is ") as caught:
        READERS[reader](tmp_path / "a.txt")
    text = str(caught.value)
    assert not any(each in text for each in FOREIGN)
    assert "\n" not in text
    assert "not a" in text or "not YAML" in text or "not JSON" in text


@pytest.mark.parametrize(("reader", "text", "says"), [
    ("YAML", "a: [1, 2\n", "is not YAML, as a scene is: line 2, column 1: "),
    ("YAML", "a: 1\n b: 2", "is not YAML, as a scene is: line 2, column 3: "),
    ("JSON", "{", "is not JSON, as a plan is: line 1, column 2"),
    ("JSON", '{"a":\n 1,}', "is not JSON, as a plan is: line 2, column "),
])  # fmt: skip
def test_what_does_not_parse_is_said_with_its_place(tmp_path, reader, text, says):
    (tmp_path / "a").write_text(text)
    refused((yaml.YAMLError, json.JSONDecodeError), "", yaml.safe_load if reader == "YAML" else json.loads, text)
    refused(BrokenFile, says, READERS[reader], tmp_path / "a")


def test_a_missing_file_is_said_to_be_missing_and_python_objects_are_never_unpacked(tmp_path):
    refused(BrokenFile, "cannot read the plan .*nowhere", read_json_file, Path("nowhere"), "plan")
    np.save(tmp_path / "a.npy", np.array([{}, 1], dtype=object), allow_pickle=True)
    with pytest.raises(BrokenFile, match=r"a\.npy is not a readable \.npy array .*: .* holds Python objects"):
        load_points(tmp_path / "a.npy")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names are of POSIX")
def test_no_file_takes_the_place_of_a_device_or_a_pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    says = "pipe: it is a device or a pipe, not a file"
    with pytest.raises(BrokenFile, match=says), atomic_write(tmp_path / "pipe") as file:
        file.write(b"x")
    assert (tmp_path / "pipe").is_fifo()
    assert [path.name for path in tmp_path.iterdir()] == ["pipe"]
