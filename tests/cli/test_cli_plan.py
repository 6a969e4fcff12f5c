import json
import re
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

import evenroad as er
from evenroad.cli.sampler import SamplerOptions, draw_points
from evenroad.cli.verbs import ABOUT
from evenroad.points import draw
from evenroad.roadmap import KNearest
from evenroad.world.gridmap.shipped import load_maze

MAZE = load_maze(1)


def plan_arguments(map_path=MAZE.path, start=MAZE.start, goal=MAZE.goal, radius=MAZE.robot_radius, **options):
    extra = [each for key, value in options.items() for each in (f"--{key.replace('_', '-')}", value)]
    return ["plan", map_path, "--start", *start, "--goal", *goal, "--robot-radius", radius, *extra]


@pytest.fixture
def room(tmp_path):
    """A 40 x 30 room with a wall across it that leaves a gap on the right."""
    pixels = np.full((30, 40), 255, dtype=np.uint8)
    pixels[14:16, :30] = 0
    Image.fromarray(pixels).save(tmp_path / "room.png")
    return tmp_path / "room.png"


@pytest.fixture
def ros_room(room):
    path = room.with_suffix(".yaml")
    path.write_text(
        "image: room.png\nresolution: 0.1\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return path


def test_a_solved_plan_writes_picture_and_json_and_exits_with_0(run, tmp_path):
    code, out, err = run(*plan_arguments(out="result"), "-n", 512)
    assert (code, err) == (0, "")
    record = json.loads((tmp_path / "result.json").read_text())
    assert {
        "status", "path", "milestone_path", "cost", "length", "counts", "seconds", "timings", "origin", "versions",
    } <= set(record)  # fmt: skip
    assert record["status"] == "solved"
    assert record["path"][0] == list(MAZE.start)
    assert record["path"][-1] == list(MAZE.goal)
    assert record["cost"] <= record["milestone_cost"]
    world = MAZE.world()
    path = np.array(record["path"])
    assert world.motion_valid(path[:-1], path[1:]).all()
    with Image.open(tmp_path / "result.png") as picture:
        assert picture.size[0] > 1000
    assert "solved" in out
    assert max(map(len, out.splitlines())) <= 100


@pytest.mark.parametrize("n", [512, 500])
def test_the_default_set_of_the_plane_is_even_for_any_n_and_the_output_says_so(run, tmp_path, n):
    _, out, _ = run(*plan_arguments(out="a"), "-n", n)
    assert "even rank-1 lattice" in out
    assert json.loads((tmp_path / "a.json").read_text())["counts"]["points"] == n


@pytest.mark.parametrize("d", [3, 4, 6])
def test_the_default_set_of_every_dimension_is_even(d):
    assert draw_points(SamplerOptions(seed=4), 500, d) == draw("even", 500, d, rng=4)


def test_the_same_command_gives_the_same_path_and_another_seed_another(run, tmp_path):
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        run(*plan_arguments(out=name, seed=seed, sampler="halton"), "-n", 600)
    a, b, c = (json.loads((tmp_path / f"{name}.json").read_text())["milestone_path"] for name in "abc")
    assert a == b
    assert a != c


def test_without_a_picture_nothing_is_drawn_and_matplotlib_is_not_even_loaded(tmp_path):
    code = "import sys; from evenroad.cli import main; main(sys.argv[1:]); print('matplotlib' in sys.modules)"
    line = [sys.executable, "-c", code, *map(str, plan_arguments(out="a")), "--no-picture"]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "False"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.json"]
    assert "png" not in done.stdout


def test_the_answer_is_there_before_the_picture_is_drawn(run, tmp_path, monkeypatch):
    import evenroad.viz.plan

    def fail(*_):
        assert (tmp_path / "a.json").exists()
        raise MemoryError("no room for a picture")

    monkeypatch.setattr(evenroad.viz.plan, "save_plan_picture", fail)
    code, out, err = run(*plan_arguments(out="a"))
    assert code == 2
    assert "solved" in out
    assert "no room for a picture" in err


def test_csv_has_one_waypoint_a_row(run, tmp_path):
    run(*plan_arguments(out="a"), "--csv")
    rows = (tmp_path / "a.csv").read_text().splitlines()
    path = json.loads((tmp_path / "a.json").read_text())["path"]
    assert rows[0] == "x,y"
    assert [[float(x) for x in row.split(",")] for row in rows[1:]] == path


def test_the_default_name_is_the_maps_stem_in_the_current_folder(run, tmp_path):
    run(*plan_arguments())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["maze1.json", "maze1.png"]


@pytest.mark.parametrize("out", ["way", "way.json", "way.png"])
def test_who_names_one_of_the_files_means_all_of_them(run, tmp_path, out):
    run(*plan_arguments(out=out))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["way.json", "way.png"]


def test_the_default_name_never_overwrites_the_map(run, room):
    before = room.read_bytes()
    code, _, _ = run(*plan_arguments(room, (5, 5), (5, 25), 2))
    assert code == 0
    assert room.read_bytes() == before
    assert (room.parent / "room-plan.png").exists()


def test_the_default_name_does_not_overwrite_the_image_of_a_ros_map_either(run, ros_room):
    before = ros_room.with_suffix(".png").read_bytes()
    code, _, _ = run(*plan_arguments(ros_room, (-0.5, 2.5), (-0.5, 4.5), 0.2))
    assert code == 0
    assert ros_room.with_suffix(".png").read_bytes() == before


def test_a_ros_map_is_planned_in_metres(run, ros_room, tmp_path):
    code, _, _ = run(*plan_arguments(ros_room, (-0.5, 2.5), (-0.5, 4.5), 0.2, out="a"))
    path = np.array(json.loads((tmp_path / "a.json").read_text())["path"])
    assert code == 0
    # The way round the wall leads through the gap at x = 2 .. 3 m, at half the height of the room.
    assert path[:, 0].max() > 2.0


def test_a_way_that_is_not_found_exits_with_1_and_says_what_to_try(run, tmp_path):
    code, out, _ = run(*plan_arguments(out="a", sampler="uniform"), "-n", 16)
    assert code == 1
    record = json.loads((tmp_path / "a.json").read_text())
    assert record["status"] == "not_connected"
    assert record["path"] is None
    assert {"start_component", "goal_component"} <= set(record["counts"])
    assert "try n=32" in " ".join(out.split())
    assert (tmp_path / "a.png").exists()


@pytest.mark.parametrize(
    ("start", "goal", "status"), [((3, 3), (20, 25), "start_invalid"), ((5, 5), (20, 16.5), "goal_invalid")]
)
def test_an_end_that_touches_an_obstacle_is_a_result_with_a_picture(run, room, tmp_path, start, goal, status):
    code, out, err = run(*plan_arguments(room, start, goal, 4, out="a"))
    assert (code, err) == (1, "")
    assert json.loads((tmp_path / "a.json").read_text())["status"] == status
    assert (tmp_path / "a.png").exists()
    assert status in out


def test_without_a_number_of_points_the_hardest_maze_is_solved(run, tmp_path):
    maze = load_maze(3)
    code, out, err = run(*plan_arguments(maze.path, maze.start, maze.goal, maze.robot_radius, out="a"))
    assert (code, err) == (0, "")
    record = json.loads((tmp_path / "a.json").read_text())
    path, world = np.array(record["path"]), maze.world()
    assert world.motion_valid(path[:-1], path[1:]).all()
    assert record["query"]["n"] is None
    assert "milestones" not in out


def test_the_nearest_of_several_goals_is_reached_on_a_map(run, room, tmp_path):
    for extra in ((), ("-n", 64), ("--improve", "--time", 0.2)):
        code, out, _ = run(
            *plan_arguments(room, (5, 5), (5, 25), 2, out="a"), "--goal", 20, 6, *extra, "--no-picture"
        )
        assert code == 0
        record = json.loads((tmp_path / "a.json").read_text())
        assert record["query"]["goals"] == [[5, 25], [20, 6]]
        assert record["goal_index"] == 1
        assert record["path"][-1] == record["query"]["goal"] == [20, 6]
        assert "to goal 1" in out


def test_a_disks_path_is_proved_without_being_asked_and_improves_with_time(run, room, tmp_path):
    line = plan_arguments(room, (5, 5), (5, 25), 2)
    assert run(*line, "--out", "first", "--no-picture")[0] == 0
    code, out, _ = run(*line, "--improve", "--time", 0.5, "--certified", "--out", "best", "--no-picture")
    assert code == 0
    assert "exact: no motion touches anything" in out
    first, best = (json.loads((tmp_path / f"{name}.json").read_text()) for name in ("first", "best"))
    assert best["proof"] == "exact"
    assert best["cost"] <= first["cost"] == best["stages"][0]["cost"]


def test_that_there_is_no_path_is_proved_where_it_can_be(run, room, tmp_path):
    # The gap is 10 wide.
    assert run(*plan_arguments(room, (12, 7), (12, 23), 5, out="a"))[0] == 0
    for options in ({}, {"n": 64}):
        code, out, _ = run(*plan_arguments(room, (12, 7), (12, 23), 5.05, out="a", **options))
        assert code == 1
        assert json.loads((tmp_path / "a.json").read_text())["status"] == "not_connected"
        assert "proved: there is no path" in " ".join(out.split())


def test_an_invalid_start_names_the_nearest_free_place(run, room, tmp_path):
    run(*plan_arguments(room, (20, 12), (20, 25), 4, out="a"))
    assert "the nearest free place is (20, 10)" in json.loads((tmp_path / "a.json").read_text())["message"]


def test_points_are_drawn_where_a_mostly_unknown_map_is_free(run, tmp_path):
    pixels = np.full((400, 400), 205, dtype=np.uint8)
    pixels[30:70, 300:360] = 254
    Image.fromarray(pixels).save(tmp_path / "far.png")
    (tmp_path / "far.yaml").write_text(
        "image: far.png\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    code, _, _ = run(*plan_arguments("far.yaml", (31, 35), (35, 34), 0.2, out="a", n=128))
    assert code == 0
    assert json.loads((tmp_path / "a.json").read_text())["counts"]["valid"] > 100


def test_clearance_adds_to_the_radius(run, room, tmp_path):
    assert run(*plan_arguments(room, (5, 5), (5, 25), 4, out="a"))[0] == 0
    code, _, _ = run(*plan_arguments(room, (5, 5), (5, 25), 4, out="a", clearance=1.5))
    assert code == 1
    assert json.loads((tmp_path / "a.json").read_text())["query"]["clearance"] == 1.5


BAD = {
    "a missing image": ({"map_path": "nowhere.png"}, "nowhere.png"),
    "a broken image": ({"map_path": "broken.png"}, "broken.png"),
    "another kind of file": ({"map_path": "map.txt"}, "map.txt"),
    "a misspelt YAML key": ({"map_path": "bad-key.yaml"}, "fre_thresh"),
    "an unknown YAML mode": ({"map_path": "bad-mode.yaml"}, "quaternary"),
    "a start outside the map": ({"start": (700, 5)}, "start 700 5 lies outside the map"),
    "a goal outside the map": ({"goal": (5, -1)}, "goal 5 -1 lies outside the map"),
    "a start that is not a number": ({"start": ("nan", 5)}, "finite"),
    "a radius of zero": ({"radius": 0}, "radius must be a finite number > 0, got 0"),
    "a negative radius": ({"radius": -1}, "radius must be a finite number > 0, got -1"),
    "a negative clearance": ({"clearance": -1}, "clearance"),
    "no points": ({"n": 0}, "n must be an integer >= 1, got 0"),
    "k of zero": ({"k": 0}, "k must be"),
    "a connection radius of zero": ({"connect_radius": 0}, "connection radius"),
    "both rules": ({"connect_radius": 5, "k": 5}, "not both"),
    "a negative seed": ({"seed": -1}, "--seed must be an integer >= 0, got -1"),
    "an unknown sampler": ({"sampler": "sobel"}, "known: cover, even, .*halton.*sobol"),
    "a family without this n": (
        {"sampler": "hickernell", "n": 100},
        "it has n = 16, 32, 64, 128, 256, 512, 1024, 2048",
    ),
    "a grid without this n": ({"sampler": "sukharev", "n": 100_000}, "the nearest are 99856 and 100489"),
    "an option of another sampler": ({"sampler": "uniform", "skip": 5}, "--skip does not go with"),
    "a folder that does not exist": ({"out": "no/where/result"}, "does not exist"),
    "an output without a name": ({"out": "."}, "file name"),
    "a name that is too long": ({"out": "x" * 300}, "cannot write"),
    "more points than can be numbered": ({"n": 10**12}, "at most 2147483647"),
    "no time": ({"time": 0}, "time must be a finite number > 0, got 0"),
    "a folder that is a file": ({"out": "map.txt/result"}, "map.txt"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_gets_one_line_and_exit_code_2_and_nothing_is_written(case, run, tmp_path, room):
    (tmp_path / "broken.png").write_bytes(room.read_bytes()[:60])
    (tmp_path / "map.txt").write_text("hello")
    good = "image: room.png\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.6\nfree_thresh: 0.2\n"
    (tmp_path / "bad-key.yaml").write_text(good + "fre_thresh: 0.1\n")
    (tmp_path / "bad-mode.yaml").write_text(good + "mode: quaternary\n")
    before = sorted(tmp_path.rglob("*"))
    changes, says = BAD[case]
    code, out, err = run(*plan_arguments(**changes))
    assert code == 2
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("evenroad: error: ")
    assert re.search(says, err)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_long_name_that_the_file_system_takes_is_taken(run, tmp_path):
    name = "x" * 245
    assert run(*plan_arguments(out=name))[0] == 0
    assert (tmp_path / f"{name}.json").exists()


def test_brackets_in_a_name_are_not_read_as_markup(run, tmp_path):
    code, out, err = run(*plan_arguments(out="res[bold]x[y]"))
    assert (code, err) == (0, "")
    assert "res[bold]x[y].json" in out
    assert (tmp_path / "res[bold]x[y].png").exists()


def test_the_path_of_an_earlier_run_does_not_pass_for_this_ones(run, tmp_path):
    run(*plan_arguments(out="a"), "--csv")
    assert (tmp_path / "a.csv").exists()
    code, out, _ = run(*plan_arguments(out="a", sampler="uniform"), "--csv", "-n", 16)
    assert code == 1
    assert not (tmp_path / "a.csv").exists()
    assert "a.csv" not in out


def test_the_record_holds_all_that_is_needed_to_ask_again(run, tmp_path):
    run(*plan_arguments(out="a", sampler="halton"), "--plain", "--skip", 7, "--raw", "-n", 300)
    query = json.loads((tmp_path / "a.json").read_text())["query"]
    assert (query["sampler"], query["plain"], query["skip"], query["raw"], query["n"]) == (
        "halton",
        True,
        7,
        True,
        300,
    )


def test_out_may_not_overwrite_the_map(run, room):
    before = room.read_bytes()
    code, _, err = run(*plan_arguments(room, (5, 5), (5, 25), 2, out="room"))
    assert code == 2
    assert "overwrite the map" in err
    assert room.read_bytes() == before


def test_an_interrupt_exits_with_130_and_leaves_no_half_file(run, tmp_path, monkeypatch):
    def interrupted(*_args, **_kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr("evenroad.cli.plan_disk.solve", interrupted)
    code, _, err = run(*plan_arguments(out="a", n=64))
    assert code == 130
    assert "interrupted" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        *([verb, "--help"] for verb in ABOUT),
        ["plan", "-h"],
        ["plan", "--robot", "ur5", "-h"],
    ],
)
def test_help_is_there_for_every_verb(run, arguments):
    code, out, _ = run(*arguments)
    assert code == 0
    assert "usage: evenroad" in out


def test_without_arguments_the_help_is_shown(run):
    assert "usage: evenroad" in run()[1]


def test_the_version_is_printed(run):
    import evenroad

    assert run("--version")[1].strip() == f"evenroad {evenroad.__version__}"


def test_the_demo_solves_the_level_3_maze(run, tmp_path):
    code, _, _ = run("demo", "--out", "demo")
    assert code == 0
    record = json.loads((tmp_path / "demo.json").read_text())
    assert record["status"] == "solved"
    assert record["query"]["map"].endswith("maze3.png")


COMMAND = [sys.executable, "-c", "from evenroad.cli import main; raise SystemExit(main())"]


def test_a_reader_that_goes_away_is_no_error(tmp_path):
    process = subprocess.Popen(
        [*COMMAND, *map(str, plan_arguments(out="a"))],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    process.stdout.close()
    assert process.stderr.read() == ""
    process.stderr.close()
    assert process.wait() == 0
    assert (tmp_path / "a.png").exists()


def test_too_little_memory_is_one_line(run, monkeypatch):
    def too_large(*_args, **_kwargs):
        raise MemoryError("Unable to allocate 3 EiB")

    monkeypatch.setattr("evenroad.cli.plan_disk.solve", too_large)
    code, _, err = run(*plan_arguments(out="a", n=64))
    assert code == 2
    assert err == "evenroad: error: not enough memory: Unable to allocate 3 EiB\n"


def test_the_installed_command_works_in_a_process_of_its_own(tmp_path):
    command = [sys.executable, "-c", "from evenroad.cli import main; raise SystemExit(main())"]
    done = subprocess.run(
        [*command, *map(str, plan_arguments(out="a"))], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.png").exists()


def test_a_plan_on_points_says_what_they_guarantee_where_it_is_asked(run, room, tmp_path):
    asked = plan_arguments(room, (3, 3), (3, 27), 1.0, sampler="cover", k=20, out="answer")
    plain = run(*asked, "-n", 256)
    code, out, err = run(*asked, "-n", 256, "--guarantees")
    record = json.loads((tmp_path / "answer.json").read_text())
    world = er.load_map(room).world(1.0)
    certificate = er.plan(
        world, (3, 3), (3, 27), er.PRM(draw("cover", 256, 2), rule=KNearest(20), certify=True)
    ).certificate
    assert (code, err, plain[0]) == (0, "", 0)
    assert "guaranteed" not in plain[1]
    assert "a path exists" not in plain[1]
    assert f"if one of clearance {certificate.dispersion:.6g} does" in out
    assert record["certificate"]["complete"]
    assert record["certificate"]["dispersion"] == certificate.dispersion
    assert record["certificate"]["clearance_for_factor"]["2"] == certificate.clearance_for(2.0)


def test_only_a_roadmap_guarantees_anything(run, room):
    code, out, err = run(*plan_arguments(room, (3, 3), (3, 27), 1.0), "--guarantees")
    assert (code, out) == (2, "")
    assert "--guarantees speaks of a roadmap: say of how many points with -n" in err
