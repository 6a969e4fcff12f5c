"""Compiled code is kept under names that say what it was made of and for."""

import atexit
import importlib
import subprocess
import sys
import tempfile
import textwrap

import pytest

from evenroad import _compiled, _njit, _sources

PROGRAM = """from __future__ import annotations

from evenroad._njit import njit

@njit(cache=True)
def twice(x: int) -> int:
    return 2 * x
"""


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Sources of our own, where `caller` imports `callee`, which imports `constants` through a package's front."""
    files = {
        "constants/__init__.py": "from evenroad.constants.numbers import TWO as TWO\n",
        "constants/numbers.py": "TWO = 2\n",
        "callee.py": "from evenroad.constants import (\n    TWO,\n)\n",
        "caller.py": "import math\n\nfrom evenroad import callee\n",
        "other.py": "THREE = 3\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(_sources, "ROOT", str(tmp_path))
    forget()
    yield tmp_path
    forget()


def forget():
    for function in (_sources.digest_of, _sources._read, _sources._files_of):
        function.cache_clear()


def digest(package):
    forget()
    return _sources.digest_of(str(package / "caller.py"))


@pytest.mark.parametrize("edited", ["caller.py", "callee.py", "constants/__init__.py", "constants/numbers.py"])
def test_an_edit_of_anything_that_a_function_may_call_gives_another_name(package, edited):
    before = digest(package)
    (package / edited).write_text((package / edited).read_text() + "# edited\n")
    assert digest(package) != before


def test_an_edit_elsewhere_does_not(package):
    before = digest(package)
    (package / "other.py").write_text("THREE = 4\n")
    assert digest(package) == before


@pytest.fixture
def program(tmp_path, monkeypatch):
    """The folder of a module with one program, and a function that loads it as a new process would."""
    name = f"program_{tmp_path.name}"
    (tmp_path / f"{name}.py").write_text(PROGRAM)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)

    def load():
        sys.modules.pop(name, None)
        importlib.invalidate_caches()
        return importlib.import_module(name)

    yield tmp_path, name, load
    sys.modules.pop(name, None)


def kept(folder):
    return sorted(path.name for path in (folder / "__pycache__").glob("*.nb?"))


def test_what_was_compiled_is_loaded_by_the_next_process(program):
    folder, _, load = program
    assert load().twice(21) == 42
    index, data = reversed(kept(folder))
    assert (index[-4:], data[-4:]) == (".nbi", ".nbc")
    assert _njit.machine() in index
    again = load()
    assert again.twice(21) == 42
    assert sum(again.twice.stats.cache_hits.values()) == 1


def test_another_processor_finds_nothing_and_leaves_what_is_there(program, monkeypatch):
    folder, _, load = program
    load().twice(21)
    before = kept(folder)
    monkeypatch.setattr(_njit, "machine", lambda: "another")
    again = load()
    assert again.twice(21) == 42
    assert sum(again.twice.stats.cache_hits.values()) == 0
    assert set(before) < set(kept(folder))


def test_what_was_made_of_earlier_sources_is_removed(program, monkeypatch):
    folder, _, load = program
    load().twice(21)
    before = kept(folder)
    monkeypatch.setattr(_njit, "digest_of", lambda source: "edited")
    assert load().twice(21) == 42
    assert len(kept(folder)) == 2
    assert not set(before) & set(kept(folder))


def test_two_that_save_at_once_for_other_arguments_do_not_take_each_others_place(program):
    folder, _, load = program
    first, second = load(), load()
    # Both have looked and found nothing.
    first.twice._cache._cache_file._load_index = second.twice._cache._cache_file._load_index = dict
    assert (first.twice(21), second.twice(1.5)) == (42, 3.0)
    assert len([name for name in kept(folder) if name.endswith(".nbc")]) == 2
    # The last index tells of one; the other is compiled again, and nothing is taken for what it is not.
    assert (load().twice(21), load().twice(1.5)) == (42, 3.0)


def flipped(content, at):
    return content[:at] + bytes([content[at] ^ 4]) + content[at + 1 :]


