"""Newton and Euler's equations, link by link in the frame of the root: slow, and the oracle of the native kernel."""

import numpy as np

from evenroad.robots.kinematics import joint_values, poses_at


def torques_by_newton(dynamics, q, velocity, acceleration):
    """Torques of states, (n, dim) each."""
    pulled = np.broadcast_to(-np.array(dynamics.gravity), (len(q), 3))
    robot, n = dynamics.robot, len(q)
    values = joint_values(robot, q)
    poses = dict(zip(robot.links, np.moveaxis(poses_at(robot, values, n), 1, 0), strict=True))
    none = {joint.name: np.zeros(n) for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
    rates = _with_mimics(robot, none | dict(zip(robot.group, velocity.T, strict=True)))
    pushes = _with_mimics(robot, none | dict(zip(robot.group, acceleration.T, strict=True)))
    zero = np.zeros((n, 3))
    # Of each link: how it turns, and is pushed to turn and to move.
    moves = {robot.links[0]: (zero, zero, pulled)}
    axes = {}
    for joint in robot.joints:
        turn, turned, pushed = moves[joint.parent]
        parent, child = poses[joint.parent], poses[joint.child]
        arm = child[:, :3, 3] - parent[:, :3, 3]
        pushed = pushed + np.cross(turned, arm) + np.cross(turn, np.cross(turn, arm))
        if joint.kind != "fixed":
            # A joint leaves its own axis where it is.
            axis = child[:, :3, :3] @ np.array(joint.axis)
            rate, push = rates[joint.name][:, np.newaxis], pushes[joint.name][:, np.newaxis]
            axes[joint.name] = axis
            if joint.kind == "prismatic":
                pushed = pushed + axis * push + 2.0 * np.cross(turn, axis * rate)
            else:
                turned = turned + axis * push + np.cross(turn, axis * rate)
                turn = turn + axis * rate
        moves[joint.child] = turn, turned, pushed
    forces, moments = (dict.fromkeys(robot.links, zero) for _ in range(2))
    for mass in dynamics.masses:
        turn, turned, pushed = moves[mass.link]
        rotation = poses[mass.link][:, :3, :3]
        centre = rotation @ np.array(mass.centre)
        force = mass.mass * (pushed + np.cross(turned, centre) + np.cross(turn, np.cross(turn, centre)))
        inertia = rotation @ np.array(mass.inertia).reshape(3, 3) @ rotation.transpose(0, 2, 1)
        spin = np.einsum("nij,nj->ni", inertia, turned) + np.cross(turn, np.einsum("nij,nj->ni", inertia, turn))
        forces[mass.link] = forces[mass.link] + force
        moments[mass.link] = moments[mass.link] + spin + np.cross(centre, force)
    torques = {name: np.zeros(n) for name in robot.group}
    for joint in reversed(robot.joints):
        force, moment = forces[joint.child], moments[joint.child]
        if joint.kind != "fixed":
            along = force if joint.kind == "prismatic" else moment
            needed = (axes[joint.name] * along).sum(axis=1)
            name = joint.name if joint.mimic is None else joint.mimic.joint
            if name in torques:
                torques[name] = torques[name] + needed * (1.0 if joint.mimic is None else joint.mimic.multiplier)
        arm = poses[joint.child][:, :3, 3] - poses[joint.parent][:, :3, 3]
        forces[joint.parent] = forces[joint.parent] + force
        moments[joint.parent] = moments[joint.parent] + moment + np.cross(arm, force)
    return np.stack([torques[name] for name in robot.group], axis=1)


def _with_mimics(robot, rates):
    """How fast all movable joints move, joint -> (n,), from those that move by themselves."""
    mimics = [joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is not None]
    return rates | {joint.name: joint.mimic.multiplier * rates[joint.mimic.joint] for joint in mimics}
