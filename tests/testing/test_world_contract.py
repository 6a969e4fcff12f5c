"""The world contract finds the mistakes that it is there for."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

from evenroad.space import BoxSpace
from evenroad.testing import WorldContract
from tests.refused import refused


class Good:
    """A square with a round hole; motions are tested at 101 states."""

    def __init__(self):
        self.space = BoxSpace([0, 0], [1, 1])

    def valid(self, q):
        return np.hypot(q[:, 0] - 0.5, q[:, 1] - 0.5) > 0.3

    def motion_valid(self, a, b):
        states = [self.space.interpolate(a, b, t) for t in np.linspace(0.0, 1.0, 101)]
        return np.all([self.valid(state) for state in states], axis=0)


class OnlyTheFirstEnd(Good):
    def motion_valid(self, a, b):
        return self.valid(a)


class OnlyTheEnds(Good):
    def motion_valid(self, a, b):
        return self.valid(a) & self.valid(b)


class ByTheWholeBatch(Good):
    def valid(self, q):
        return super().valid(q) & (q[:, 0] > q[:, 0].mean() - 0.3)


class EverythingFree(Good):
    def valid(self, q):
        return np.ones(len(q), dtype=bool)


class Numbers(Good):
    def valid(self, q):
        return super().valid(q).astype(float)


class Overwriting(Good):
    def motion_valid(self, a, b):
        answer = super().motion_valid(a, b)
        b.setflags(write=True)
        b += 1.0
        return answer


def contract_of(world):
    contract = WorldContract()
    contract.world = world
    return contract


@pytest.mark.parametrize(("world", "test"), [
    (OnlyTheFirstEnd(), "test_a_motion_and_its_reverse_get_one_result"),
    (OnlyTheFirstEnd(), "test_a_free_motion_has_free_endpoints"),
    (OnlyTheEnds(), "test_a_free_motion_is_free_along_its_length"),
    (ByTheWholeBatch(), "test_a_batch_gives_what_its_rows_give"),
    (EverythingFree(), "test_answers_are_booleans_one_a_row"),
    (Numbers(), "test_answers_are_booleans_one_a_row"),
    (Overwriting(), "test_arguments_are_left_alone_and_may_be_read_only_or_strided"),
], ids=lambda value: value if isinstance(value, str) else type(value).__name__)  # fmt: skip
def test_a_mistake_is_found(world, test):
    refused(AssertionError, "", lambda: getattr(contract_of(world), test)())
    getattr(contract_of(Good()), test)()


def test_a_world_that_reads_over_bad_input_is_found():
    refused((pytest.fail.Exception, IndexError), "", lambda: contract_of(Good()).test_a_wrong_shape_is_refused())
    refused(pytest.fail.Exception, "", lambda: contract_of(Good()).test_an_entry_that_is_not_finite_is_refused(np.nan))


def test_a_user_runs_both_contracts_from_a_file_of_their_own(tmp_path):
    """And a failing assert shows its values, as it does in a test file."""
    (tmp_path / "test_mine.py").write_text(
        textwrap.dedent(
            """
            from evenroad.space import BoxSpace, Circle
            from evenroad.testing import SpaceContract, WorldContract
            from evenroad.world import FunctionWorld

            class TestSpace(SpaceContract):
                space = Circle()

            class TestWorld(WorldContract):
                world = FunctionWorld(BoxSpace([0], [1]), lambda q: q[:, 0] >= 0, 0.1)  # one verdict only
            """
        )
    )
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_mine.py"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert run.returncode == 1
    assert "1 failed" in run.stdout
    assert "the contract needs both results" in run.stdout
    assert "assert 400 < 400" in run.stdout
