"""What a checker says of balls, solids and movements within cells, against samples that it does not share."""

import numpy as np
import pytest
import trimesh

import evenroad as er
from evenroad.errors import NotAvailable
from evenroad.geometry import Pose
from evenroad_verify.cells import Ranges
from evenroad_verify.certificate import Certificate
from evenroad_verify.claim import Body, read_inputs
from evenroad_verify.frames import frames_of
from evenroad_verify.overlaps import Places, Spot, between, is_ball_inside, overlap, solid_of
from evenroad_verify.shapes import primitive, surface
from tests.certificates.no_path import LINK, Parts, Place, accepts, at, flat_arm, posts
from tests.certificates.small import sources_in
from tests.certificates.tree import POST, URDF
from tests.robots.oracle import link_poses

SIZES = {
    "box": {"size": "0.4 0.3 0.2"},
    "sphere": {"radius": "0.2"},
    "cylinder": {"radius": "0.2", "length": "0.3"},
    "capsule": {"radius": "0.1", "length": "0.3"},
}


def holds(kind, points):
    """Return which points, (n, 3), are in a shape of these sizes about the origin."""
    across, along = np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2])
    if kind == "box":
        return (np.abs(points) <= (0.2, 0.15, 0.1)).all(axis=1)
    if kind == "sphere":
        return np.linalg.norm(points, axis=1) <= 0.2
    if kind == "cylinder":
        return (across <= 0.2) & (along <= 0.15)
    return np.hypot(across, np.maximum(along - 0.15, 0.0)) <= 0.1


def directions(rng, count):
    way = rng.normal(size=(count, 3))
    return way / np.linalg.norm(way, axis=1, keepdims=True)


@pytest.mark.parametrize("kind", [*SIZES, "mesh"])
def test_a_ball_is_inside_if_all_of_its_surface_is(kind):
    rng, seen = np.random.default_rng(len(kind)), [0, 0]
    pose = Pose.from_rpy((0.3, -0.1, 0.2), (0.4, 1.0, -2.0))
    placed = pose.rotation_matrix, np.array(pose.xyz)
    if kind == "mesh":
        corners = trimesh.creation.box((0.4, 0.3, 0.2)).triangles
        shape = surface(corners, (np.eye(3), np.zeros(3)), np.ones(3)).at(placed)
    else:
        shape = primitive(kind, SIZES[kind]).at(placed)
    body, sphere = Body("body", 1, [shape], False), directions(rng, 3_000)
    for centre, radius in zip(rng.uniform(-0.2, 0.2, (150, 3)), rng.uniform(0.001, 0.12, 150), strict=True):
        inside = is_ball_inside(body, pose.apply(centre[np.newaxis])[0], radius)
        truly = holds("box" if kind == "mesh" else kind, centre + radius * sphere).all()
        assert truly or not inside
        assert inside or not holds("box" if kind == "mesh" else kind, centre + (radius + 0.01) * sphere).all()
        seen[inside] += 1
    assert min(seen) > 5


@pytest.mark.parametrize("kind", SIZES)
def test_a_ball_of_the_distance_touches_the_solid_and_one_of_less_does_not(kind):
    rng = np.random.default_rng(len(kind))
    solid = solid_of(primitive(kind, SIZES[kind]))
    points = rng.uniform(-0.4, 0.4, (200, 3))
    grid = np.stack(np.meshgrid(*[np.linspace(-0.35, 0.35, 41)] * 3), axis=-1).reshape(-1, 3)
    grid = grid[holds(kind, grid)]
    for point, far in zip(points, solid.distances(points), strict=True):
        nearest = np.linalg.norm(grid - point, axis=1).min()
        assert (far <= 0.0) == holds(kind, point[np.newaxis])[0]
        assert far <= nearest + 1e-9
        assert far >= nearest - 0.04 or far < 0.0


