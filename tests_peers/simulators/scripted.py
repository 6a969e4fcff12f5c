"""Run a scripted task of ManiSkill with mplib or with our planner of its names, and say how often it was solved.

``python -m tests_peers.simulators.scripted evenroad PickCube 20``; `make test-simulators` says which environment.
"""

import importlib
import re
import sys
import time

import numpy as np

TIMES: list[float] = []


def timed(kind):
    """Note the processor time of a planner's calls."""

    def note(method):
        def call(*args, **options):
            began = time.process_time()
            answer = method(*args, **options)
            TIMES.append(time.process_time() - began)
            return answer

        return call

    for name in ("plan_screw", "plan_qpos_to_pose"):
        setattr(kind, name, note(getattr(kind, name)))


def solved(which, task, seeds):
    """Return with how many of the first seeds a task of the Panda succeeds."""
    if which == "evenroad":
        sys.modules["mplib"] = importlib.import_module("evenroad.adapters.mplib")
    timed(importlib.import_module("mplib").Planner)
    importlib.import_module("mani_skill.envs")
    script = re.sub(r"(?<!^)([A-Z])", r"_\1", task).lower()
    solve = importlib.import_module(f"mani_skill.examples.motionplanning.panda.solutions.{script}").solve
    env = importlib.import_module("gymnasium").make(
        f"{task}-v1", obs_mode="none", control_mode="pd_joint_pos", sim_backend="cpu", render_backend="none"
    )
    count = 0
    for seed in range(seeds):
        last = solve(env, seed=seed, debug=False, vis=False)
        count += last != -1 and bool(np.asarray(last[-1]["success"]).all())
    return count


if __name__ == "__main__":
    which, task, seeds = sys.argv[1], sys.argv[2], int(sys.argv[3])
    count = solved(which, task, seeds)
    middle, most = 1e3 * np.median(TIMES), 1e3 * max(TIMES)
    print(f"{which} {task}: {count} of {seeds}; {len(TIMES)} plans, {middle:.1f} ms in the median, {most:.0f} at most")
