"""An arm with a mesh of our own making, as files: a fork that is far from convex, and links of every other shape."""

import numpy as np
import trimesh

from evenroad.robots.kinematics import link_poses
from tests.robots.urdf_texts import joint, link, urdf, write

WIDE = "<limit lower='-2.8' upper='2.8' velocity='2' effort='1'/>"
PRONG, GAP, LONG = 0.02, 0.16, 0.20
"""The fork has two square prongs, this thick and long, along z, and a gap between them [m]."""


FORK = (
    ((PRONG, GAP + 2 * PRONG, PRONG), (0.0, 0.0, 0.0)),
    ((PRONG, PRONG, LONG), (0.0, -0.5 * (GAP + PRONG), 0.5 * LONG)),
    ((PRONG, PRONG, LONG), (0.0, 0.5 * (GAP + PRONG), 0.5 * LONG)),
)
"""Boxes that make the fork, a bar and the prongs that stand on it: full extents and centre."""


def fork():
    """The fork as one mesh of 36 triangles; the gap opens upwards."""
    boxes = [trimesh.creation.box(size).apply_translation(centre) for size, centre in FORK]
    return trimesh.util.concatenate(boxes)


def write_fork_arm(folder, *, scale="1 1 1", file="meshes/fork.stl", last="<capsule radius='0.03' length='0.1'/>"):
    """Write arm.urdf and its mesh: a box, a cylinder, a ball on the way, at the end the fork; return the URDF.

    Turns about z, then y, then slides along x; the fork is turned and shifted in its link.
    """
    (folder / "meshes").mkdir(exist_ok=True)
    factors = np.array([float(word) for word in scale.split()])
    fork().apply_scale(1.0 / factors).export(folder / "meshes" / "fork.stl")
    mesh = (
        f"<collision><origin xyz='0.05 0 0.02' rpy='0.3 -0.2 0.1'/><geometry><mesh filename='{file}'"
        f" scale='{scale}'/></geometry></collision>"
    )
    text = urdf(
        link("base", "<collision><geometry><box size='0.2 0.1 0.1'/></geometry></collision>"),
        link("arm", "<collision><geometry><cylinder radius='0.04' length='0.3'/></geometry></collision>"),
        link("slider"),
        link("fork", mesh),
        link("nose", f"<collision><geometry>{last}</geometry></collision>"),
        joint("turn", "base", "arm", "continuous", "", "0 0 0.3", "0 0 1"),
        joint("bend", "arm", "slider", inside=WIDE, xyz="0 0 0.25"),
        joint(
            "slide", "slider", "fork", "prismatic", "<limit lower='0' upper='0.3' velocity='1' effort='1'/>",
            "0.1 0 0.05", "1 0 0",
        ),
        joint("screw", "slider", "nose", "fixed", "", "-0.1 0 0.05"),
        name="fork arm",
    )  # fmt: skip
    return write(folder, text)


def write_plate_arm(folder):
    """Write plate.urdf, of boxes and balls: a wide plate, whose capsules hold all that is near it; return the file.

    The tip, a ball on the second joint, goes up and down beside the plate: it touches where that joint is near pi/2.
    The collar around that joint is in the plate all the time.
    """
    text = urdf(
        link("plate", "<collision><geometry><box size='0.4 0.4 0.01'/></geometry></collision>"),
        link("post", "<collision><geometry><cylinder radius='0.005' length='0.02'/></geometry></collision>"),
        link("tip", "<collision><origin xyz='0.02 0 0'/><geometry><sphere radius='0.012'/></geometry></collision>"),
        link("collar", "<collision><geometry><sphere radius='0.05'/></geometry></collision>"),
        joint("turn", "plate", "post", "revolute", WIDE, "0.05 0 0.025", "0 0 1"),
        joint("bend", "post", "tip", "revolute", WIDE, "0 0 0.01", "0 1 0"),
        joint("spin", "tip", "collar", "revolute", WIDE, "0 0 0", "0 1 0"),
        name="plate arm",
    )  # fmt: skip
    return write(folder, text, "plate.urdf")


ROD = (0.03, 0.04, 0.3), (0.0, 0.0, -0.03)
"""A box that fits into the gap of the fork: full extents and centre."""


def write_fork_and_rod(folder):
    """Write a fork that turns about z, and the rod on a second joint that swings through its gap; return the URDF."""
    fork().export(folder / "fork.stl")
    wide = "<limit lower='-3' upper='3' velocity='2' effort='1'/>"
    text = urdf(
        link("fork", "<collision><geometry><mesh filename='fork.stl'/></geometry></collision>"),
        link("arm", ""),
        link("rod", "<collision><origin xyz='0 0 -0.03'/><geometry><box size='0.03 0.04 0.3'/></geometry></collision>"),
        joint("turn", "fork", "arm", "revolute", wide, "0 0 0.2", "0 0 1"),
        joint("lift", "arm", "rod", "revolute", wide, "0 0.02 0", "1 0.3 0"),
        name="fork and rod",
    )  # fmt: skip
    return write(folder, text, "fork.urdf")


def rod_touches(robot, q):
    """Whether the rod touches a box of the fork, (n,): two boxes are apart where one of fifteen axes parts them."""
    poses = link_poses(robot, q)[:, robot.links.index("rod")]
    turn, half = poses[:, :3, :3], 0.5 * np.array(ROD[0])
    centre = turn @ np.array(ROD[1]) + poses[:, :3, 3]
    touches = np.zeros(len(q), dtype=bool)
    for size, place in FORK:
        own = np.broadcast_to(np.eye(3), turn.shape)
        crossed = [np.cross(own[:, :, i], turn[:, :, k]) for i in range(3) for k in range(3)]
        axes = np.stack([*own.transpose(2, 0, 1), *turn.transpose(2, 0, 1), *crossed], axis=1)
        reach = np.abs(axes) @ (0.5 * np.array(size)) + np.abs(axes @ turn) @ half
        apart = np.abs(np.einsum("nax,nx->na", axes, centre - place)) > reach
        touches |= ~apart.any(axis=1)
    return touches