DAMAGE = {
    "empty": lambda content: b"",
    "cut in the seal": lambda content: content[:40],
    "cut in half": lambda content: content[: len(content) // 2],
    "without its last byte": lambda content: content[:-1],
    "zeroed": lambda content: bytes(len(content)),
    **{f"flipped at {at}/8": lambda content, at=at: flipped(content, at * len(content) // 8) for at in range(8)},
}


@pytest.mark.parametrize("kind", [".nbi", ".nbc"])
def test_of_damaged_compiled_code_nothing_is_run_and_one_line_is_said(program, kind, caplog):
    """Machine code with a flipped bit would end the process; a cut index was a traceback."""
    folder, _, load = program
    assert load().twice(21) == 42
    (file,) = (folder / "__pycache__").glob(f"*{kind}")
    for damage in DAMAGE.values():
        content = file.read_bytes()
        file.write_bytes(damage(content))
        caplog.clear()
        module = load()
        assert module.twice(21) == 42
        assert sum(module.twice.stats.cache_hits.values()) == 0
        assert caplog.messages == [f"evenroad: compiled code kept in {file} was damaged, and is made again"]
        assert load().twice(21) == 42, "what was kept again is whole"
    assert sum(load().twice.stats.cache_hits.values()) == 0
    again = load()
    again.twice(21)
    assert sum(again.twice.stats.cache_hits.values()) == 1


@pytest.mark.parametrize("kind", [".nbi", ".nbc"])
def test_a_file_that_can_be_neither_read_nor_written_only_costs_time(program, kind):
    folder, _, load = program
    load().twice(21)
    (file,) = (folder / "__pycache__").glob(f"*{kind}")
    file.unlink()
    file.mkdir()
    assert load().twice(21) == 42


@pytest.fixture
def shared(tmp_path, monkeypatch):
    """A folder in which processes say what they compile; this one shares it, without helpers so far."""
    folder = tmp_path / "shared"
    folder.mkdir()
    monkeypatch.setattr(_njit, "HELPERS", [])
    monkeypatch.setattr(_njit._Claims, "folder", str(folder))
    monkeypatch.setattr(_njit._Claims, "own", set())
    return folder


def helper_for(name, folder, shared):
    code = f"from evenroad._njit import compile_all; compile_all([{name!r}], {str(shared)!r})"
    return subprocess.Popen([sys.executable, "-c", code], cwd=folder)


def test_a_program_is_taken_from_the_process_that_compiles_it(program, shared):
    folder, name, load = program
    helper = helper_for(name, folder, shared)
    _njit.HELPERS.append(helper)
    while not list(shared.iterdir()):
        assert helper.poll() is None
    module = load()
    assert module.twice(21) == 42
    assert helper.wait() == 0
    assert sum(module.twice.stats.cache_hits.values()) == 1


def test_a_helper_leaves_what_this_process_has_begun(program, shared):
    folder, name, load = program
    module = load()
    assert _njit._claim(module.twice._cache._impl.filename_base)
    assert helper_for(name, folder, shared).wait() == 0
    assert kept(folder) == []
    assert module.twice(21) == 42
    assert len(kept(folder)) == 2


def test_a_program_is_compiled_here_where_the_other_process_fails(program, shared):
    _, _, load = program
    module = load()
    (shared / module.twice._cache._impl.filename_base).write_text("")
    _njit.HELPERS.append(subprocess.Popen([sys.executable, "-c", "raise SystemExit(1)"]))
    assert module.twice(21) == 42
    assert _njit.HELPERS[0].wait() == 1


@pytest.mark.parametrize("reason", ["one processor", "kept", "no interpreter"])
def test_no_process_is_started_without_reason(program, monkeypatch, reason):
    _, name, load = program
    monkeypatch.setattr(_njit, "HELPERS", [])
    if reason == "kept":
        load().twice(21)
        load()
    monkeypatch.setattr(_compiled, "processors", lambda: 1 if reason == "one processor" else 4)
    if reason == "no interpreter":
        monkeypatch.setattr(sys, "executable", "/usr/bin/blender")
    monkeypatch.setattr(subprocess, "Popen", None)
    _compiled.compile_beside(name)
    assert _njit.HELPERS == []


def test_processes_beside_this_one_compile(program, shared, monkeypatch):
    folder, name, load = program
    monkeypatch.setenv("PYTHONPATH", str(folder))
    monkeypatch.setattr(_compiled, "processors", lambda: 3)
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    monkeypatch.setattr(atexit, "register", lambda end: None)
    _compiled.compile_beside(name)
    assert [helper.wait() for helper in _njit.HELPERS] == [0, 0]
    assert load().twice(21) == 42
    assert len(kept(folder)) == 2


def test_progress_is_one_line_that_goes_when_code_is_compiled(program):
    folder, name, _ = program
    code = f"""
    from evenroad import _njit
    _njit.show_progress("compiling")
    import {name}
    {name}.twice(21)
    print("done")
    """
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, cwd=folder, capture_output=True, check=True)
    assert done.stdout.split() == [b"done"]
    assert done.stderr.startswith(b"\rcompiling; ")
    assert done.stderr.endswith(b" s\r\x1b[K")
    assert b"\n" not in done.stderr


def test_what_only_compiled_code_calls_is_compiled_into_its_callers_and_no_further():
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    part, raw = (_njit.njit(lambda x: 2 * x, **options, **more) for more in ({}, {"_nrt": False}))

    @_njit.njit
    def caller(x):
        return part(x) + raw(x)

    assert caller(3) == 12

    def compiled(function):
        (result,) = (each._asdict() for each in function.overloads.values())
        return result["library"], result["fndesc"].llvm_func_name

    for inner in (part, raw):
        code, name = compiled(inner)
        assert code.get_function(name) is not None
        assert not _njit.JITCodeLibrary.codegen.fget(code)._engine.is_symbol_defined(name)
    code, name = compiled(caller)
    assert code.codegen._engine.is_symbol_defined(name)
