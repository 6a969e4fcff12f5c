"""The verb that makes data sets: what is killed goes on, shards merge to the bytes of one machine, paths are free."""

import hashlib
import json
from itertools import pairwise

import numpy as np
import pytest

import evenroad as er
from tests.refused import refused
from tests.robots.oracle import clearance

arrow = pytest.importorskip("pyarrow.parquet")

LINE = ("generate", "clutter", "boxes", "--robot", "arm7", "--count", "5e1", "--rows", 20, "--per-scene", 5)
LINE += ("--jobs", 1)


def files_of(folder):
    return {each.name: each.read_bytes() for each in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The files of a set that one process makes."""
    from evenroad.datasets.part import Request, make_part

    request = Request("arm7", ("clutter", "boxes"), 50, rows=20, of_each=5)
    folder = tmp_path_factory.mktemp("made")
    for part in range(request.parts):
        (folder / request.name(part)).write_bytes(make_part(request, part))
    return folder


def test_a_set_is_made_and_after_a_kill_the_same_line_makes_what_is_missing_and_nothing_else(run, tmp_path, made):
    assert run(*LINE, "-o", "set")[0] == 0
    whole = files_of(tmp_path / "set")
    parts = [f"part-{i:06d}.parquet" for i in range(3)]
    assert sorted(whole) == ["_card.json", *(f"_{part}.sha256" for part in parts), "_request.json", *parts]
    assert {name: whole[name] for name in files_of(made)} == files_of(made), "bytes do not depend on the process"
    damaged = bytearray(whole["part-000001.parquet"])
    damaged[len(damaged) // 2] ^= 4
    (tmp_path / "set" / "part-000001.parquet").write_bytes(damaged)
    (tmp_path / "set" / "part-000000.parquet").unlink()
    kept = (tmp_path / "set" / "part-000002.parquet").stat().st_mtime_ns
    code, out, _ = run(*LINE, "-o", "set")
    assert code == 0
    assert "2 files made, 3 of 3 files there; complete" in out
    assert files_of(tmp_path / "set") == whole
    assert (tmp_path / "set" / "part-000002.parquet").stat().st_mtime_ns == kept
    code, _, errors = run(*LINE, "--seed", 1, "-o", "set")
    assert code == 2
    assert "seed" in errors


def test_shards_merge_to_the_bytes_of_one_machine(run, tmp_path, made):
    for i in range(2):
        assert run(*LINE, "--shard", f"{i}/2", "-o", f"shard-{i}")[0] == 0
    assert not (tmp_path / "shard-0" / "_card.json").exists()
    code, out, _ = run("generate", "shard-0", "--merge", "-o", "half")
    assert code == 1
    assert "1 are missing" in out
    assert run("generate", "shard-0", "shard-1", "--merge", "-o", "set")[0] == 0
    merged = files_of(tmp_path / "set")
    assert {name: merged[name] for name in files_of(made)} == files_of(made)
    card = json.loads(merged["_card.json"])
    assert len(card["sha256"]) == 3
    assert card["request"]["robot"] == "arm7"
    assert run("generate", "shard-0", "nothing", "--merge", "-o", "other")[0] == 2
    assert pytest.importorskip("pyarrow.parquet").read_table(tmp_path / "set").num_rows == 50, "a folder for readers"


@pytest.fixture
def small():
    """A request whose parts are texts, and the folder's function that makes its missing parts."""
    from evenroad.datasets import folder as of
    from evenroad.datasets.part import Request

    return of, Request("arm7", ("boxes",), 3, rows=1)


@pytest.mark.parametrize("damage", ["a bit", "a half", "nothing left", "no digest", "half a digest", "another's"])
def test_a_damaged_part_is_none_of_the_set_and_is_not_merged(small, tmp_path, damage):
    of, request = small
    made, merged = tmp_path / "made", tmp_path / "merged"
    made.mkdir()
    merged.mkdir()
    of.claim_folder(made, request.values(), of.REQUEST)
    for part in range(3):
        of.write_part(made / request.name(part), f"part {part}, as it was made".encode())
    assert of.write_card(request, made) == 3
    card = (made / of.CARD).read_bytes()
    file, digest = made / request.name(1), made / f"_{request.name(1)}.sha256"
    content = file.read_bytes()
    match damage:
        case "a bit":
            file.write_bytes(bytes([content[0] ^ 4]) + content[1:])
        case "a half":
            file.write_bytes(content[:10])
        case "nothing left":
            file.write_bytes(b"")
        case "no digest":
            digest.unlink()
        case "half a digest":
            digest.write_bytes(digest.read_bytes()[:40])
        case _:
            file.write_bytes((made / request.name(2)).read_bytes())
            digest.write_bytes((made / f"_{request.name(2)}.sha256").read_bytes())
    assert of.write_card(request, made) == 2
    assert (made / of.CARD).read_bytes() == card, "a digest of damage never enters the card"
    refused(er.errors.BrokenFile, "part-000001.parquet is not what was made", of.merge, [made], merged)
    of.write_part(file, content)
    of.merge([made], merged)
    assert of.write_card(request, merged) == 3
    assert (merged / of.CARD).read_bytes() == card


def test_a_kill_between_a_digest_and_its_part_loses_nothing(small, tmp_path):
    of, request = small
    of.write_part(tmp_path / request.name(0), b"as it was made")
    (tmp_path / request.name(0)).unlink()
    assert of.digest_of(tmp_path / request.name(0)) is None
    of.write_part(tmp_path / request.name(0), b"as it was made")
    assert of.digest_of(tmp_path / request.name(0)) == hashlib.sha256(b"as it was made").hexdigest()


def test_workers_of_a_dask_cluster_make_the_bytes_of_one_machine(run, tmp_path, made):
    distributed = pytest.importorskip("distributed")
    options = dict(n_workers=2, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=None)
    with distributed.LocalCluster(host="127.0.0.1", **options) as cluster:
        code, out, _ = run(*LINE[:-2], "--scheduler", cluster.scheduler_address, "-o", "set")
    assert code == 0
    assert "3 files made, 3 of 3 files there; complete" in out
    written = files_of(tmp_path / "set")
    assert {name: written[name] for name in files_of(made)} == files_of(made)


def test_paths_are_free_in_their_scenes_and_so_are_the_states_of_trajectories(made):
    robot, solved = er.load_robot("arm7"), 0
    for file in sorted(made.iterdir()):
        for row in arrow.read_table(file).to_pylist():
            if not row["solved"]:
                assert np.isnan(row["cost"])
                assert row["path"] == []
                continue
            solved += 1
            scene, path = er.Scene(json.loads(row["scene"])), np.array(row["path"])
            np.testing.assert_array_equal(path[[0, -1]], [row["start"], row["goal"]])
            assert row["cost"] == pytest.approx(np.linalg.norm(np.diff(path, axis=0), axis=1).sum(), rel=1e-12)
            steps = [np.linspace(a, b, 40) for a, b in pairwise(path)]
            states = np.array(row["states"], dtype=float)
            assert clearance(robot, scene, np.concatenate([*steps])).min() > 0.0
            if not np.isnan(row["duration"]):
                assert row["duration"] > 0.0
                np.testing.assert_allclose(states[[0, -1]], path[[0, -1]], atol=1e-5)
    assert solved > 25


def test_hdf5_holds_the_same(made):
    h5py = pytest.importorskip("h5py")
    from io import BytesIO

    from evenroad.datasets.part import Request, make_part

    request = Request("arm7", ("clutter", "boxes"), 50, rows=20, of_each=5, format="hdf5")
    content = make_part(request, 2)
    assert make_part(request, 2) == content
    table = arrow.read_table(made / "part-000002.parquet")
    with h5py.File(BytesIO(content)) as file:
        np.testing.assert_array_equal(file["solved"][:], table["solved"].to_numpy())
        np.testing.assert_array_equal(file["cost"][:], table["cost"].to_numpy())
        np.testing.assert_array_equal(np.diff(file["offsets"][:]), [len(path) for path in table["path"].to_pylist()])
        assert json.loads(file["scenes"][0])["obstacles"]


def test_scenes_of_files_and_folders_are_used(run, tmp_path):
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "a.yaml").write_text("obstacles: {ball: {shape: sphere, radius: 0.1, xyz: [0.5, 0, 0.5]}}")
    line = ("generate", "scenes", "--robot", "arm7", "--count", 10, "--jobs", 1, "-o", "set")
    assert run(*line)[0] == 0
    table = arrow.read_table(tmp_path / "set" / "part-000000.parquet")
    assert set(table["scene"].to_pylist()) == {"scenes/a.yaml"}


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--shard", "2/2"), "--shard must be i/n"),
        (("--count", "1.5"), "count"),
        (("--robot", "nobody"), "nobody"),
        (("--scheduler", "tcp://nobody:1"), "--jobs does not go with --scheduler"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_is_made(run, tmp_path, more, words):
    code, _, errors = run(*LINE, *more, "-o", "set")
    assert code == 2
    assert words in errors
    assert run("generate", "no-such-scenes", "-o", "set")[0] == 2
    assert not list(tmp_path.glob("set/part*"))
