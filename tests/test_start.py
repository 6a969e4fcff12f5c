"""A program that plans loads what it uses, and little else: each module costs a millisecond, each library far more."""

import subprocess
import sys

import pytest

PLAN = "import evenroad as er; result = er.plan('box-reach', 'home', 'inside', robot='ur5')"
NOT_OF_AN_ARM = (
    *(
        "scipy",
        "PIL",
        "trimesh",
        "logging",
        "difflib",
        "decimal",
        "evenroad.driving.car_space",
        "evenroad.world.gridmap",
    ),
    *("evenroad.loading.xacro.expand", "evenroad.roadmap.rules", "evenroad.planning.planners.prm"),
    *("evenroad.planning.world_roadmap", "evenroad.poses.inverse_kinematics", "evenroad.scenes.planning_scene"),
    *("evenroad.constraints.keep", "evenroad.infeasibility.proof", "evenroad.trajectory.make"),
)
NOT_OF_ITS_PICTURE = ("scipy", "trimesh", "matplotlib", "evenroad.driving.car_world", "evenroad.world.gridmap")


def loaded(program):
    """Names of the modules that a program leaves loaded."""
    shown = f"{program}\nimport sys; print(*sys.modules)"
    return set(subprocess.run([sys.executable, "-c", shown], capture_output=True, text=True, check=True).stdout.split())


@pytest.mark.parametrize(
    ("program", "unused"),
    [
        ("import evenroad", ("numpy", "evenroad._native", "evenroad.planning", "evenroad._hints")),
        (
            "import sys, contextlib; sys.argv = ['evenroad', '--version']; from evenroad.cli import main\n"
            "with contextlib.suppress(SystemExit), contextlib.redirect_stdout(sys.stderr): main()",
            ("numpy", "scipy", "argparse", "evenroad.planning", "evenroad._native", "evenroad.cli.plan"),
        ),
        (PLAN, NOT_OF_AN_ARM),
        (f"{PLAN}; result.plot()", NOT_OF_ITS_PICTURE),
    ],
    ids=["import", "version", "plan", "picture"],
)
def test_a_program_loads_nothing_that_it_does_not_use(program, unused):
    assert sorted(set(unused) & loaded(program)) == []


def test_the_collector_runs_again_once_a_name_is_loaded():
    program = "import gc; import evenroad as er; er.Box; on = gc.isenabled(); gc.disable(); er.Sphere, er.plan"
    assert subprocess.run(
        [sys.executable, "-c", f"{program}; print(on, gc.isenabled())"], capture_output=True, text=True
    ).stdout.split() == ["True", "False"]
