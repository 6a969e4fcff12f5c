"""What a roadmap made for a robot knows: where its milestones have the tool, and how many ends see one.

    python -m benchmarks.arm_roadmap_picture --out docs/robot_roadmaps.png

256 points of a UR5 of five joints: scrambled Sobol (Owen) in the joint box, the first that are free of robot and
cell, and a roadmap.  The ends are in pockets drawn anew; an end that sees no milestone cannot be joined to any.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from evenroad.robot import ArmWorld
from evenroad.robot.kinematics import link_poses
from evenroad.robot_roadmap.pockets import ends_in_pockets
from evenroad_studies.arms.roadmaps import cell_of, roadmap_of
from evenroad_studies.arms.robots import arm_named, tool_of

ROBOT, COUNT, ENDS = "ur5-5", 256, 1000
STYLES = {
    "sobol scrambled": ("Owen in the box", "0.45"),
    "control": ("control", "tab:blue"),
    "roadmap": ("roadmap", "tab:red"),
}
SIZES = (8, 16, 32, 64, 128, 256)
OTHERS = 700
"""Free configurations at random, among which the ends are."""


def main() -> None:
    """Draw the picture and print the shares."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("docs/robot_roadmaps.png"))
    out = parser.parse_args().out
    arm = arm_named(ROBOT)
    world = ArmWorld(arm, cell_of(arm))
    made = {name: roadmap_of(ROBOT, name, COUNT, 10, 0, 1)[0].milestones for name in STYLES}
    q = world.space.from_cube(np.random.default_rng(77).random((4 * OTHERS, world.space.dim)))
    q = q[world.valid(q)][:OTHERS]
    everything = np.concatenate([q, *made.values()])
    seen = ends_in_pockets(arm, world.scene, everything, everything, ENDS, np.random.default_rng(78))
    # Milestones are no ends: they would be judged by how far they keep from each other.
    of_end = [
        each
        for own, each in zip(seen.own, np.split(seen.which, seen.first[1:-1]), strict=True)
        if own < OTHERS
    ]

    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    panels = figure.subplots(1, 3, width_ratios=(1, 1, 1.2))
    for panel, name in zip(panels[:2], ("sobol scrambled", "roadmap"), strict=True):
        milestones = made[name]
        free = world.valid(milestones)
        tool = link_poses(arm, milestones)[:, tool_of(arm), :3, 3]
        away = np.hypot(tool[:, 0], tool[:, 1])
        title, colour = STYLES[name]
        panel.plot(
            away[~free], tool[~free, 2], "x", color="0.75", markersize=4, label="touches robot or table"
        )
        panel.plot(away[free], tool[free, 2], "o", color=colour, markersize=3, label="free")
        panel.axhline(0.0, color="0.3", linewidth=0.8)
        panel.set(title=f"tool of {COUNT}: {title}", xlabel="from the axis [m]", aspect="equal")
        panel.set(xlim=(0.0, 1.0), ylim=(-0.9, 1.15))
        panel.legend(fontsize=7, loc="lower left")
    panels[0].set_ylabel("above the table [m]")
    for number, (title, colour) in enumerate(STYLES.values()):
        begin = OTHERS + number * COUNT
        blind = [
            100.0 * np.mean([not np.any((each >= begin) & (each < begin + n)) for each in of_end])
            for n in SIZES
        ]
        print(title, " ".join(f"{n}: {share:.0f} %" for n, share in zip(SIZES, blind, strict=True)))
        panels[2].plot(SIZES, blind, "o-", color=colour, label=title, markersize=4)
    panels[2].set(
        xscale="log", xticks=SIZES, xticklabels=SIZES, xlabel="the first so many milestones", ylim=(0, 100)
    )
    panels[2].set(title=f"{len(of_end)} ends in pockets that see none of them [%]")
    panels[2].minorticks_off()
    panels[2].legend(fontsize=8)
    figure.savefig(out, dpi=110)


if __name__ == "__main__":
    main()
