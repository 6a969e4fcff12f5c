"""MJCF files for tests."""

LOOP = (
    "<body name='a'><joint name='j' axis='0 1 0'/><geom size='.1'/><body name='b' pos='1 0 0'>"
    "<joint name='k' axis='0 1 0'/><geom size='.1'/></body></body>"
    "<body name='c' pos='2 0 0'><joint name='i' axis='0 1 0'/>"
    "<geom size='.1'/></body><body name='hand' mocap='true'/>"
)


def write(folder, world, rest=""):
    path = folder / "robot.xml"
    text = f"<mujoco model='it'><worldbody>{world}</worldbody>{rest}</mujoco>"
    path.write_text(text)
    return path
