"""A ball on a turning arm, and what it may touch: certificates of it are checked in a millisecond or two."""

import numpy as np

import evenroad as er
from evenroad.certificates.certify import Sources, certify
from evenroad_verify.claim import read_inputs

URDF = """<robot name="arm">
  <link name="base"/>
  <link name="ball"><collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="ball"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3"/></joint>
</robot>
"""


def sources_in(folder, scene, urdf=URDF):
    """Return files of a robot and a scene, a text."""
    (folder / "arm.urdf").write_text(urdf)
    (folder / "scene.yaml").write_text(scene)
    return Sources(folder / "arm.urdf", folder / "scene.yaml")


def certificate_in(folder, scene, path, **of_world):
    """Return sources and certificate of a path that nobody has planned."""
    sources = sources_in(folder, scene)
    read = er.load_scene(sources.scene)
    world = er.ArmWorld(er.robot.in_scene(er.load_robot(sources.robot), read), read, **of_world)
    certify(world, np.array(path, dtype=float), sources, folder / "arm.cert")
    return sources, (folder / "arm.cert").read_bytes()


def inputs_of(sources):
    """Return what the checker reads of the files."""
    return read_inputs(sources.robot, sources.scene, None, {})
