"""Free means free: every public planner's paths, shortened or not, beside independent oracles.

The large version is ``python -m studies.benchmarks.paths_oracle``.
"""

import pytest

from evenroad.collision.certified import CertifiedWorld
from evenroad.robot import ArmWorld
from tests.robots.kernel_arms import random_scene, random_tree, seven_joint_arm, ur5
from tests.studies.free_paths import PLANNERS, disk_world, nearest, planners_of, queries, solid_world

LOOSE = random_scene(1000, count=10, spread=1.0, clear=0.35)
WORLDS = {
    "disk": disk_world(0),
    "SE(2)": solid_world(1, "SE(2)"),
    "SE(3)": solid_world(2, "SE(3)"),
    "boxes": solid_world(3, "boxes"),
    "UR5": ArmWorld(ur5(3.14), LOOSE),
    "UR5, certified": CertifiedWorld(ArmWorld(ur5(3.14), LOOSE)),
    "seven joints": ArmWorld(seven_joint_arm(), random_scene(1003, count=6, spread=1.0, clear=0.4)),
    "tree": ArmWorld(random_tree(8), random_scene(108, spread=0.7, clear=0.45)),
}


@pytest.mark.parametrize("name", WORLDS)
def test_no_planner_hands_out_a_path_that_touches(name):
    world = WORLDS[name]
    solved = dict.fromkeys(planners_of(world), 0)
    seen = set()
    for start, goal in queries(world, 8):
        for planner in solved:
            result = PLANNERS[planner](world, start, goal, smooth=True)
            if not result.solved:
                continue
            solved[planner] += 1
            assert result.proof in ("exact", "certified")
            assert world.motion_valid(result.path[:-1], result.path[1:]).all()
            for path in (result.path, result.milestone_path):
                if path.tobytes() not in seen:
                    seen.add(path.tobytes())
                    assert nearest(world, path) > 0.0, planner
        if min(solved.values()) >= 2:
            break
    assert min(solved.values()) >= 1, solved
