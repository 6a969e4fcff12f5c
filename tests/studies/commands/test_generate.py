"""The verb that makes data sets: what is killed goes on, shards merge to the bytes of one machine, paths are free."""

import json
from itertools import pairwise

import numpy as np
import pytest

import evenroad as er
from tests.robot.oracle import clearance

arrow = pytest.importorskip("pyarrow.parquet")

LINE = ("generate", "clutter", "boxes", "--robot", "arm7", "--count", "5e1", "--rows", 20, "--per-scene", 5)
LINE += ("--jobs", 1)


def files_of(folder):
    return {each.name: each.read_bytes() for each in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The files of a set that one process makes."""
    from evenroad_studies.datasets.part import Request, make_part

    request = Request("arm7", ("clutter", "boxes"), 50, rows=20, of_each=5)
    folder = tmp_path_factory.mktemp("made")
    for part in range(request.parts):
        (folder / request.name(part)).write_bytes(make_part(request, part))
    return folder


def test_a_set_is_made_and_after_a_kill_the_same_line_makes_what_is_missing_and_nothing_else(run, tmp_path, made):
    assert run(*LINE, "-o", "set")[0] == 0
    whole = files_of(tmp_path / "set")
    assert sorted(whole) == ["_card.json", "_request.json", *(f"part-{i:06d}.parquet" for i in range(3))]
    assert {name: whole[name] for name in files_of(made)} == files_of(made), "bytes do not depend on the process"
    (tmp_path / "set" / "part-000001.parquet").unlink()
    kept = (tmp_path / "set" / "part-000002.parquet").stat().st_mtime_ns
    code, out, _ = run(*LINE, "-o", "set")
    assert code == 0
    assert "1 file made, 3 of 3 files there; complete" in out
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

    from evenroad_studies.datasets.part import Request, make_part

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
