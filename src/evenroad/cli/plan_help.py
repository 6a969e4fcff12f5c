"""The help of ``evenroad plan`` on one screen: what an arm, a disk and a car need, and what is common."""

from __future__ import annotations

from collections.abc import Sequence

KINDS = {"robot": "--robot", "arm": "--robot", "disk": "--robot-radius", "map": "--robot-radius", "car": "--footprint"}
"""What all options are printed of -> the option that chooses it."""
OVERVIEW = """\
usage: evenroad plan WORLD --start ... --goal ... [OPTIONS]

Plan a path that is proved free; write it as JSON, and a picture.

an arm in a scene:                       all options: evenroad plan --help robot
  WORLD                a scene (.yaml): its file, or a name of `evenroad scenes`
  --robot ROBOT        a URDF, xacro or MJCF, or a name of `evenroad robots`
  --start, --goal      a named state, or numbers 0,-1.57,... [rad]
  --goal-pose          x y z, or x y z roll pitch yaw, of --tip
  --straight, --upright, --via, --constraint    what the path keeps on its way
  $ evenroad plan box-reach.yaml --robot ur5 --start home --goal inside

a disk on a map:                          all options: evenroad plan --help disk
  WORLD                a ROS .yaml [m], an image [pixels], or of `evenroad maps`
  --robot-radius R     its radius, in map units
  --start, --goal      x y
  $ evenroad plan office.yaml --start 1 2 --goal 8.5 3 --robot-radius 0.25

a car or another footprint on a map:       all options: evenroad plan --help car
  --footprint CORNERS  "[[x, y], [x, y], ...]", in map units
  --turning-radius R, --forward-only, --holonomic    how it moves
  --start, --goal      x y angle

common:
  --time S, --seed N   time limit, and another path
  --clearance D        distance to keep from every obstacle
  --improve            use all of the time to find a shorter path
  -n N, --sampler S    plan with PRM on N points of `evenroad samplers`
  --trajectory FILE    write the path with times: .csv, .yaml (ROS 2), .mcap
  --certificate FILE   write a proof that others can check (an arm)
  -o OUT               names of the files that are written
"""


def help_kind(words: Sequence[str]) -> str | None:
    """Return the option that chooses what all options are printed of, "" for the overview, None where no help is."""
    if not words or words[0] not in ("-h", "--help") or len(words) > 2:
        return None
    return "" if len(words) == 1 else KINDS.get(words[1])
