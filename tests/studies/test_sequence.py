"""Sobol points that were moved: what every sampler owes, with few steps; and what many steps are worth."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.samplers import Sobol
from evenroad_studies import sequence
from evenroad_studies.prefixes import rooted_prefixes
from evenroad_studies.sequence import Sequence
from tests.points.samplers.sampler_contract import SamplerContract
from tests.refused import refused


@pytest.fixture
def hardly_moved(monkeypatch):
    """Let `sequence` move its points in milliseconds, and hardly at all."""
    monkeypatch.setattr(sequence, "STEPS", 3)
    monkeypatch.setattr(sequence, "STARTS", 2)
    monkeypatch.setattr(sequence, "TOGETHER", 128)
    monkeypatch.setattr(sequence, "BLOCKS", {256: 3, 512: 3})
    made = (sequence._moved, sequence._scramble)
    for each in made:
        each.cache_clear()
    yield
    for each in made:
        each.cache_clear()


@pytest.mark.usefixtures("hardly_moved")
class TestSequence(SamplerContract):
    sampler = Sequence()

    @pytest.mark.parametrize("d", [1, 2, 5])
    def test_sets_of_one_seed_begin_with_the_smaller_ones_and_go_on_from_any_index(self, d):
        longest = self.sampler.draw(700, d, rng=3).points
        for n in (1, 63, 128, 129, 400, 512, 513):
            np.testing.assert_array_equal(self.sampler.draw(n, d, rng=3).points, longest[:n])
        np.testing.assert_array_equal(Sequence(start=500).draw(99, d, rng=3).points, longest[500:599])

    @pytest.mark.parametrize("start", [512, 2**24])
    def test_behind_the_last_block_it_is_a_scramble_of_sobols(self, start):
        points = Sequence(start=start).draw(188, 3, rng=3).points
        scrambled = [Sobol(start=start).draw(188, 3, rng=each).points for each in _scrambles(3, 3)]
        assert any((points == each).all() for each in scrambled)

    def test_its_end_is_said(self):
        refused(InvalidValue, "ends at index", lambda: Sequence(start=2**30 - 40).draw(41, 3, rng=3))

    @pytest.mark.parametrize("start", [-1, 0.5, "3"])
    def test_a_start_that_is_no_index_is_refused(self, start):
        refused(InvalidValue, "start", Sequence, start=start)


def _scrambles(seed, d):
    key = int(np.random.default_rng(seed).integers(2**62))
    return np.random.default_rng(key).integers(2**62, size=sequence.STARTS).tolist()


@pytest.mark.parametrize("d", [2, 3])
def test_nearly_every_beginning_has_a_lower_discrepancy_than_scrambled_sobol_points(d, monkeypatch):
    # More points and steps take a minute.
    monkeypatch.setattr(sequence, "STEPS", 1500)
    monkeypatch.setattr(sequence, "TOGETHER", 256)
    for each in (sequence._moved, sequence._scramble):
        each.cache_clear()
    usual = np.mean([np.log(rooted_prefixes(draw("sobol", 256, d, rng=50 + i))) for i in range(16)], axis=0)
    above = (np.log(rooted_prefixes(Sequence().draw(256, d, rng=1))) - usual)[15:]
    assert np.exp(above.mean()) < 0.96
    assert np.exp(above.max()) < 1.1
    assert (above < 0).mean() > 0.9
