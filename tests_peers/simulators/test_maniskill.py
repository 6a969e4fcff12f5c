"""ManiSkill's scripted tasks of the Panda, unchanged, with our planner of mplib's names.

SAPIEN needs a Vulkan device, also for physics on the processor alone.
"""

import os
import subprocess
import sys

import pytest

pytest.importorskip("mani_skill", reason="mani_skill is not installed: pip install mani_skill")

SEEDS = int(os.environ.get("EVENROAD_SEEDS", "5"))


@pytest.mark.parametrize("task", ["PickCube", "StackCube", "PushCube", "PullCube", "PlugCharger"])
def test_a_scripted_task_is_solved(task):
    command = [sys.executable, "-m", "tests_peers.simulators.scripted", "evenroad", task, str(SEEDS)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if "rendering device" in ran.stderr:
        pytest.skip("SAPIEN finds no Vulkan device")
    assert f"{task}: {SEEDS} of {SEEDS}" in ran.stdout, ran.stderr
