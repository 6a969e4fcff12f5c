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
from evenroad.world.gridmap.load import load_maze

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


ROS_MAP = "image: {}.png\nresolution: {}\norigin: [{}, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


@pytest.fixture
def ros_room(room):
    path = room.with_suffix(".yaml")
    path.write_text(ROS_MAP.format("room", 0.1, "-1.0, 2.0"))
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
    path = np.array(record["path"])
    assert MAZE.world().motion_valid(path[:-1], path[1:]).all()
    with Image.open(tmp_path / "result.png") as picture:
        assert picture.size[0] > 1000
    assert "solved" in out
    assert max(map(len, out.splitlines())) <= 100


def test_the_default_set_is_even_for_any_n_and_any_dimension(answer):
    for n in (512, 500):
        record, shown = answer(*plan_arguments(), "-n", n)
        assert "even rank-1 lattice" in shown
        assert record["counts"]["points"] == n
    for d in (3, 4, 6):
        assert draw_points(SamplerOptions(seed=4), 500, d) == draw("even", 500, d, rng=4)


def test_the_same_command_gives_the_same_path_and_another_seed_another(answer):
    a, b, c = (
        answer(*plan_arguments(seed=seed, sampler="halton"), "-n", 600)[0]["milestone_path"] for seed in (3, 3, 4)
    )
    assert a == b
    assert a != c


def test_a_plan_of_an_arm_loads_what_it_needs_alone(tmp_path):
    """Half of a plan's time is loading: what is loaded for nothing is felt."""
    unneeded = {
        *("scipy", "email", "asyncio", "zipfile", "tempfile", "PIL.JpegImagePlugin"),
        *("evenroad.constraints.keep", "evenroad.world.gridmap.gridmap", "evenroad.planning.planners.growing"),
        *(
            "evenroad.infeasibility.proof",
            "evenroad.loading.mjcf",
            "evenroad.points.measures.l2",
            "evenroad.trajectory",
        ),
    }
    code = f"import sys; from evenroad.cli import main; main(sys.argv[1:]); print({unneeded!r} & set(sys.modules))"
    words = "plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside"
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "set()"
    assert (tmp_path / "box-reach.png").exists()


def test_without_a_picture_nothing_is_drawn_and_what_draws_is_not_even_loaded(tmp_path):
    code = "import sys; from evenroad.cli import main; main(sys.argv[1:]); print('evenroad.viz' in sys.modules)"
    line = [sys.executable, "-c", code, *map(str, plan_arguments(out="a")), "--no-picture"]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "False"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.json"]
    assert "png" not in done.stdout


def test_the_answer_is_there_before_the_picture_is_drawn(run, tmp_path, monkeypatch):
    def fail(*_):
        assert (tmp_path / "a.json").exists()
        raise MemoryError("no room for a picture")

    monkeypatch.setattr("evenroad.viz.plan.save_plan_picture", fail)
    code, out, err = run(*plan_arguments(out="a"))
    assert code == 2
    assert "solved" in out
    assert "no room for a picture" in err


def test_csv_has_one_waypoint_a_row_and_that_of_an_earlier_run_does_not_pass_for_this_ones(answer, tmp_path):
    record, _ = answer(*plan_arguments(), "--csv")
    rows = (tmp_path / "a.csv").read_text().splitlines()
    assert rows[0] == "x,y"
    assert [[float(x) for x in row.split(",")] for row in rows[1:]] == record["path"]
    _, shown = answer(*plan_arguments(sampler="uniform"), "--csv", "-n", 16, code=1)
    assert not (tmp_path / "a.csv").exists()
    assert "a.csv" not in shown


@pytest.mark.parametrize(("out", "name"), [
    (None, "maze1"),
    *((out, "way") for out in ("way", "way.json", "way.png")),
    # A long name that the file system takes, and brackets, which are no markup.
    ("x" * 245, "x" * 245), ("res[bold]x[y]", "res[bold]x[y]"),
])  # fmt: skip
def test_files_have_the_name_that_is_asked_for_or_the_maps(run, tmp_path, out, name):
    code, said, err = run(*plan_arguments(**({} if out is None else {"out": out})))
    assert (code, err) == (0, "")
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"{name}.json", f"{name}.png"]
    assert f"{name}.json" in "".join(said.split())


def test_the_default_name_never_overwrites_the_map_or_its_image(run, room, ros_room):
    before = room.read_bytes()
    assert run(*plan_arguments(room, (5, 5), (5, 25), 2))[0] == 0
    assert (room.parent / "room-plan.png").exists()
    assert run(*plan_arguments(ros_room, (-0.5, 2.5), (-0.5, 4.5), 0.2))[0] == 0
    assert room.read_bytes() == before


