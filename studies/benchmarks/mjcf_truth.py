"""Verdicts on MJCF robots' self-collision against MuJoCo's own list of contacts.

    python -m studies.benchmarks.mjcf_truth OUT.csv ROBOT.xml FOLDER ...

For each robot: how many configurations that we call free MuJoCo finds in contact by more than a micrometre (uniform
ones, others bisected to our edge of contact, and states of ten paths), and how many are blocked here and there.  In
MuJoCo every contact counts that a joint which moves here could undo, but those of pairs of bodies that touch in every
uniform configuration.
"""

from __future__ import annotations

import time
from pathlib import Path

import mujoco
import numpy as np
from studies.benchmarks.robot_truth import at_contact, path_states
from studies.benchmarks.rows import row_per_robot

from evenroad.robot import ArmWorld, Robot, Scene, joint_values, load_model
from evenroad.robots.pairs import rigid_links

COUNT = 800
DEEP = 1e-6
FIELDS = (
    *("robot", "dim", "bodies", "tested", "dropped_touching", "configurations", "truth_blocked", "blocked"),
    *("beyond", "free_that_collide", "at_contact", "at_contact_that_collide"),
    *("path_states", "path_states_that_collide", "deepest_mm", "load_s", "note"),
)


class Truth:
    """A robot as MuJoCo compiles it."""

    def __init__(self, file: Path, robot: Robot) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(file))
        self.data = mujoco.MjData(self.model)
        self.robot = robot
        rigid = rigid_links(robot)
        self.rigid = [rigid[self._name("body", i)] for i in range(self.model.nbody)]
        self.left_out: set[tuple[int, int]] = set()

    def _name(self, what: str, number: int) -> str:
        return getattr(self.model, what)(number).name or f"{what}_{number}"

    def contacts(self, q: np.ndarray) -> list[dict[tuple[int, int], float]]:
        """Return for each configuration how deep which two bodies are in each other [m]."""
        values, found = joint_values(self.robot, q), []
        for row in range(len(q)):
            self.data.qpos[:] = self.model.qpos0
            for number in range(self.model.njnt):
                if self._name("joint", number) in values:
                    self.data.qpos[self.model.jnt_qposadr[number]] = values[self._name("joint", number)][row]
            mujoco.mj_kinematics(self.model, self.data)
            mujoco.mj_comPos(self.model, self.data)
            mujoco.mj_collision(self.model, self.data)
            deep: dict[tuple[int, int], float] = {}
            for contact in self.data.contact:
                first, second = sorted(int(self.model.geom_bodyid[geom]) for geom in contact.geom)
                if self.rigid[first] != self.rigid[second] and (first, second) not in self.left_out:
                    deep[first, second] = max(deep.get((first, second), -np.inf), -float(contact.dist))
            found.append(deep)
        return found

    def depths(self, q: np.ndarray) -> np.ndarray:
        """Return how deep the deepest contact of each configuration is [m]; -inf where there is none."""
        return np.array([max(deep.values(), default=-np.inf) for deep in self.contacts(q)])


def measured(file: Path, rng: np.random.Generator) -> dict[str, object]:
    """Return the row of one robot."""
    began = time.perf_counter()
    model = load_model(file)
    load_s = time.perf_counter() - began
    robot = model.robot
    world = ArmWorld(robot, Scene((), name="empty"))
    truth = Truth(file, robot)
    q = world.space.from_cube(rng.random((COUNT, world.space.cube_dim)))
    free = world.valid(q)
    found = truth.contacts(q)
    truth.left_out = set.intersection(*(set(deep) for deep in found))
    depths = truth.depths(q)
    collides = depths > DEEP
    deepest = [depths[free].max(initial=0.0)]
    row: dict[str, object] = {
        "robot": f"{file.parent.name}/{file.stem}",
        "dim": len(robot.group),
        "bodies": truth.model.nbody,
        "tested": len(robot.pairs),
        "dropped_touching": sum("touch" in why for _, _, why in model.dropped),
        "configurations": COUNT,
        "truth_blocked": round(100 * collides.mean(), 2),
        "blocked": round(100 * (~free).mean(), 2),
        "beyond": round(100 * (~free & ~collides).mean(), 2),
        "free_that_collide": int((free & collides).sum()),
        "load_s": round(load_s, 1),
        "note": "; ".join(model.notes)[:200],
    }
    if free.any() and not free.all():
        edge = truth.depths(at_contact(world, q[free], q[~free], COUNT, rng))
        deepest.append(edge.max(initial=0.0))
        row |= {"at_contact": len(edge), "at_contact_that_collide": int((edge > DEEP).sum())}
    if free.sum() > 1:
        states = truth.depths(path_states(world, q[free]))
        deepest.append(states.max(initial=0.0))
        row |= {"path_states": len(states), "path_states_that_collide": int((states > DEEP).sum())}
    return row | {"deepest_mm": round(1e3 * max(deepest), 4)}


def main() -> None:
    """Write a row for each robot as soon as it is there."""
    row_per_robot(
        FIELDS,
        "robot.xml",
        lambda file: measured(file, np.random.default_rng(0)),
        lambda file: f"{file.parent.name}/{file.stem}",
    )


if __name__ == "__main__":
    main()
