"""Colours and weights shared by every picture, chosen to stay apart in greyscale and for colour-blind eyes."""

OBSTACLE = "#3b3f46"
FREE = "#ffffff"
UNKNOWN = "#dcd6cb"
OUTSIDE = "#9a9fa6"
START_COMPONENT = "#c9ead9"
GOAL_COMPONENT = "#cfdbf7"
EDGE = "#b9c6d3"
MILESTONE = "#6b8aa8"
RAW_PATH = "#e6a23c"
PATH = "#d1343b"
START = "#1b9e5a"
GOAL = "#2f5fd0"
COLLISION = "#d1343b"
HALO = "#ffffff"


def without_math(text: str) -> str:
    """Return a text for matplotlib that shows dollars as they are: names from files are no mathematics.

    Escaped, since ``parse_math=False`` is forgotten where a text is wrapped.
    """
    return text.replace("$", r"\$")
