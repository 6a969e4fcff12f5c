"""The dispersion again, slowly: by Voronoi cells for the Euclidean distance, by all candidates for the largest one."""

import numpy as np
from scipy.spatial import Voronoi, cKDTree


def dispersion_l2(points):
    """The largest Euclidean distance of a place of [0, 1]^d from the nearest point, d <= 3: at a Voronoi vertex.

    Cells of points that are mirrored at every face meet at the faces.
    """
    distinct = np.unique(np.asarray(points), axis=0)
    d = distinct.shape[1]
    if d == 1:
        ordered = np.sort(distinct[:, 0])
        return max(ordered[0], 1 - ordered[-1], np.diff(ordered).max(initial=0.0) / 2)
    mirrored = [distinct]
    for axis in np.eye(d, dtype=bool):
        mirrored += [np.where(axis, 2.0 * face - distinct, distinct) for face in (0.0, 1.0)]
    vertices = Voronoi(np.unique(np.concatenate(mirrored), axis=0)).vertices
    near = ((vertices > -1e-9) & (vertices < 1 + 1e-9)).all(axis=1)
    places = np.concatenate([np.clip(vertices[near], 0, 1), np.indices([2] * d).reshape(d, -1).T])
    return cKDTree(distinct).query(places)[0].max()


def dispersion_linf(points):
    """The same for the largest difference of a coordinate, d = 2: by bisection on whether open squares cover."""
    x, y = np.asarray(points, dtype=float).T

    def has_hole(radius):
        # The first place that is not covered is at a low side, or at the high side of a square.
        across, up = np.append(0.0, x + radius), np.append(0.0, y + radius)
        places = np.stack(np.meshgrid(across[across <= 1], up[up <= 1]), axis=-1).reshape(-1, 2)
        away = np.maximum(abs(places[:, :1] - x), abs(places[:, 1:] - y))
        return bool((away.min(axis=1) >= radius - 1e-12).any())

    low, high = 0.0, 1.0
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if has_hole(middle) else (low, middle)
    return low
