import pytest

from evenroad.robot.arm_world import ArmWorld
from tests.robot.mesh_arms import write_fork_and_rod
from tests.robot.paths import ARMS, searched


@pytest.fixture(autouse=True)
def _a_cache_of_its_own(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path_factory.mktemp("cache")))


@pytest.fixture(scope="session", params=ARMS)
def paths(request):
    """A world, and paths in it as the trees give them."""
    world = ArmWorld(*ARMS[request.param])
    return world, searched(world, 25, 7)


@pytest.fixture(scope="session")
def fork_file(tmp_path_factory):
    """The URDF of a fork and a rod that swings through its gap."""
    return write_fork_and_rod(tmp_path_factory.mktemp("fork"))