def test_no_point_moves_farther_within_a_cell_than_is_said(tmp_path):
    """On joints that turn, slide and follow others, seen from every other frame."""
    sources = sources_in(tmp_path, POST, URDF)
    terminals = Certificate("", ("A", "B", "C"), np.zeros((1, 3, 3)), np.zeros(0, np.uint8), np.zeros((0, 3)))
    frames = frames_of(read_inputs(sources.robot, sources.scene, None, {}).robot, terminals)
    robot, rng, used = er.load_robot(sources.robot), np.random.default_rng(4), []
    ranges = Ranges(np.arange(3), np.full(3, -3.0), np.full(3, 3.0), np.zeros(3, bool))
    links = ("base", "a", "b", "c", "d")
    for _ in range(60):
        middle, half = rng.uniform(-1.0, 1.0, (1, 3)), rng.uniform(0.0, 0.5, (1, 3))
        first, second = rng.choice(5, 2, replace=False).tolist()
        places, spot = Places(frames, ranges, middle, half, 3), Spot(first, rng.uniform(-0.3, 0.3, 3), 0.0)
        row = np.zeros(1, np.int64)
        far = places.moved(places.of(spot, row), between(frames, first, second), row)[0]
        q = np.concatenate([middle, middle + half * rng.choice([-1.0, 1.0, 0.3], (80, 3))])
        poses = link_poses(robot, q)
        (turn, origin), (other, base) = poses[links[first]], poses[links[second]]
        local = np.einsum("nji,nj->ni", other, origin + turn @ spot.point - base)
        moved = np.linalg.norm(local - local[0], axis=1).max()
        assert moved <= far + 1e-12
        used.append(moved / max(far, 1e-12))
    assert max(used) > 0.7


def test_a_closed_mesh_is_a_solid_and_one_with_a_hole_is_not(tmp_path):
    box = trimesh.creation.box((0.5, 0.06, 0.06))
    box.export(tmp_path / "bar.stl")
    mesh = f'<mesh filename="{tmp_path}/bar.stl"/>'
    assert mesh in LINK.format("upper", mesh)
    place = Place(tmp_path / "mesh", posts(at(0.7, 0.3), at(-0.7, 0.3)), flat_arm(first=mesh))
    data = place.certificate([0.0, 0.3], [[2.0, 0.3]])
    assert accepts(data, place.inputs)
    for change in ("thinner", "open"):
        other = trimesh.creation.box((0.5, 0.06, 0.03 if change == "thinner" else 0.06))
        other.update_faces(np.arange(12) > (change == "open") - 1)
        other.export(tmp_path / "bar.stl")
        inputs = read_inputs(place.sources.robot, place.sources.scene, None, {})
        assert not accepts(data, inputs)
        assert not accepts(Parts.of(data).saying("inputs", inputs.digest).data, inputs)
    with pytest.raises(NotAvailable):
        Place(tmp_path / "open", place.scene, flat_arm(first=mesh)).certificate([0.0, 0.3], [[2.0, 0.3]])


@pytest.mark.parametrize("kind", [*SIZES, "ball"])
def test_what_overlaps_throughout_a_cell_does_so_in_all_of_its_states(kind, tmp_path):
    """On joints that turn, slide and follow others: an oracle places both, and finds no state with less depth."""
    sources = sources_in(tmp_path, POST, URDF)
    terminals = Certificate("", ("A", "B", "C"), np.zeros((1, 3, 3)), np.zeros(0, np.uint8), np.zeros((0, 3)))
    frames = frames_of(read_inputs(sources.robot, sources.scene, None, {}).robot, terminals)
    robot, rng, lost = er.load_robot(sources.robot), np.random.default_rng(7), []
    ranges = Ranges(np.arange(3), np.full(3, -3.0), np.full(3, 3.0), np.zeros(3, bool))
    links = ("base", "a", "b", "c", "d")
    for _ in range(60):
        middle, half = rng.uniform(-1.0, 1.0, (1, 3)), rng.uniform(0.0, 0.4, (1, 3)) * rng.choice([0.1, 1.0], (1, 3))
        first, second = rng.choice(5, 2, replace=False).tolist()
        places, ball = Places(frames, ranges, middle, half, 3), Spot(first, rng.uniform(-0.3, 0.3, 3), 0.1)
        own = Spot(second, rng.uniform(-0.3, 0.3, 3), 0.2)
        solid = own if kind == "ball" else solid_of(primitive(kind, SIZES[kind]))
        said = overlap(places, frames, ball, (second, solid), np.zeros(1, np.int64))[0]
        corners = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), axis=-1).reshape(-1, 3)
        q = middle + half * np.concatenate([np.zeros((1, 3)), corners, rng.uniform(-1.0, 1.0, (150, 3))])
        poses = link_poses(robot, q)
        (turn, origin), (other, base) = poses[links[first]], poses[links[second]]
        local = np.einsum("nji,nj->ni", other, origin + turn @ ball.point - base)
        far = np.linalg.norm(local - own.point, axis=1) - 0.2 if kind == "ball" else solid.distances(local)
        assert said <= 0.1 - far.max() + 1e-12
        lost.append(0.1 - far.max() - said)
    assert min(lost) < 1e-3
