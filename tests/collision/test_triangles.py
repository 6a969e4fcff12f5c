"""Closed parts of meshes, and the pieces that a robot can reach, as slow loops find them."""

from collections import Counter

import numpy as np
import pytest

from evenroad._native import robot as native
from evenroad.geometry import TriangleMesh


def slow_closed_parts(mesh):
    """Which triangles bound closed parts, and which one of a part is the first, by dictionaries of corners."""
    faces = [[tuple((mesh.vertices[i] + 0.0).tolist()) for i in face] for face in mesh.triangles]
    part = {}
    for face in faces:
        joined = set().union(*(part.get(corner, {corner}) for corner in face))
        for corner in joined:
            part[corner] = joined
    odd, seen, again = {True: set(), False: set()}, set(), []
    for face in faces:
        again.append(frozenset(face) in seen)
        seen.add(frozenset(face))
    for once in odd:
        sides = [
            frozenset((face[k], face[(k + 1) % 3]))
            for face, repeated in zip(faces, again, strict=True)
            for k in range(3)
            if len(set(face)) == 3 and not (once and repeated)
        ]
        odd[once] = {id(part[next(iter(side))]) for side, count in Counter(sides).items() if count % 2}
    closed = [
        len(set(face)) == 3
        and (not repeated if id(part[face[0]]) not in odd[True] else id(part[face[0]]) not in odd[False])
        for face, repeated in zip(faces, again, strict=True)
    ]
    known = set()
    first = [not (id(part[face[0]]) in known or known.add(id(part[face[0]]))) for face in faces]
    return closed, first


def slow_pieces(corners, reach, longest):
    """The same one after the other."""
    if not ((np.abs(corners).min(axis=0) <= reach) | (corners.min(axis=0) * corners.max(axis=0) <= 0.0)).all():
        return []
    lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1)
    if lengths.max() <= longest:
        return [corners.ravel().tolist()]
    a, b, c = np.roll(corners, -lengths.argmax(), axis=0)
    middle = 0.5 * (a + b)
    one, other = (np.stack(piece) for piece in ((a, middle, c), (middle, b, c)))
    return slow_pieces(one, reach, longest) + slow_pieces(other, reach, longest)


def tetrahedra(rng, count, turned):
    """Closed surfaces, some without a triangle, some with one turned, as a soup of corners or with shared ones."""
    vertices, triangles = [], []
    for _ in range(count):
        faces = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
        if rng.random() < 0.3:
            faces = faces[: rng.integers(1, 4)]
        if turned and rng.random() < 0.4:
            faces[0] = faces[0, ::-1]
        triangles.append(faces + 4 * len(vertices))
        if turned and rng.random() < 0.4:
            triangles.append(triangles[-1][rng.integers(0, len(faces), rng.integers(1, 3)), ::-1])
        if turned and rng.random() < 0.3:
            triangles.append(triangles[-1][:1, [0, 1, 1]])
        corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]) * rng.choice((-1.0, 1.0), 3)
        vertices.append(corners + rng.integers(-2, 3, 3))
    vertices, triangles = np.concatenate(vertices), np.concatenate(triangles)
    if rng.random() < 0.5:
        return TriangleMesh(vertices[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3))
    return TriangleMesh(vertices, triangles)


@pytest.mark.parametrize("seed", range(40))
def test_closed_parts_are_those_of_a_slow_search(seed):
    rng = np.random.default_rng(seed)
    mesh = tetrahedra(rng, int(rng.integers(1, 30)), turned=seed % 2 == 1)
    closed, first = slow_closed_parts(mesh)
    assert mesh.closed_parts.closed.tolist() == closed
    assert mesh.closed_parts.first.tolist() == first


def test_pieces_are_those_of_a_slow_recursion_and_cover_what_is_reached():
    rng = np.random.default_rng(0)
    corners = rng.normal(size=(60, 3, 3)) * rng.uniform(0.05, 3.0, (60, 1, 1))
    first = rng.random(len(corners)) < 0.3
    pieces, of_first = native.pieces_within(corners, first, 0.9, 0.3)
    assert len(pieces) > 300
    for which in (False, True):
        expected = [piece for triangle in corners[first == which] for piece in slow_pieces(triangle, 0.9, 0.3)]
        assert sorted(pieces[of_first == which].tolist()) == sorted(expected)
    # Places of the triangles within reach are in one of the pieces: areas tell.
    near = corners[(np.abs(corners) < 0.9).all(axis=(1, 2))]
    assert len(near) > 5
    area = lambda t: np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1).sum()  # noqa: E731
    pieces, _ = native.pieces_within(near, np.ones(len(near), dtype=bool), 0.9, 0.3)
    assert np.isclose(area(pieces.reshape(-1, 3, 3)), area(near))
