"""Follow a seam of 300 poses around a pipe at a steady speed, from a posture with which all of it can be reached."""

import numpy as np

import evenroad as er
from evenroad.task import MoveAlong, MoveTo, Task

HOME = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]

# A pipe stands on a lying one; the seam is where they meet. The torch leans outward, halfway between the two.
lying, standing = 0.10, 0.06
world = er.ArmWorld(
    "ur5",
    er.Scene(
        [
            er.Cylinder(lying, 0.5, xyz=(0.55, 0.0, 0.05), rpy=(np.pi / 2, 0.0, 0.0), name="lying pipe"),
            er.Cylinder(standing, 0.25, xyz=(0.55, 0.0, 0.2), name="standing pipe"),
        ],
        name="pipes",
    ),
)

seam = []
for angle in np.pi + np.linspace(-1.4, 1.4, 300):
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    along = standing * out
    at = np.array([0.55, 0.0, 0.05 + np.sqrt(lying**2 - along[0] ** 2)]) + along
    towards = -(out + np.array([0.0, 0.0, 1.2]))
    towards /= np.linalg.norm(towards)
    across = np.cross([0.0, 0.0, 1.0], out)
    turn = np.column_stack([np.cross(across, towards), across, towards])
    # The flange holds a torch of 15 cm.
    seam.append(er.Pose(at - 0.15 * towards, turn))

task = Task([MoveTo(seam[0], approach=0.05), MoveAlong(seam[1:], spline=True, speed=0.05), MoveTo(HOME, retreat=0.05)])
done = task.plan(world, HOME)
print(done.message, f"in {1e3 * done.timings['task']:.0f} ms; {done.tried} choices")
weld = done.motions[1].parts[0]
print(f"the tip leaves the seam by at most {1e3 * weld.deviation['curve_m']:.3f} mm")
print(done.trajectory())
weld.plot("weld.png")
