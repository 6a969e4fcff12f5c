import pytest

from evenroad.collision.arm_world import ArmWorld
from tests.robots.paths import ARMS, searched


@pytest.fixture(scope="session", params=ARMS)
def paths(request):
    """A world, and paths in it as the trees give them."""
    world = ArmWorld(*ARMS[request.param])
    return world, searched(world, 25, 7)
