import pytest

from evenroad.points.samplers import sequence


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
