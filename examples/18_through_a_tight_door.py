"""Drive through a door that is 2 cm wider than the robot; one that is 2 cm wider than the door is proved not to fit."""

import numpy as np

import evenroad as er

# Two rooms of an office in cells of 2 cm, y up; the door is 64 cm wide.
office = np.zeros((200, 300), dtype=bool)
office[[0, -1]] = office[:, [0, -1]] = True
office[:, 145:151] = True
office[84:116, 145:151] = False
office[140:, 60:100] = office[:60, 200:250] = True
gridmap = er.GridMap(office, resolution=0.02)

results = {}
for width in (0.62, 0.66):
    # It turns on the spot.
    footprint = [(-0.45, -width / 2), (0.45, -width / 2), (0.45, width / 2), (-0.45, width / 2)]
    results[width] = er.plan(gridmap.world(footprint=footprint), (0.8, 0.8, 1.57), (5.0, 1.2, 0.0))
    print(f"{width} m wide: {results[width].message}")

result = results[0.62]
trajectory = result.trajectory(speed=0.8, acceleration=0.5, angular_speed=1.0)
nearest = result.world.distance(trajectory.positions).min()
print(f"{trajectory.duration:.1f} s, at least {1000 * nearest:.1f} mm from every obstacle")
trajectory.save("door.yaml")  # a nav_msgs/Path
result.plot("door.png")
