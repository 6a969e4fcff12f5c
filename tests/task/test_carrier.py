"""An object that is attached without naming a link is carried by the hand, or the error says what to write."""

import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.task import Attach, MoveTo, Task

HAND = """<robot name="hand"><link name="base"/>
  <link name="arm"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="palm"/>
  <link name="left"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <link name="right"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="palm"/><origin xyz="0.3 0 0"/></joint>
  <joint name="finger_l" type="prismatic"><parent link="palm"/><child link="left"/><origin xyz="0 0.05 0"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" velocity="1" effort="1"/></joint>
  <joint name="finger_r" type="prismatic"><parent link="palm"/><child link="right"/><origin xyz="0 -0.05 0"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.04" velocity="1" effort="1"/></joint></robot>"""
TWO = HAND.replace('<link name="base"/>', '<link name="base"/><link name="other"/>').replace(
    "</robot>",
    """
  <joint name="second" type="revolute"><parent link="base"/><child link="other"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="1" effort="1"/></joint></robot>""",
)


def plan(text, joints, path):
    (path / "hand.urdf").write_text(text)
    robot = er.load_robot(path / "hand.urdf", group=joints)
    can = er.Sphere(0.02, xyz=(0.3, 0, 0), name="can")
    world = er.ArmWorld(robot, [can])
    return Task([Attach("can"), MoveTo([1.0] * robot.dof)]).plan(world, [0.0] * robot.dof)


def test_the_hand_from_which_fingers_branch_carries_it(tmp_path):
    done = plan(HAND, ["turn"], tmp_path)
    assert done.solved, done.message
    (held,) = done.parts[-1].world.scene.attached
    assert held.link == "palm"
    assert set(held.touches) >= {"left", "right", "palm"}


def test_of_several_hands_the_error_names_the_step_and_what_to_write(tmp_path):
    with pytest.raises(InvalidValue, match=r"'can': Attach\('can', link='palm'\), or other"):
        plan(TWO, ["turn", "second"], tmp_path)
