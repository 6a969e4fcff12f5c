"""Slow checks of flight: an integrator of accelerations, least times by bisection, and distances of obstacles."""

import numpy as np

from evenroad.geometry.distance import point_distance

INSTANTS = 2000
"""Number of instants that an axis is integrated over."""


def flown(start, pieces, instants=200):
    """States along pieces, (k, 10), by summing up their accelerations from a start, (6,): (n, 6), and the times."""
    position, velocity = np.array(start[:3]), np.array(start[3:])
    states, times, begin = [np.concatenate([position, velocity])], [0.0], 0.0
    for duration, acceleration in zip(pieces[:, 0], pieces[:, 7:], strict=True):
        step = duration / instants
        for _ in range(instants):
            position = position + step * (velocity + 0.5 * step * acceleration)
            velocity = velocity + step * acceleration
            states.append(np.concatenate([position, velocity]))
        times += [begin + step * (k + 1) for k in range(instants)]
        begin += duration
    return np.array(states), np.array(times)


def farthest(start, end, speed, acceleration, time):
    """How far one axis gets at most in a time, from one velocity to another: the sum over many instants."""
    t = (np.arange(INSTANTS) + 0.5) * time / INSTANTS
    fastest = np.minimum(np.minimum(start + acceleration * t, end + acceleration * (time - t)), speed)
    return fastest.sum() * time / INSTANTS


def is_feasible(a, b, speed, acceleration, time, slack):
    """Whether every axis can get from one state to another in a time, up to a distance."""
    for axis in range(3):
        v, w, u, distance = a[3 + axis], b[3 + axis], acceleration[axis], b[axis] - a[axis]
        if time < abs(w - v) / u - 1e-9:
            return False
        most = farthest(v, w, speed[axis], u, time)
        least = -farthest(-v, -w, speed[axis], u, time)
        if not least - slack <= distance <= most + slack:
            return False
    return True


def distances(scene, points):
    """Distances of points, (n, 3), from the nearest obstacle of a scene, without meshes and clouds: (n,)."""
    return np.min([point_distance(each.body, points) - each.clearance for each in scene.obstacles], axis=0)
