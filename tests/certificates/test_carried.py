"""What a checker does not read is carried as plain files: scenes and robots of other formats, and stages of a task."""

import subprocess

import numpy as np
import pytest
import trimesh

import evenroad as er
from evenroad.certificates.certify import certify
from evenroad.certificates.sources import Sources
from evenroad.cli import main
from evenroad.errors import InvalidValue, NotAvailable
from evenroad_verify.certificate import read_certificate
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import main as verify
from evenroad_verify.errors import BadInput, Refused
from tests.certificates.checker_in_c import program
from tests.certificates.small import URDF, sources_in
from tests.certificates.written import accepts, box_reach, with_digest

POST = "*  post\n1\ncylinder\n0.05 {height}\n{x} 0 0\n0 0 0 1\n0 0 0 0\n.\n"
OBJECT = """world:
  collision_objects:
    - id: post
      header: {{frame_id: base}}
      primitives: [{{type: cylinder, dimensions: [{height}, 0.05]}}]
      primitive_poses: [{{position: [{x}, 0, 0], orientation: [0, 0, 0, 1]}}]
"""
INCLUDED = """<robot name="post"><link name="post"><collision>
  <geometry><cylinder radius="0.05" length="{height}"/></geometry></collision></link></robot>"""
SCENES = {
    "cloud.yaml": "obstacles:\n  scan: {{shape: cloud, file: scan.xyz, radius: 0.05, xyz: [{x}, 0, 0], "
    "clearance: 0.01}}\n",
    "open.yaml": "obstacles:\n  scan: {{shape: cloud, file: scan.xyz, radius: 0.05, xyz: [{x}, 0, 0]}}\n"
    "allowed:\n  scan: [{{link: ball, within: {{shape: sphere, radius: 0.1, xyz: [9, 0, 0]}}}}]\n",
    "ground.yaml": "obstacles:\n  ground: {{shape: height_map, file: ground.npy, spacing: 0.1, depth: 1, "
    "xyz: [{x}, 0, 0]}}\n",
    "included.yaml": "obstacles:\n  post: {{include: post.urdf, xyz: [{x}, 0, 0]}}\n",
    "kitchen.yaml": "obstacles:\n  kitchen: {{include: ball.glb, xyz: [{x}, 0, 0]}}\n",
    "anchors.yaml": "obstacles:\n  post: {{shape: sphere, radius: &r 0.05, xyz: [{x}, 0, 0]}}\n",
    "moveit.scene": "(noname)+\n" + POST.replace("{height}", "0.4"),
    "planning.yaml": OBJECT.replace("{height}", "0.4"),
}


def _files_in(folder):
    (folder / "post.urdf").write_text(INCLUDED.format(height=0.4))
    np.savetxt(folder / "scan.xyz", np.array([[0, 0, 0], [0, 0, 0.1], [0, 0, -0.1]]))
    np.save(folder / "ground.npy", np.array([[0.0, 0.05], [0.0, 0.0]]))
    trimesh.creation.icosphere(1, 0.05).export(folder / "ball.glb")


@pytest.mark.filterwarnings("ignore:.*is taken as the robot's root link")
@pytest.mark.parametrize("name", SCENES)
def test_a_scene_of_any_kind_is_carried_and_proved(name, tmp_path, capsys):
    _files_in(tmp_path)
    sources = sources_in(tmp_path, "obstacles: {}\n")
    for x, free in ((1.25, True), (1.05, False)):
        (tmp_path / name).write_text(SCENES[name].format(x=x))
        scene = er.load_scene(tmp_path / name)
        world = er.ArmWorld(er.robot.in_scene(er.load_robot(sources.robot), scene), scene)
        where = Sources(sources.robot, tmp_path / name)
        if not free:
            with pytest.raises(InvalidValue, match="ball touches an obstacle"):
                certify(world, np.array([[-0.4], [0.4]]), where, tmp_path / "arm.cert")
            continue
        certify(world, np.array([[-0.4], [0.4]]), where, tmp_path / "arm.cert")
        # The scene's own file may be given, and is compared with what was read.
        words = [str(tmp_path / "arm.cert"), str(sources.robot)]
        assert verify(words) == verify([*words, str(tmp_path / name)]) == 0
        assert "that what the certificate carries is the robot, or the scene, that is meant: scene" in (
            capsys.readouterr().out
        )
        assert verify([*words, str(tmp_path / "post.urdf")]) == 1
        assert "was not read from" in capsys.readouterr().out


