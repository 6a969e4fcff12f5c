import pytest

from tests.command_line import answer as answer
from tests.command_line import built_roadmap as built_roadmap
from tests.command_line import ctrl_c_interrupts as ctrl_c_interrupts
from tests.command_line import in_an_empty_folder as in_an_empty_folder
from tests.command_line import made as made
from tests.command_line import refuse as refuse
from tests.command_line import run as run
from tests.robots.urdf_texts import two_joints


@pytest.fixture
def desk(tmp_path):
    """A folder with two joints that turn about y, and a ball that the arm must pass under or over."""
    (tmp_path / "arm.urdf").write_text(two_joints())
    (tmp_path / "desk.yaml").write_text(
        "obstacles:\n  ball: {shape: sphere, radius: 0.05, xyz: [0.0, 0, 0.75]}\n"
        "states:\n  left: {a: -0.9, b: 0}\n  right: {a: 0.9, b: 0}\n"
    )
    return tmp_path
