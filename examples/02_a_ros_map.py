"""Make a small ROS map, turned by its yaw, and plan in metres in the map frame."""

from pathlib import Path

import numpy as np
from PIL import Image

import evenroad as er

pixels = np.full((120, 200), 254, dtype=np.uint8)
pixels[50:56, :150] = 0
pixels[80:110, 20:60] = 205  # unknown: an obstacle, unless unknown_is_free=True
Image.fromarray(pixels).save("office.pgm")
Path("office.yaml").write_text(
    "image: office.pgm\nresolution: 0.05\norigin: [1.0, -2.0, 0.3]\n"
    "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)

world = er.load_map("office.yaml").world(radius=0.25, clearance=0.05)
start, goal = world.space.from_cube(np.array([[0.5, 0.1], [0.1, 0.9]]))
result = er.plan(world, start, goal, er.PRM(256))
print(result.status, f"{result.cost:.2f} m")
result.plot("office-plan.png")