def test_what_is_carried_can_be_written_and_read_by_evenroad(tmp_path):
    _files_in(tmp_path)
    sources = sources_in(tmp_path, SCENES["cloud.yaml"].format(x=1.25))
    scene = er.load_scene(sources.scene)
    world = er.ArmWorld(er.load_robot(sources.robot), scene)
    certify(world, np.array([[-0.4], [0.4]]), Sources(sources.robot, embed=True), tmp_path / "arm.cert")
    assert verify([str(tmp_path / "arm.cert"), "--write", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "robot.urdf").read_text() == URDF
    assert er.load_scene(tmp_path / "out" / "scene.yaml").fingerprint() == scene.fingerprint()


def test_carried_files_are_written_once_accepted_and_under_names_of_their_own(tmp_path):
    """Two meshes go by one name in two folders; a file of which a byte was changed writes nothing."""
    for folder, radius in (("one", 0.05), ("two", 0.1)):
        (tmp_path / folder).mkdir()
        trimesh.creation.icosphere(1, radius).export(tmp_path / folder / "ball.stl")
    mesh = "  {}: {{shape: mesh, file: {}/ball.stl, xyz: [{}, 0, 0]}}\n"
    placed = [mesh.format(*each) for each in (("a", "one", 1.3), ("b", "two", -1.3), ("c", "one", 1.5))]
    sources = sources_in(tmp_path, "obstacles:\n" + "".join(placed))
    world = er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))
    certify(world, np.array([[-0.1], [0.1]]), Sources(sources.robot, sources.scene, embed=True), tmp_path / "own.cert")
    meshes = {"ball.stl": tmp_path / "one" / "ball.stl", "2-ball.stl": tmp_path / "two" / "ball.stl"}
    data = (tmp_path / "own.cert").read_bytes()
    for name, (code, content) in {"own": (0, data), "broken": (1, data.replace(b"radius=", b"radius ="))}.items():
        (tmp_path / f"{name}.cert").write_bytes(content)
        for number, check in enumerate((verify, in_c)):
            out = tmp_path / f"{name}{number}"
            assert check([str(tmp_path / f"{name}.cert"), "--write", str(out)]) == code
            if code:
                assert not out.exists()
                continue
            assert {each.name for each in out.iterdir()} == {*meshes, "robot.urdf", "robot.srdf", "scene.yaml"}
            assert all((out / each).read_bytes() == file.read_bytes() for each, file in meshes.items())


def in_c(words):
    """Return the exit code of the checker in C."""
    return subprocess.run([program("command"), *words], capture_output=True).returncode


BALL = '<collision><geometry><sphere radius="2"/></geometry></collision>'
PLANAR = '<link name="map"/><joint name="drive" type="{}"><parent link="map"/><child link="base"/></joint>'
ROBOTS = {
    "arm.urdf.xacro": URDF.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ').replace(
        'radius="0.1"', 'radius="${0.2 / 2}"'
    ),
    "planar.urdf": URDF.replace("<link", PLANAR.format("planar") + "<link", 1),
    "floating.urdf": URDF.replace("<link", PLANAR.format("floating") + "<link", 1),
    "prefix.urdf": URDF.replace("</robot>", "<drake:joint/></robot>"),
    "capsule.urdf": URDF.replace('<sphere radius="0.1"/>', '<capsule radius="0.1" length="0.05"/>'),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_robots_of_other_formats_and_moving_bases_are_proved(name, tmp_path):
    (tmp_path / name).write_text(ROBOTS[name])
    (tmp_path / "scene.yaml").write_text("obstacles:\n  post: {shape: sphere, radius: 0.05, xyz: [1.25, 0, 0]}\n")
    base = {"planar.urdf": "drive,turn", "floating.urdf": "drive,turn"}
    robot = er.load_robot(tmp_path / name, group=base.get(name))
    world = er.ArmWorld(er.robot.in_scene(robot, er.load_scene(tmp_path / "scene.yaml")), tmp_path / "scene.yaml")
    first = np.zeros(len(robot.group))
    first[-1] = -0.4
    path = np.array([first, first + 0.8 * np.eye(len(first))[-1]])
    path[:, :-1] += np.linspace(0.0, -0.01, 2)[:, None]
    certify(world, path, Sources(tmp_path / name, tmp_path / "scene.yaml"), tmp_path / "arm.cert")
    data = (tmp_path / "arm.cert").read_bytes()
    carries = name != "capsule.urdf"
    assert (b"\nrobot " in data) == carries
    words = [] if carries else [str(tmp_path / name)]
    assert verify([str(tmp_path / "arm.cert"), *(words or ["-"]), str(tmp_path / "scene.yaml")]) == 0


def test_pairs_of_links_that_a_robot_without_srdf_does_not_test_are_named_in_one(tmp_path, capsys):
    neck = URDF.replace('<link name="base"/>', f'<link name="base">{BALL}</link><link name="neck"/>').replace(
        '<parent link="base"/>', '<parent link="neck"/>'
    )
    nod = """<joint name="nod" type="revolute"><parent link="base"/><child link="neck"/>
      <limit lower="-1" upper="1"/></joint></robot>"""
    sources = sources_in(tmp_path, "obstacles: {}\n", neck.replace("</robot>", nod))
    world = er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))
    assert not world.robot.pairs
    certify(world, np.array([[0.0, 0.0], [0.1, 0.1]]), sources, tmp_path / "arm.cert")
    assert verify([str(tmp_path / "arm.cert"), str(sources.robot), str(sources.scene)]) == 0
    assert "1 that the SRDF disables" in capsys.readouterr().out


