"""Contracts for spaces and worlds that users bring: subclass one in a test file and run pytest.

::

    from evenroad.testing import SpaceContract

    class TestMySpace(SpaceContract):
        space = MySpace(...)

Needs pytest.
"""

import pytest

# Before the import below: only then does a failing assert show its values.
pytest.register_assert_rewrite("evenroad.testing.space_contract", "evenroad.testing.world_contract")

from evenroad.testing.space_contract import SpaceContract as SpaceContract  # noqa: E402
from evenroad.testing.world_contract import WorldContract as WorldContract  # noqa: E402
