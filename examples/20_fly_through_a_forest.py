"""Fly through a forest at up to 6 m/s: every instant is proved free, also of a cart that crosses the way."""

import numpy as np

import evenroad as er

# 145 trunks between x = 0.5 and 17.5 m, and a cart that drives across at 1 m/s.
rng, trees = np.random.default_rng(3), []
while len(trees) < 145:
    x, y = rng.uniform((0.5, -6), (17.5, 6))
    if np.hypot(x, y) > 1.5 and np.hypot(x - 18, y) > 1.5:
        trees.append(er.Cylinder(rng.uniform(0.08, 0.2), 6.0, xyz=(x, y, 3), name=f"tree {len(trees)}"))
cart = er.Box((1.2, 0.8, 3.0), xyz=(9, 2.5, 1.5), name="cart")
world = er.FlightWorld(
    er.Scene([*trees, cart]),
    radius=0.25,
    speed=6.0,
    acceleration=8.0,
    bounds=[(-1, 19), (-6, 6), (1, 3)],
    velocities={"cart": (0, -1, 0)},
)
result = er.plan(world, er.State((0, 0, 2)), er.State((18, 0, 2)))
print(result.status, f"{result.cost:.2f} s, proof: {result.proof}, free until {result.free_until:.0f} s")
print(f"at most {100 * result.gap:.1f} % longer than the quickest flight without obstacles")

flight = result.trajectory()
flight.save("flight.csv")
flight.save("flight.json")
result.plot("flight.png")
