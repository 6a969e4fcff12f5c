"""evenroad: paths proved free for robot arms and for disks on maps, and even point sets for sampling planners.

The public names are those of ``__init__.pyi``, which type checkers and editors read as it is.  Here, as in each part,
they are loaded on first use, so that ``import evenroad`` costs milliseconds.
"""

from evenroad._lazy import names_on_use

__version__ = "0.1.0"

_names, __getattr__, _ = names_on_use(__name__, __file__)
__all__ = ["__version__", *_names]


def __dir__() -> list[str]:
    return sorted(__all__)
