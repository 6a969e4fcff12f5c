"""Klamp't's PRM on our map and points, our planner on a robot of Klamp't's, and a trajectory for it; extra `klampt`."""

from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

import klampt

import evenroad as er
from evenroad.adapters.klampt import KlamptWorld, klampt_motion, plan_on_points
from evenroad.trajectory import Limits, make_trajectory
from evenroad.world.gridmap.load import load_maze

# Theirs on ours: what Klamp't calls free is what our map does, exactly, places and motions.
maze = load_maze(2)
path = plan_on_points(maze.world(), maze.start, maze.goal, er.draw("even", 256, 2))
print("Klamp't's PRM on 256 even points:", "no path" if path is None else f"{len(path)} waypoints")

# Ours on theirs: a robot that Klamp't reads, among what stands in Klamp't's world.
BODY = '<collision><origin xyz=".5 0 0"/><geometry><box size=".9 .1 .1"/></geometry></collision>'
TWO_LINKS = f"""<robot name="two_links"><klampt use_vis_geom="0"/><link name="world"/>
<link name="upper">{BODY}</link><link name="fore">{BODY}</link>
<joint name="turn" type="revolute"><parent link="world"/><child link="upper"/><origin xyz="0 0 0"/>
<axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
<joint name="bend" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="1 0 0"/>
<axis xyz="0 0 1"/><limit lower="-2.8" upper="2.8" velocity="1" effort="1"/></joint></robot>"""
model = klampt.WorldModel()
with TemporaryDirectory() as folder, chdir(folder):
    Path("two_links.urdf").write_text(TWO_LINKS)
    model.readFile("two_links.urdf")
post, shape = klampt.GeometricPrimitive(), klampt.Geometry3D()
post.setAABB([1.2, -0.1, -1.0], [1.4, 0.1, 1.0])
shape.setGeometricPrimitive(post)
model.makeTerrain("post").geometry().set(shape.convert("TriangleMesh"))
world = KlamptWorld(model)
result = er.plan(world, (0.9, 0.0), (-0.9, 0.3), er.draw("even", 128, 2))
print("our roadmap, Klamp't's checker:", result.message, "proof:", result.proof)

trajectory = make_trajectory(result.path, Limits((1.0, 1.0), (2.0, 2.0)), world=world)
motion = klampt_motion(model.robot(0), trajectory, world.links)
print(f"a RobotTrajectory of {motion.duration():.2f} s with {len(motion.milestones)} milestones")
