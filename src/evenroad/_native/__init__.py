"""The loops over states, in C++: one module for each instruction set, one of which is loaded with this package.

The parts of that module are modules here, e.g. `evenroad._native.points`.  Their stubs list their contents.
"""

from __future__ import annotations

import sys
from types import ModuleType

from evenroad._native.variants import load

kernel = load()
VARIANT: str = kernel.VARIANT
"""The instruction set of the loaded module."""

for _name, _part in vars(kernel).items():
    if isinstance(_part, ModuleType):
        globals()[_name] = sys.modules[f"{__name__}.{_name}"] = _part
