"""The paper's experiment: a UR5 planned for with Klamp't's own checker, its timed path driven in Klamp't's physics.

    python -m studies.benchmarks.klampt_simulation [--deviation 0.05] [--margin 0.005] [--out klampt_simulation]

Says how far the simulated arm is from where it should be, and with what it is in contact, and writes a picture of the
way there and the numbers.  The arm is simulated with the masses of a UR5, its links' inertias about those of its
capsules, and a controller that tracks place and speed.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import klampt
import numpy as np
import numpy.typing as npt
from PIL import Image
from tests_peers.engines.klampt_world import KlamptWorld, _geometry, _merged_obstacles
from tests_peers.engines.surface import link_surfaces

from evenroad._files import atomic_write
from evenroad.planning import plan
from evenroad.planning.read_problem import arm_problem
from evenroad.robot import Scene
from evenroad.robots.kinematics import joint_values
from evenroad.trajectory import Trajectory, limits_of, make_trajectory
from evenroad.viz.arm import ArmScene

MASSES = {
    "shoulder_link": 3.7,
    "upper_arm_link": 8.393,
    "forearm_link": 2.275,
    "wrist_1_link": 1.219,
    "wrist_2_link": 1.219,
    "wrist_3_link": 0.1879,
}
"""Of the links of a UR5 [kg]."""

TORQUES = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)
"""The most of each joint [N m]."""

FREQUENCY = 60.0
"""Of the servo: what is off comes back critically damped, whatever a joint carries in the posture [rad/s]."""

SUBSTEP = 0.001
SETTLE = 0.5
"""Seconds after the last state in which the arm comes to rest."""

RESOLUTION = 0.005
"""Of the motions that are planned: states of the timed path are no farther apart than three times that [rad]."""

MARGIN = 0.3
"""How much farther than on its path a simulated joint can go [rad]."""

PICTURES = 6
Array = npt.NDArray[np.float64]


def simulate(world: KlamptWorld, trajectory: Trajectory) -> tuple[Array, Array, set[tuple[str, str]]]:
    """Return times, simulated configurations, (n, dim), and the pairs of bodies that were in contact."""
    model, robot = world._model, world.robot
    surfaces = link_surfaces(world._shapes)
    obstacles = {}
    for i, (links, surface) in enumerate(_merged_obstacles(world.scene, surfaces).items()):
        # What a link is allowed to touch is its mount: in physics it would push the arm away.
        if links == frozenset(surfaces):
            body = world._world.makeTerrain(f"obstacles {i}")
            body.geometry().set(_geometry(klampt, surface))
            obstacles[body.getID()] = body.getName()
    for i in range(model.numLinks()):
        body, about = model.link(i), klampt.Mass()
        mass = MASSES.get(body.getName(), 0.1)
        extent = np.full(3, 0.05)
        if body.getName() in surfaces:
            corners = surfaces[body.getName()].vertices
            low, high = corners.min(axis=0), corners.max(axis=0)
            extent = high - low
            about.setCom((0.5 * (high + low)).tolist())
        inertia = np.diag(mass / 12.0 * (np.sum(extent**2) - extent**2))
        about.setMass(mass)
        about.setInertia(inertia.ravel().tolist())
        body.setMass(about)
    places = [model.link(joint.child).getIndex() for joint in robot.joints if joint.name in robot.group]
    order = [robot.group.index(joint.name) for joint in robot.joints if joint.name in robot.group]

    def everything(rows: Array, values: bool) -> Array:
        whole = np.zeros((len(rows), model.numLinks()))
        named = joint_values(robot, rows) if values else dict(zip(robot.group, rows.T, strict=True))
        for joint in robot.joints:
            if joint.name in named:
                whole[:, model.link(joint.child).getIndex()] = named[joint.name]
        return whole

    q, velocities, pushes = (
        everything(rows, i == 0)
        for i, rows in enumerate((trajectory.positions, trajectory.velocities, trajectory.accelerations))
    )
    driven = [model.driver(i).getAffectedLink() for i in range(model.numDrivers())]
    # As a UR's controller does: the torques that the model says are needed, and a servo for what is left.
    forward, inertias = [], []
    for row, speed, push in zip(q, velocities, pushes, strict=True):
        model.setConfig(row.tolist())
        model.setVelocity(speed.tolist())
        forward.append(np.array(model.torquesFromAccel(push.tolist())) + model.getGravityForces((0.0, 0.0, -9.81)))
        inertias.append(np.diag(model.getMassMatrix())[driven])
    torques = np.zeros(model.numLinks())
    torques[places] = np.array(TORQUES)[order]
    model.setTorqueLimits(torques.tolist())
    # Of a joint that can turn wholly Klamp't knows the place within one turn only, and drives it the wrong way round.
    model.setJointLimits((q.min(axis=0) - MARGIN).tolist(), (q.max(axis=0) + MARGIN).tolist())
    model.setConfig(q[0].tolist())
    simulation = klampt.Simulator(world._world)
    # The planner has seen to the pairs that can touch; of neighbours, whose bodies overlap, physics would make springs.
    simulation.setSetting("robotSelfCollisions", "0")
    controller = simulation.controller(0)
    controller.setRate(SUBSTEP)
    step = float(trajectory.times[1])
    simulation.setSimStep(SUBSTEP)
    for id_ in obstacles:
        for link in range(model.numLinks()):
            simulation.enableContactFeedback(id_, model.link(link).getID())
    times, seen, touched = [], [], set()
    last = len(q) - 1
    model.setConfig(q[-1].tolist())
    model_gravity = np.array(model.getGravityForces((0.0, 0.0, -9.81)))
    model.setConfig(q[0].tolist())
    for i in range(last + round(SETTLE / step)):
        now = min(i + 1, last)
        speed = velocities[now] if i < last else np.zeros(model.numLinks())
        stiff, damped = FREQUENCY**2 * inertias[now], 2.0 * FREQUENCY * inertias[now]
        controller.setPIDGains(stiff.tolist(), np.zeros(len(driven)).tolist(), damped.tolist())
        torque = forward[now] if i < last else model_gravity
        controller.setPIDCommand(q[now].tolist(), speed.tolist(), torque[driven].tolist())
        simulation.simulate(step)
        times.append((i + 1) * step)
        seen.append(np.array(simulation.getActualConfig(0))[places])
        for id_, name in obstacles.items():
            for link in range(model.numLinks()):
                if simulation.hadContact(id_, model.link(link).getID()):
                    touched.add((model.link(link).getName(), name))
    back = np.argsort(order)
    return np.array(times), np.array(seen)[:, back], touched


def grown(scene: Scene, margin: float) -> Scene:
    """Return a scene whose boxes are larger by a margin on every side [m]."""
    boxes = [
        replace(each, body=replace(each.body, size=tuple(side + 2.0 * margin for side in each.body.size)))
        for each in scene.obstacles
    ]
    return replace(scene, obstacles=tuple(boxes))


def main() -> None:
    """Plan, time, simulate; write numbers and picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--deviation", type=float, default=0.05)
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--margin", type=float, default=0.005, help="to keep from obstacles when planning [m]")
    parser.add_argument("--out", type=Path, default=Path("klampt_simulation"))
    asked = parser.parse_args()
    query = arm_problem("ur5", "box-reach", "home", "inside")
    arm = query.world
    world = KlamptWorld(arm.robot, arm.scene, resolution=0.05)
    # Motions are checked at states: what was found to be free of larger boxes is checked again among smaller ones.
    half = KlamptWorld(arm.robot, grown(arm.scene, 0.5 * asked.margin), resolution=RESOLUTION)
    wary = KlamptWorld(arm.robot, grown(arm.scene, asked.margin), resolution=RESOLUTION)
    result = plan(wary, query.start, query.goals, seconds=60.0)
    print(f"{result.planner}: {result.message}")
    if result.path is None:
        raise SystemExit(1)
    limits = limits_of(arm.robot).at_speed(asked.speed)
    trajectory = make_trajectory(result.path, limits, world=half, names=arm.robot.group, deviation=asked.deviation)
    times, seen, touched = simulate(world, trajectory)
    wanted = trajectory.positions[np.minimum(np.arange(len(times)) + 1, len(trajectory.times) - 1)]
    driving = times <= trajectory.duration
    error = np.abs(seen - wanted)
    numbers: dict[str, Any] = {
        "duration": trajectory.duration,
        "largest_error": float(error[driving].max()),
        "median_error": float(np.median(error[driving].max(axis=1))),
        "error_at_rest": float(error[-1].max()),
        "contacts": sorted(map(list, touched)),
        "touching_states": int(np.sum(~arm.valid(np.clip(seen, *arm.bounds[:2])))),
        "states": len(times),
    }
    print(
        f"{numbers['duration']:.3f} s; off by {numbers['largest_error']:.4f} rad at most, median"
        f" {numbers['median_error']:.4f}, {numbers['error_at_rest']:.4f} at rest; contacts: {touched or 'none'};"
        f" {numbers['touching_states']} of {len(times)} simulated states touch by evenroad's capsules"
    )
    shown = replace(result, path=seen, message=f"as driven in Klamp't, {numbers['largest_error']:.4f} rad off at most")
    rows = [seen[round(share * (np.sum(driving) - 1))] for share in np.linspace(0.0, 1.0, PICTURES)]
    scene = ArmScene.of(shown, arm)
    frames = [scene.picture(q) for q in rows]
    sheet = Image.new("RGB", (2 * frames[0].width, (PICTURES + 1) // 2 * frames[0].height), "white")
    for i, frame in enumerate(frames):
        sheet.paste(frame, (i % 2 * frame.width, i // 2 * frame.height))
    with atomic_write(asked.out.with_suffix(".png")) as file:
        sheet.save(file, format="png")
    with atomic_write(asked.out.with_suffix(".json")) as file:
        file.write((json.dumps(numbers, indent=2) + "\n").encode())


if __name__ == "__main__":
    main()
