"""Whether compiled code is kept is known before it is asked for."""

import importlib.util

from evenroad._compiled import is_kept

MODULE = "from numba import njit\n\n\n@njit(cache=True)\ndef twice(x):\n    return 2 * x\n"


def load(path):
    spec = importlib.util.spec_from_file_location("doubles", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_code_is_kept_once_it_was_compiled_and_until_its_file_changes(tmp_path):
    path = tmp_path / "doubles.py"
    path.write_text(MODULE)
    module = load(path)
    assert not is_kept(module.twice)
    assert module.twice(2) == 4
    assert is_kept(module.twice)
    assert is_kept(load(path).twice)
    path.write_text(MODULE.replace("2 * x", "x + x + 0"))
    assert not is_kept(load(path).twice)


def test_what_nobody_can_tell_counts_as_kept():
    class Foreign:
        signatures = ()

    assert is_kept(Foreign())