def _embedded(folder):
    sources = box_reach().sources
    certify(box_reach().world, box_reach().path, Sources.named("ur5", "box-reach", embed=True), folder / "own.cert")
    assert sources.srdf is not None
    return (folder / "own.cert").read_bytes()


def inputs_in(data):
    """Return what a certificate carries."""
    return read_inputs(None, None, None, {}, read_certificate(data))


def test_a_certificate_that_carries_all_needs_no_file(tmp_path):
    data = _embedded(tmp_path)
    assert accepts(data, inputs_in(data))
    assert verify([str(tmp_path / "own.cert")]) == 0
    files = [box_reach().sources.robot.read_bytes(), box_reach().sources.srdf.read_bytes()]
    assert [content for _, content in inputs_in(data).carried][:2] == files


def test_files_that_are_cut_off_left_over_or_changed_are_refused(tmp_path):
    data = _embedded(tmp_path)
    rng = np.random.default_rng(0)
    for other in (data[:-1], data[:-200], data + b"x", data + bytes(8), data + b"\xff" * 9):
        with pytest.raises(Refused):
            inputs_in(other)
    begin = data.index(b"<robot")
    for place in rng.integers(begin, len(data), size=40):
        changed = bytearray(data)
        changed[place] ^= 1
        try:
            assert not accepts(bytes(changed), inputs_in(bytes(changed)))
        except (Refused, BadInput):
            continue


def test_a_worse_scene_within_a_certificate_is_refused_even_with_a_new_digest(tmp_path):
    data = _embedded(tmp_path)
    text = box_reach().sources.scene.read_bytes()
    worse = text.replace(
        b"size: [0.41, 0.01, 0.36], xyz: [0.705, 0.185", b"size: [0.41, 0.21, 0.36], xyz: [0.705, 0.185"
    )
    assert worse != text
    forged = data.replace(text, worse)
    assert not accepts(forged, inputs_in(forged))
    forged = with_digest(forged, inputs_in(forged))
    assert not accepts(forged, inputs_in(forged))


TASK = """robot: ur5
scene:
  obstacles:
    table: {shape: box, size: [1.0, 1.4, 0.05], xyz: [0.5, 0, -0.03]}
    can: {shape: cylinder, radius: 0.03, length: 0.12, xyz: [0.5, 0.2, 0.06]}
  allowed: {table: [base_link, shoulder_link]}
start: home
steps:
  - move_to: {poses: ["0.5 0.2 0.142 3.14159 0 0"], free_axis: z, approach: 0.1}
  - attach: can
  - move_to: {poses: ["0.5 -0.3 0.061 0 0 0"], tip: can, free_axis: z, retreat: 0.05, approach: 0.05, away: up}
  - detach: {object: can, onto: [table]}
"""


def test_a_task_has_a_certificate_of_each_motion_with_what_is_held_then(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "task.yaml").write_text(TASK)
    assert main(["run", "task.yaml", "--certificate", "task.cert"]) == 0
    assert "task.1.cert to task.5.cert of the trajectory's motions" in capsys.readouterr().out
    said = []
    for number in range(1, 6):
        words = [f"task.{number}.cert", str(box_reach().sources.robot), "-", str(box_reach().sources.srdf)]
        assert verify(words) == 0
        said.append(capsys.readouterr().out)
    assert "can with wrist_3_link" in said[1]
    assert "can - the obstacles" in said[3]
    # While it is set down the can may touch the table, but what lies 5 mm inside of it may not.
    assert "table with can" in said[4]
    assert "can less 5 mm" in said[4]


def test_an_option_about_certificates_goes_with_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "task.yaml").write_text(TASK)
    assert main(["run", "task.yaml", "--embed"]) == 2
    assert "--embed goes with --certificate" in capsys.readouterr().err


def test_an_obstacle_with_the_name_of_a_link_that_a_held_object_may_touch_has_no_certificate(tmp_path):
    """In the scene that is carried, the name would allow the obstacle, too."""
    sources = sources_in(tmp_path, "obstacles: {}\n")
    held = er.load_robot(sources.robot).holding(er.Sphere(0.02, xyz=(0, 0, 0.3)), "ball", touches=["base"])
    for name in ("base", "post"):
        world = er.ArmWorld(held, er.Scene([er.Sphere(0.05, xyz=(3, 0, 0), name=name)]))
        if name == "post":
            certify(world, np.array([[-0.4], [0.4]]), Sources(sources.robot), tmp_path / "arm.cert")
            assert verify([str(tmp_path / "arm.cert"), str(sources.robot)]) == 0
            continue
        with pytest.raises(NotAvailable, match=r"'held' may touch the link 'base', .*: rename the obstacle"):
            certify(world, np.array([[-0.4], [0.4]]), Sources(sources.robot), tmp_path / "arm.cert")
