"""Draws what the shipped arms look like: a few pieces turned about z, placed on the links of their URDFs.

A piece has radius 1 and height 1, and a ``<visual>`` scales it.  Sizes follow from the collision bodies, in which the
visuals lie: see tests/loading/test_looks.py.  Run it from the root: python tools/robot_looks.py
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np

DATA = Path("src/evenroad/loading/data")
SIDES = 24
PIECES = {
    # A motor's housing: a cylinder with rounded edges.
    "housing": [(0, 0), (0.9, 0), (0.975, 0.025), (1, 0.08), (1, 0.92), (0.975, 0.975), (0.9, 1), (0, 1)],
    "lid": [(0, 0), (0.97, 0), (1, 0.1), (1, 0.45), (0.96, 0.72), (0.86, 0.92), (0.7, 1), (0, 1)],
    # A tube between two housings, with a collar at both ends.
    "tube": [(1.08, 0), (1.08, 0.14), (1, 0.2), (1, 0.8), (1.08, 0.86), (1.08, 1)],
    "foot": [(0, 0), (1, 0), (1, 0.4), (0.97, 0.5), (0.86, 0.56), (0.82, 0.65), (0.82, 1), (0, 1)],
    # The round bottom of a link, half a ball, and a shoulder that narrows upwards.
    "bowl": [(0, 0), (0.38, 0.075), (0.7, 0.286), (0.92, 0.608), (1, 1)],
    "shoulder": [(1, 0), (1, 0.3), (0.96, 0.55), (0.86, 0.8), (0.74, 1), (0, 1)],
}
"""Piece -> its profile, from below: radius and height of each corner."""
MATERIALS = {
    "metal": (0.78, 0.8, 0.82), "dark": (0.16, 0.17, 0.19), "blue": (0.36, 0.56, 0.71),
    "white": (0.91, 0.92, 0.93), "orange": (0.93, 0.5, 0.16),
}  # fmt: skip
AXES = {"z": (0.0, 0.0, 0.0), "-z": (np.pi, 0.0, 0.0), "y": (-np.pi / 2, 0.0, 0.0), "-y": (np.pi / 2, 0.0, 0.0)}
"""Direction of a piece's axis -> roll, pitch and yaw."""
LID, SEAM = 0.3, 0.004
"""Height of a lid relative to its radius, and height of the dark ring below it [m]."""


def stl(profile: list[tuple[float, float]]) -> bytes:
    """Return what a profile makes when it turns about z, as a binary STL."""
    across, up = np.array(profile, dtype=float).T
    turn = 2.0 * np.pi / SIDES * np.arange(SIDES + 1)
    rings = np.stack(
        np.broadcast_arrays(np.outer(across, np.cos(turn)), np.outer(across, np.sin(turn)), up[:, None]), 2
    )
    a, b, c, d = rings[:-1, :-1], rings[:-1, 1:], rings[1:, 1:], rings[1:, :-1]
    corners = np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3, 3), np.stack([a, c, d], 2).reshape(-1, 3, 3)])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normals, axis=1)
    # At the axis one of two triangles has no area.
    corners, normals = corners[size > 1e-9], (normals / np.maximum(size, 1e-9)[:, None])[size > 1e-9]
    rows = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    # The same bytes on every machine, whatever its cosines, and no -0.
    rows["normal"], rows["corners"] = np.round(normals, 5) + 0.0, np.round(corners, 6) + 0.0
    return b"evenroad tools/robot_looks.py".ljust(80) + len(rows).to_bytes(4, "little") + rows.tobytes()


def visual(piece: str, axis: str, start: tuple[float, float, float], radius: float, height: float, look: str) -> str:
    """Return a ``<visual>``: a piece that begins at a point of the link and leads along an axis."""
    xyz, rpy, scale = (
        " ".join(f"{number:.9g}" for number in row) for row in (start, AXES[axis], (radius, radius, height))
    )
    at = f'<origin xyz="{xyz}" rpy="{rpy}"/><geometry><mesh filename="meshes/{piece}.stl" scale="{scale}"/></geometry>'
    return f'<visual>{at}<material name="{look}"/></visual>'


def motor(axis: str, at: tuple[float, float, float], ends: tuple[float, float], radius: float) -> list[str]:
    """Return a metal housing along an axis between two heights on it, with a blue lid at the far end."""
    (begin, end), (x, y, z) = ends, at
    sign = -1.0 if axis.startswith("-") else 1.0

    def along(height: float) -> tuple[float, float, float]:
        return (x, y + sign * height, z) if axis.endswith("y") else (x, y, z + sign * height)

    top = end - LID * radius
    return [
        visual("housing", axis, along(begin), radius, top - begin, "metal"),
        visual("housing", axis, along(top - 0.4 * SEAM), 0.985 * radius, 1.4 * SEAM, "dark"),
        visual("lid", axis, along(top + SEAM), radius, end - top - SEAM, "blue"),
    ]


