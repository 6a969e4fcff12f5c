"""Tables that are compared with certificates: both checkers read them alike, and their spline keeps to the curves."""

import subprocess

import numpy as np
import pytest

import evenroad as er
from evenroad.certificates.certify import certify
from evenroad_verify.command import main as verify
from tests.certificates.checker_in_c import program
from tests.certificates.small import sources_in

GANTRY = """<robot name="gantry"><link name="base"/><link name="beam"/>
  <link name="ball"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="x" type="prismatic"><parent link="base"/><child link="beam"/><axis xyz="1 0 0"/>
    <limit lower="-5" upper="5"/></joint>
  <joint name="y" type="prismatic"><parent link="beam"/><child link="ball"/><axis xyz="0 1 0"/>
    <limit lower="-5" upper="5"/></joint></robot>
"""
TABLE = "time [s],x [rad or m],y\n0,0,0\n1,1,0\n2,1,1\n"


class Gantry:
    """A ball that goes along x, then along y, past a post at the inner side of the corner; both commands judge it."""

    def __init__(self, folder, *lines):
        post = "obstacles:\n  post: {shape: sphere, radius: 0.05, xyz: [0.875, 0.125, 0]}\n"
        self.folder, sources = folder, sources_in(folder, post, GANTRY)
        world = er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))
        certify(world, np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), sources, folder / "gantry.cert")
        data = (folder / "gantry.cert").read_bytes()
        more = "".join(f"{line}\n" for line in lines).encode()
        (folder / "gantry.cert").write_bytes(data.replace(b"degree ", more + b"degree "))
        self.words = [str(folder / "gantry.cert"), str(sources.robot), str(sources.scene)]

    def judged(self, table, capsys):
        """Return the exit codes of both commands for a table."""
        (self.folder / "go.csv").write_bytes(table.encode())
        words = [*self.words, "--path", str(self.folder / "go.csv")]
        codes = verify(words), subprocess.run([program("command"), *words], capture_output=True).returncode
        capsys.readouterr()
        return codes


@pytest.mark.parametrize(
    ("lines", "code"), [((), 0), (("tolerance 0.005",), 0), (("limit 1 1 x", "limit 1 1 y", "tolerance 0.005"), 1),
                        (("limit 1 1 x",), 1)], ids=["path", "tolerance", "limits", "limits without"]
)  # fmt: skip
def test_limits_hold_of_no_spline_that_leaves_the_curves(lines, code, tmp_path, capsys):
    """The spline of the table goes through the post: it cuts the corner by an eighth of the root of 2."""
    assert Gantry(tmp_path, *lines).judged(TABLE, capsys) == (code, code)


def test_limits_of_a_spline_that_has_just_room_are_accepted(tmp_path, capsys):
    gantry = Gantry(tmp_path, "limit 10 100 x", "limit 10 100 y", "tolerance 0.005")
    for steps, code in ((40, 0), (30, 1)):
        # Rows cut nothing, and their second difference is largest in the corner: root of 2 of a step.
        along = np.linspace(0.0, 1.0, steps + 1)
        rows = np.concatenate([np.column_stack([along, 0 * along]), np.column_stack([0 * along + 1, along])[1:]])
        table = "\n".join(["time [s],x,y", *(f"{0.25 * i},{x!r},{y!r}" for i, (x, y) in enumerate(rows.tolist()))])
        assert (2.0**0.5 / steps / 8.0 < 0.005) is (code == 0)
        assert gantry.judged(table, capsys) == (code, code)


@pytest.mark.parametrize(
    ("table", "code"),
    [
        (TABLE.replace("\n", "\r"), 0),
        (TABLE.replace("\n", "\r\n"), 0),
        ("\n" + TABLE, 0),
        ("x,time [s],x [rad or m],y\n9,0,0,0\n9,1,1,0\n9,2,1,1\n", 1),
        ("z,z,time [s],x,y\n9,0,0,0,0\n9,0,1,1,0\n9,0,2,1,1\n", 1),
        (TABLE.replace("1,1,0", "1,1,0_0"), 2),
        (TABLE.replace("1,1,0", "1,\u0661,0"), 2),
        (TABLE.replace("1,1,0", "nan,1,0"), 2),
        (TABLE.replace("1,1,0", "1e400,1,0"), 2),
        (TABLE + "\0", 2),
        (TABLE.split("\n")[0], 1),
        ("", 2),
    ],
    ids=["CR", "CRLF", "a blank line", "a joint twice", "another joint twice", "an underscore", "other digits", "nan",
         "too large", "a zero byte", "no rows", "nothing"],
)  # fmt: skip
def test_both_read_the_same_tables(table, code, tmp_path, capsys):
    assert Gantry(tmp_path).judged(table, capsys) == (code, code)


def test_numbers_of_other_scripts_are_none_for_both(tmp_path, capsys):
    assert Gantry(tmp_path, "tolerance 0.00\u0665").judged(TABLE, capsys) == (1, 1)
