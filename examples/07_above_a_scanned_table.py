"""Plan above a table that a depth camera sees, with the arm itself in the picture, and look at it from three sides."""

import numpy as np

import evenroad as er
from evenroad.geometry import PointCloud
from evenroad.planning.read_problem import arm_problem
from evenroad.robot import Obstacle, Scene, Seen, capsule_endpoints, load_robot

robot, home = load_robot("ur5"), "0,-1.57,0,-1.57,0,0"
BOXES = [
    ((0.55, 0.1, 0.12), (0.06, 0.09, 0.12)),
    ((0.45, -0.3, 0.06), (0.12, 0.05, 0.06)),
]  # centre, half extents [m]


def distance(p):
    """By how much points, (n, 3), are outside of the table, of what stands on it, and of the arm at home."""
    apart = np.linalg.norm(np.maximum(np.abs(p - (0.3, 0.0, -0.02)) - (0.6, 0.6, 0.02), 0.0), axis=1)
    for centre, half in BOXES:
        apart = np.minimum(apart, np.linalg.norm(np.maximum(np.abs(p - centre) - half, 0.0), axis=1))
    apart = np.minimum(apart, np.linalg.norm(p - (0.35, 0.35, 0.08), axis=1) - 0.08)
    q = np.array(home.split(","), dtype=float)
    for (a, b), capsule in zip(capsule_endpoints(robot, [q])[0], robot.capsules, strict=True):
        share = np.clip((p - a) @ (b - a) / max((b - a) @ (b - a), 1e-12), 0.0, 1.0)
        apart = np.minimum(apart, np.linalg.norm(p - a - share[:, None] * (b - a), axis=1) - capsule.radius)
    return apart


# A camera of 200 x 150 pixels in front of the table: along each ray as far as nothing can be in the way, and again.
eye, middle = np.array([1.5, 0.3, 1.2]), np.array([0.3, 0.0, 0.1])
ahead = (middle - eye) / np.linalg.norm(middle - eye)
right = np.cross(ahead, (0.0, 0.0, 1.0)) / np.linalg.norm(np.cross(ahead, (0.0, 0.0, 1.0)))
u, v = (each.reshape(-1, 1) for each in np.meshgrid(np.linspace(-0.6, 0.6, 200), np.linspace(-0.45, 0.45, 150)))
rays = ahead + u * right + v * np.cross(right, ahead)
rays /= np.linalg.norm(rays, axis=1, keepdims=True)
depth = np.zeros(len(rays))
for _ in range(80):
    depth += distance(eye + depth[:, None] * rays)
points = (eye + depth[:, None] * rays)[depth < 3.0]

# As np.save("scan.npy", points) and, in a scene's file:
#   scan: {shape: cloud, file: scan.npy, radius: 0.008, seen_at: "0,-1.57,0,-1.57,0,0"}
scan = Obstacle("scan", PointCloud(points, radius=0.008), seen=Seen(home))
scene = Scene((scan,), name="scanned table")
start, goal = "-1.2,-0.9,1.3,-1.9,-1.57,0", "0.75,-0.8,1.2,-1.9,-1.57,0"
query = arm_problem("ur5", scene, start, goal)
print(f"{len(points)} points, {len(query.world.scene.obstacles[0].body.points)} of them not the arm's own")
result = er.plan(scene, start, goal, robot="ur5")
print(result.message, "proof:", result.proof)
result.plot("scanned-table.png")
