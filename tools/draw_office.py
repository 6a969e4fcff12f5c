"""Draw the shipped map of an office: ``python tools/draw_office.py``.

Twelve metres by eight: a corridor from west to east, four rooms with doors on each side of it, desks and cupboards.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

FOLDER = Path(__file__).parents[1] / "src" / "evenroad" / "world" / "gridmap" / "maps"
RESOLUTION = 0.05
"""Side of a cell [m]."""
WIDTH, HEIGHT = 12.0, 8.0
WALL, DOOR = 0.15, 1.0
"""Thickness of walls, and width of doors [m]."""
CORRIDOR = 3.6, 5.2
"""From where to where the corridor goes, in y [m]."""
ROOMS = {
    "south": ((0.0, 3.2, 6.2, 9.4, 12.0), (2.3, 4.2, 6.9, 10.9)),
    "north": ((0.0, 4.0, 8.4, 12.0), (1.2, 7.2, 9.2)),
}
"""Side of the corridor -> where its rooms are divided, and where each has its door, in x [m]."""
FURNITURE = (
    (0.3, 0.4, 1.9, 1.2), (2.6, 0.2, 3.0, 1.4), (3.6, 1.3, 5.0, 2.1), (5.6, 0.3, 6.0, 1.7), (6.6, 0.4, 8.2, 1.2),
    (8.7, 1.4, 9.2, 2.4), (9.8, 0.4, 10.6, 2.0), (11.4, 0.3, 11.8, 1.3), (0.4, 6.6, 2.6, 7.4), (3.3, 5.7, 3.8, 7.0),
    (5.0, 6.0, 7.0, 7.1), (8.8, 7.2, 11.4, 7.7), (10.2, 5.9, 11.4, 6.5), (4.9, 3.75, 5.9, 4.1), (9.6, 4.7, 10.8, 5.05),
)  # fmt: skip
"""Desks, cupboards and benches: from x, y to x, y [m]."""


def main() -> None:
    """Write ``office.png`` and ``office.yaml``."""
    occupied = np.zeros((round(HEIGHT / RESOLUTION), round(WIDTH / RESOLUTION)), dtype=bool)

    def fill(x0: float, y0: float, x1: float, y1: float, value: bool = True) -> None:
        # Row 0 is the top of the picture, y counts from its bottom.
        rows = slice(*(round((HEIGHT - y) / RESOLUTION) for y in (y1, y0)))
        occupied[rows, slice(*(round(x / RESOLUTION) for x in (x0, x1)))] = value

    for x in (0.0, WIDTH - WALL):
        fill(x, 0.0, x + WALL, HEIGHT)
    for y in (0.0, CORRIDOR[0] - WALL, CORRIDOR[1], HEIGHT - WALL):
        fill(0.0, y, WIDTH, y + WALL)
    for side, (walls, doors) in ROOMS.items():
        low, high, y = (0.0, CORRIDOR[0], CORRIDOR[0] - WALL) if side == "south" else (CORRIDOR[1], HEIGHT, CORRIDOR[1])
        for x in walls[1:-1]:
            fill(x - WALL / 2, low, x + WALL / 2, high)
        for x in doors:
            fill(x - DOOR / 2, y, x + DOOR / 2, y + WALL, value=False)
    for box in FURNITURE:
        fill(*box)
    Image.fromarray(np.where(occupied, 0, 255).astype(np.uint8)).convert("1").save(FOLDER / "office.png", optimize=True)
    (FOLDER / "office.yaml").write_text(
        f"image: office.png\nresolution: {RESOLUTION}\norigin: [0.0, 0.0, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )


if __name__ == "__main__":
    main()
