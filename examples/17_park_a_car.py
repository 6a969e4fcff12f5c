"""Park a car between two others: all that it sweeps is proved free, also where its wheels turn slowly."""

import numpy as np

import evenroad as er

# A street of 18 m by 7 m in cells of 10 cm, y up; the first row is the far side.
street = np.zeros((70, 180), dtype=bool)
street[:2] = True
street[66:] = True
street[45:64, 10:55] = True
street[45:64, 115:160] = True  # 6 m behind the first car

# 4.5 m by 1.8 m, around the middle of the rear axle.
car = [(-0.9, -0.9), (3.6, -0.9), (3.6, 0.9), (-0.9, 0.9)]
world = er.GridMap(street, resolution=0.1).world(footprint=car, turning_radius=4.5)
result = er.plan(world, (1.5, 4.0, 0.0), (6.9, 1.55, 0.0))
print(result.status, f"{result.cusps} changes of direction, proof: {result.proof}")
for curvature, length in result.pieces:
    turn = "straight" if curvature == 0.0 else "left" if curvature > 0.0 else "right"
    print(f"  {'forwards' if length > 0.0 else 'backwards':9} {turn:8} {abs(length):.2f} m")

# From straight to the sharpest turn the wheels take 1.5 s.
trajectory = result.trajectory(speed=1.5, acceleration=0.8, lateral=1.0, curvature_rate=0.15)
print(trajectory)
trajectory.save("parking.csv")
result.plot("parking.png")
