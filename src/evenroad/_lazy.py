"""Names of a package that are loaded when they are first used, so that importing one part does not load them all."""

from __future__ import annotations

import gc
import importlib
import sys
from collections.abc import Callable
from types import ModuleType


def names_on_use(package: str, file: str) -> tuple[list[str], Callable[[str], object], Callable[[], list[str]]]:
    """Return ``__all__``, ``__getattr__`` and ``__dir__`` of a package that takes each name where its stub says.

    The stub beside the package's file has lines ``from MODULE import X as NAME``; type checkers read it as it is.
    """
    with open(f"{file.removesuffix('.py')}.pyi", encoding="utf-8") as stub:
        words = [line.split() for line in stub if line.startswith("from ")]
    homes = {name: (module, there) for _, module, _, there, _, name, *_ in words}

    def load(name: str) -> object:
        if name not in homes:
            from evenroad._hints import hint_of_module

            hint = hint_of_module(name, homes)
            raise AttributeError(f"module {package!r} has no attribute {name!r}{hint and '; '}{hint}")
        home, there = homes[name]
        if home == package:
            return _loaded(f"{package}.{there}")
        module = _loaded(home)
        # A name may be a module of its own.
        value = getattr(module, there) if hasattr(module, there) else _loaded(f"{home}.{there}")
        setattr(sys.modules[package], name, value)
        return value

    return list(homes), load, lambda: sorted(homes)


def _loaded(name: str) -> ModuleType:
    """Return a module.  While it loads, nothing is garbage, and the collector would look through all of it again."""
    collects = gc.isenabled()
    gc.disable()
    try:
        return importlib.import_module(name)
    finally:
        if collects:
            gc.enable()