def test_a_ros_map_is_planned_in_metres(answer, ros_room):
    record, _ = answer(*plan_arguments(ros_room, (-0.5, 2.5), (-0.5, 4.5), 0.2))
    # The path round the wall leads through the gap at x = 2 .. 3 m, at half the height of the room.
    assert np.array(record["path"])[:, 0].max() > 2.0


def test_a_path_that_is_not_found_exits_with_1_and_says_what_to_try(run, tmp_path):
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


def test_an_invalid_start_names_the_nearest_free_place(answer, room):
    record, _ = answer(*plan_arguments(room, (20, 12), (20, 25), 4), code=1)
    assert "the nearest free position is (20, 10)" in record["message"]


def test_without_a_number_of_points_the_hardest_maze_is_solved(answer):
    maze = load_maze(3)
    record, shown = answer(*plan_arguments(maze.path, maze.start, maze.goal, maze.robot_radius))
    path = np.array(record["path"])
    assert maze.world().motion_valid(path[:-1], path[1:]).all()
    assert record["query"]["n"] is None
    assert "milestones" not in shown


def test_the_nearest_of_several_goals_is_reached_on_a_map(answer, room):
    for extra in ((), ("-n", 64), ("--improve", "--time", 0.2)):
        record, shown = answer(*plan_arguments(room, (5, 5), (5, 25), 2), "--goal", 20, 6, *extra)
        assert record["query"]["goals"] == [[5, 25], [20, 6]]
        assert record["goal_index"] == 1
        assert record["path"][-1] == record["query"]["goal"] == [20, 6]
        assert "to goal 1" in shown


def test_a_disks_path_is_proved_without_being_asked_and_improves_with_time(answer, room):
    line = plan_arguments(room, (5, 5), (5, 25), 2)
    first, _ = answer(*line)
    best, shown = answer(*line, "--improve", "--time", 0.5, "--certified")
    assert "exact: no motion touches anything" in shown
    assert best["proof"] == "exact"
    assert best["cost"] <= first["cost"] == best["stages"][0]["cost"]


def test_that_there_is_no_path_is_proved_where_it_can_be(answer, room):
    # The gap is 10 wide.
    answer(*plan_arguments(room, (12, 7), (12, 23), 5))
    for options in ({}, {"n": 64}):
        record, shown = answer(*plan_arguments(room, (12, 7), (12, 23), 5.05, **options), code=1)
        assert record["status"] == "not_connected"
        assert "proved: there is no path" in shown


def test_points_are_drawn_where_a_mostly_unknown_map_is_free(answer, tmp_path):
    pixels = np.full((400, 400), 205, dtype=np.uint8)
    pixels[30:70, 300:360] = 254
    Image.fromarray(pixels).save(tmp_path / "far.png")
    (tmp_path / "far.yaml").write_text(ROS_MAP.format("far", 0.1, "0, 0"))
    record, _ = answer(*plan_arguments("far.yaml", (31, 35), (35, 34), 0.2, n=128))
    assert record["counts"]["valid"] > 100


def test_clearance_adds_to_the_radius(answer, room):
    answer(*plan_arguments(room, (5, 5), (5, 25), 4))
    record, _ = answer(*plan_arguments(room, (5, 5), (5, 25), 4, clearance=1.5), code=1)
    assert record["query"]["clearance"] == 1.5


BAD = [
    ({"map_path": "nowhere.png"}, "nowhere.png"),
    ({"map_path": "broken.png"}, "broken.png"),
    ({"map_path": "map.txt"}, "map.txt"),
    ({"map_path": "bad-key.yaml"}, "fre_thresh"),
    ({"map_path": "bad-mode.yaml"}, "quaternary"),
    ({"start": (700, 5)}, "start 700 5 lies outside the map"),
    ({"goal": (5, -1)}, "goal 5 -1 lies outside the map"),
    ({"start": ("nan", 5)}, "finite"),
    ({"start": ("x" * 5000,)}, "start must be two finite numbers x y, got 'xxx"),
    ({"radius": 0}, "radius must be a finite number > 0, got 0"),
    ({"radius": -1}, "radius must be a finite number > 0, got -1"),
    ({"clearance": -1}, "clearance"),
    ({"n": 0}, "n must be an integer >= 1, got 0"),
    ({"n": 10**12}, "at most 2147483647"),
    ({"k": 0}, "k must be"),
    ({"connect_radius": 0}, "connection radius"),
    ({"connect_radius": 5, "k": 5}, "not both"),
    ({"seed": -1}, "--seed must be an integer >= 0, got -1"),
    ({"sampler": "best"}, "known: cover, even, .*halton.*sobol"),
    ({"sampler": "mpmc", "n": 9000}, "it has n = 32, 64, 128, 256"),
    ({"sampler": "sukharev", "n": 100_000}, "the nearest are 99856 and 100489"),
    ({"sampler": "uniform", "skip": 5}, "--skip does not go with"),
    ({"time": 0}, "time must be a finite number > 0, got 0"),
    ({"out": "no/where/result"}, "does not exist"),
    ({"out": "."}, "file name"),
    ({"out": "x" * 300}, "cannot write"),
    ({"out": "a" * 5000}, "too long"),
    ({"out": "map.txt/result"}, "map.txt"),
    ({"out": "room", "map_path": "room.png"}, "overwrite the file room.png"),
]


