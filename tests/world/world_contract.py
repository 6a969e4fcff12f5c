"""The world contract for worlds that a fixture makes, and with what our own error texts say."""

from __future__ import annotations

import numpy as np
import pytest

from evenroad import testing
from evenroad.errors import InvalidValue


class WorldContract(testing.WorldContract):
    """Give it a `world` fixture instead of an attribute."""

    @pytest.fixture(autouse=True)
    def _take_the_fixture(self, world):
        self.world = world

    def test_the_text_of_an_error_names_the_place(self):
        q = self.places()
        with pytest.raises(InvalidValue, match="shape"):
            self.world.valid(q[0])
        with pytest.raises(InvalidValue, match="length"):
            self.world.motion_valid(q[:3], q[:4])
        wrong = q.copy()
        wrong[5, 0] = np.nan
        with pytest.raises(InvalidValue, match=r"\[5, 0\]"):
            self.world.valid(wrong)
        with pytest.raises(InvalidValue, match="b must be finite"):
            self.world.motion_valid(q, wrong)
