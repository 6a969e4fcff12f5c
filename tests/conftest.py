"""How hypothesis tries its examples in all tests, and what tests of arms share."""

from itertools import count

import pytest
from hypothesis import settings

settings.register_profile("patient", deadline=None)
settings.load_profile("patient")

OF_ARMS = ("robots", "loading", "scenes", "collision", "poses", "infeasibility")
"""Folders whose tests read robots of their own making: each has a cache of its own."""
_NUMBERS = count()


@pytest.fixture(autouse=True)
def _a_cache_of_its_own(request, tmp_path_factory, monkeypatch):
    if any(folder in request.path.parts for folder in OF_ARMS):
        # The few that keep something make it: pytest would look through all folders of earlier tests for a new one.
        monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path_factory.getbasetemp() / "caches" / str(next(_NUMBERS))))


@pytest.fixture(scope="session")
def fork_file(tmp_path_factory):
    """The URDF of a fork and a rod that swings through its gap."""
    from tests.robots.mesh_arms import write_fork_and_rod

    return write_fork_and_rod(tmp_path_factory.mktemp("fork"))