def ur5() -> dict[str, list[str]]:
    """Return link -> what is drawn of the UR5: a motor in each joint, with a blue lid at its free end."""
    return {
        "base_link": [
            visual("foot", "z", (0, 0, 0), 0.073, 0.0255, "dark"),
            visual("housing", "-y", (0, -0.06, 0.016), 0.014, 0.034, "dark"),
        ],
        "shoulder_link": [
            *motor("z", (0, 0, 0), (-0.0637, 0.068), 0.06),
            visual("housing", "y", (0, 0, 0), 0.058, 0.0703, "metal"),
        ],
        "upper_arm_link": [
            *motor("y", (0, 0, 0), (-0.0655, 0.068), 0.06),
            visual("tube", "z", (0, -0.0008, 0.035), 0.0505, 0.355, "metal"),
            *motor("y", (0, 0, 0.425), (-0.062, 0.066), 0.06),
        ],
        "forearm_link": [
            *motor("-y", (0, 0, 0), (-0.0577, 0.056), 0.054),
            visual("tube", "z", (0, 0.0005, 0.03), 0.0365, 0.335, "metal"),
            *motor("-y", (0, 0, 0.39225), (-0.0485, 0.058), 0.0385),
        ],
        "wrist_1_link": [
            visual("housing", "y", (0, 0.0495, 0), 0.0365, 0.0435, "metal"),
            *motor("-z", (0, 0.093, 0), (-0.0465, 0.06), 0.0385),
        ],
        "wrist_2_link": [
            visual("housing", "z", (0, 0, 0.0475), 0.0365, 0.0472, "metal"),
            *motor("-y", (0, 0, 0.09465), (-0.0475, 0.056), 0.0385),
        ],
        "wrist_3_link": [
            visual("housing", "y", (0, 0.0485, 0.001), 0.0365, 0.025, "metal"),
            visual("housing", "y", (0, 0.0725, 0.001), 0.0345, 0.0098, "dark"),
        ],
    }  # fmt: skip


def arm7() -> dict[str, list[str]]:
    """Return link -> what is drawn of the arm of seven joints: links that turn, and barrels that tilt."""

    def turning(radius: float, begin: float, length: float) -> list[str]:
        return [
            visual("housing", "z", (0, 0, begin), 1.01 * radius, 0.012, "dark"),
            visual("shoulder", "z", (0, 0, begin + 0.012), radius, length - 0.012, "white"),
        ]

    def tilting(radius: float, half: float, top: float) -> list[str]:
        barrel = 0.8 * radius
        return [
            visual("bowl", "z", (0, 0, -radius), radius, radius, "white"),
            visual("housing", "z", (0, 0, -0.02), radius, top + 0.02, "white"),
            *(visual("lid", axis, (0, 0, 0), barrel, half, "orange") for axis in ("y", "-y")),
        ]

    return {
        "base_link": [
            visual("bowl", "z", (0, 0, 0.002), 0.088, 0.088, "dark"),
            visual("housing", "z", (0, 0, 0.08), 0.087, 0.057, "white"),
        ],
        "shoulder_pan_link": turning(0.067, -0.01, 0.18),
        "shoulder_tilt_link": tilting(0.062, 0.062, 0.185),
        "shoulder_roll_link": turning(0.058, -0.014, 0.214),
        "elbow_link": tilting(0.055, 0.055, 0.157),
        "forearm_roll_link": turning(0.05, -0.014, 0.19),
        "wrist_tilt_link": tilting(0.048, 0.048, 0.075),
        "wrist_roll_link": [
            *turning(0.042, -0.004, 0.05),
            visual("housing", "z", (0, 0, 0.044), 0.034, 0.037, "dark"),
        ],
    }  # fmt: skip


def with_visuals(urdf: str, looks: dict[str, list[str]]) -> str:
    """Return a URDF whose links have these visuals, in place of those that they had."""
    bare = re.sub(r"  <material .*\n|    <visual>.*\n", "", urdf)
    used = {look for look in MATERIALS for visuals in looks.values() if f'"{look}"' in "".join(visuals)}
    materials = [
        f'  <material name="{name}"><color rgba="{red} {green} {blue} 1"/></material>\n'
        for name, (red, green, blue) in MATERIALS.items()
        if name in used
    ]
    head, robot, rest = re.split(r"(<robot .*\n)", bare, maxsplit=1)
    for link, visuals in looks.items():
        before, opened, after = rest.partition(f'  <link name="{link}">\n')
        bodies, closed, after = after.partition("  </link>\n")
        rest = before + opened + bodies + "".join(f"    {each}\n" for each in visuals) + closed + after
    return head + robot + "".join(materials) + rest


def files(data: Path = DATA) -> dict[Path, bytes]:
    """Return each file that this makes of those in a folder, and its content."""
    made = {data / "meshes" / f"{name}.stl": stl(profile) for name, profile in PIECES.items()}
    for name, looks in (("ur5", ur5()), ("arm7", arm7())):
        urdf = data / f"{name}.urdf"
        made[urdf] = with_visuals(urdf.read_text(encoding="utf-8"), looks).encode()
    return made


def main() -> int:
    """Write the files; return 0."""
    for path, content in files().items():
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
        print(f"{path}: {len(content)} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
