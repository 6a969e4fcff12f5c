"""The builds of the native kernel: those installed, those that this processor runs, and the loaded one."""

from __future__ import annotations

import os
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from evenroad.errors import NotAvailable, UnknownName

ENVIRONMENT = "EVENROAD_ARCH"
"""Environment variable that names the build to load; without it, the newest that the processor runs."""
SANITIZED = "sanitized"
"""A build for tests that stops at memory errors and undefined behaviour, loaded only on request: `make sanitize`."""


def module_name(variant: str) -> str:
    """Return the module of a build, e.g. ``evenroad._native._x86_64_v3`` of x86-64-v3."""
    return f"evenroad._native._{variant.replace('-', '_')}"


def usable() -> tuple[str, ...]:
    """Return the installed builds that this processor runs, the newest instruction set last."""
    try:
        cpu = import_module("evenroad._native._cpu")
    except ImportError as error:
        raise NotAvailable(
            "the native kernel is not built for this Python: run `make native` in a clone, or `pip install .`"
            f" ({error})"
        ) from error
    return tuple(each for each in (SANITIZED, *cpu.runnable()) if find_spec(module_name(each)) is not None)


def load() -> ModuleType:
    """Load the build that EVENROAD_ARCH names, or else the newest, and return its module."""
    names = usable()
    wanted = os.environ.get(ENVIRONMENT) or names[-1]
    if wanted not in names:
        raise UnknownName.among(f"instruction set in {ENVIRONMENT}", wanted, names)
    return import_module(module_name(wanted))
