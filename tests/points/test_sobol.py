"""Scrambled Sobol points against SciPy's engine."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.stats import qmc

from evenroad.points import draw
from evenroad.points.samplers import plain


@pytest.mark.parametrize(("n", "d"), [(1, 1), (2, 3), (3, 7), (100, 10), (1025, 4), (64, 200)])
def test_the_bits_are_scipys_with_and_without_its_table(n, d, monkeypatch, tmp_path):
    engine = qmc.Sobol(d, rng=np.random.default_rng(6))
    expected = engine.random_base2((n - 1).bit_length())[:n]
    for _ in range(2):
        np.testing.assert_array_equal(draw("sobol", n, d, rng=6).points, expected)
        monkeypatch.setattr(plain, "table_of_scipy", lambda: tmp_path / "missing.npz")


def test_points_are_drawn_without_scipys_statistics():
    code = "import sys; from evenroad.points import draw; draw('sobol', 64, 6); assert 'scipy.stats' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