@pytest.mark.parametrize(("changes", "says"), BAD, ids=lambda value: str(value)[:40])
def test_bad_input_gets_one_line_and_exit_code_2_and_nothing_is_written(refuse, tmp_path, room, changes, says):
    (tmp_path / "broken.png").write_bytes(room.read_bytes()[:60])
    (tmp_path / "map.txt").write_text("hello")
    good = ROS_MAP.format("room", 1, "0, 0")
    (tmp_path / "bad-key.yaml").write_text(good + "fre_thresh: 0.1\n")
    (tmp_path / "bad-mode.yaml").write_text(good + "mode: quaternary\n")
    said = refuse(*plan_arguments(**changes))
    assert re.search(says, said)
    assert len(said) < 700


def test_the_record_holds_all_that_is_needed_to_ask_again(answer):
    record, _ = answer(*plan_arguments(sampler="halton"), "--plain", "--skip", 7, "--raw", "-n", 300)
    asked = {"sampler": "halton", "plain": True, "skip": 7, "raw": True, "n": 300}
    assert {key: record["query"][key] for key in asked} == asked


@pytest.mark.parametrize(("error", "code", "says"), [
    (KeyboardInterrupt, 130, "interrupted"),
    (MemoryError("Unable to allocate 3 EiB"), 2, "evenroad: error: not enough memory: Unable to allocate 3 EiB\n"),
])  # fmt: skip
def test_an_interrupt_and_too_little_memory_leave_no_half_file(run, tmp_path, monkeypatch, error, code, says):
    def fail(*_args, **_kwargs):
        raise error

    monkeypatch.setattr("evenroad.cli.plan_parts.solve", fail)
    found, _, err = run(*plan_arguments(out="a", n=64))
    assert (found, err.count("\n")) == (code, 1)
    assert says in err
    assert list(tmp_path.iterdir()) == []


def test_help_is_there_for_every_verb(run):
    for words in (["--help"], *([verb, "--help"] for verb in ABOUT), ["plan", "--robot", "ur5", "-h"]):
        code, out, _ = run(*words)
        assert code == 0
        assert "usage: evenroad" in out
    assert "usage: evenroad" in run()[1]
    assert run("--version")[1].strip() == f"evenroad {er.__version__}"


def test_the_demo_solves_the_level_3_maze(run, tmp_path):
    assert run("demo", "--out", "demo")[0] == 0
    record = json.loads((tmp_path / "demo.json").read_text())
    assert record["status"] == "solved"
    assert record["query"]["map"].endswith("maze3.png")


def test_a_reader_that_goes_away_is_no_error(tmp_path):
    command = [sys.executable, "-m", "evenroad", *map(str, plan_arguments(out="a"))]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.close()
    assert process.stderr.read() == ""
    process.stderr.close()
    assert process.wait() == 0
    assert (tmp_path / "a.png").exists()


def test_a_plan_on_points_says_what_they_guarantee_where_it_is_asked(answer, refuse, room):
    line = plan_arguments(room, (3, 3), (3, 27), 1.0)
    asked = (*line, "--sampler", "cover", "-k", 20, "-n", 256)
    _, plain = answer(*asked)
    record, shown = answer(*asked, "--guarantees")
    planner = er.PRM(draw("cover", 256, 2), rule=KNearest(20), certify=True)
    certificate = er.plan(er.load_map(room).world(1.0), (3, 3), (3, 27), planner).certificate
    assert "guaranteed" not in plain
    assert "a path exists" not in plain
    assert f"if one of clearance {certificate.dispersion:.6g} does" in shown
    assert record["certificate"]["complete"]
    assert record["certificate"]["dispersion"] == certificate.dispersion
    assert record["certificate"]["clearance_for_factor"]["2"] == certificate.clearance_for(2.0)
    said = "--guarantees goes with a roadmap of points: give their number with -n"
    assert said in refuse(*line, "--guarantees")
