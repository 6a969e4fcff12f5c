"""Finding a robot's file by a path, or by the name of a shipped robot or of one in the wheel `example-robot-data`."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

from evenroad._checks import as_file
from evenroad._hints import among_names
from evenroad.errors import UnknownName, near

DATA = Path(__file__).parent / "data"
ROBOTS = ("arm7", "ur5")
"""Names of the shipped robots."""
WHEEL = "example-robot-data"
"""Distribution of the extra `robots`: it holds URDFs, meshes and SRDFs, and no Python."""
_FOLDER = "cmeel.prefix/share/example-robot-data/robots"


def find_robot(source: str | os.PathLike[str]) -> tuple[Path, Path | None]:
    """Return the file of a robot, and its SRDF if the robot was named and has one.

    Raises UnknownName if there is neither such a file nor a robot of this name.
    """
    path = as_file("a robot", source, "a URDF, xacro or MJCF, or the name of a shipped robot")
    if path.is_file() or path.suffix or len(path.parts) > 1:
        return path, None
    name = str(source)
    if name in ROBOTS:
        own = DATA / f"{name}.srdf"
        return DATA / f"{name}.urdf", own if own.exists() else None
    known = example_robots()
    if name not in known:
        if known:
            raise among_names("robot", name, {*ROBOTS, *known}, "`evenroad robots` lists them")
        meant = near(name, ROBOTS) + " " if near(name, ROBOTS) else ""
        raise UnknownName(
            f"there is no robot file {name!r}, and none of this name is shipped; shipped: {', '.join(ROBOTS)}; {meant}"
            "panda, kinova, xarm7 and others come with the extra: pip install 'evenroad[robots]'"
        )
    urdf = known[name]
    stems = (urdf.stem, urdf.stem.removesuffix("_robot"))
    srdfs = [urdf.parent.parent / "srdf" / f"{stem}.srdf" for stem in stems]
    return urdf, next((srdf for srdf in srdfs if srdf.is_file()), None)


def list_robots() -> tuple[str, ...]:
    """Return the names of the robots that :func:`evenroad.load_robot` knows: the shipped ones and those of the extra.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> import evenroad as er
    >>> {"arm7", "ur5"} <= set(er.list_robots())
    True
    """
    return tuple(sorted({*ROBOTS, *example_robots()}))


def example_robots() -> dict[str, Path]:
    """Return name -> URDF of the robots of the extra `robots`; none where it is not installed.

    A name is that of the file: ``panda``, ``ur5_gripper``.
    """
    # Imported late: it takes longer to load than a shipped robot.
    from importlib.metadata import PackageNotFoundError

    try:
        return _example_files()
    except PackageNotFoundError:
        return {}


@cache
def _example_files() -> dict[str, Path]:
    from importlib.metadata import distribution

    folder = Path(str(distribution(WHEEL).locate_file(_FOLDER)))
    # Two packages may have a file of one name: the first in the order of folders keeps it.
    files = sorted([*folder.glob("*/urdf/*.urdf"), *folder.glob("*/robots/*.urdf")], reverse=True)
    return {file.stem: file for file in files}
