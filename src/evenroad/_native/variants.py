"""The builds of the native kernel: those installed, those that this processor runs, and the loaded one."""

from __future__ import annotations

import os
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from evenroad._native.digest import SOURCES, digest_of
from evenroad.errors import NotAvailable, UnknownName

ENVIRONMENT = "EVENROAD_ARCH"
"""Environment variable that names the build to load; without it, the newest that the processor runs."""
SANITIZED = "sanitized"
"""A build for tests that stops at memory errors and undefined behaviour, loaded only on request: `make sanitize`."""

REMEDY = "run `make native` in a clone, or `pip install .`"
"""What a build that is missing takes."""


def module_name(variant: str) -> str:
    """Return the module of a build, e.g. ``evenroad._native._x86_64_v3`` of x86-64-v3."""
    return f"evenroad._native._{variant.replace('-', '_')}"


def usable() -> tuple[str, ...]:
    """Return the installed builds that this processor runs, the newest instruction set last."""
    try:
        runnable = import_module("evenroad._native._cpu").runnable()
    except ImportError as error:
        raise NotAvailable(f"the native kernel is not built for this Python: {REMEDY} ({error})") from error
    found = tuple(each for each in (SANITIZED, *runnable) if find_spec(module_name(each)) is not None)
    if not found:
        raise NotAvailable(f"the native kernel is built for other processors than this, {runnable[-1]}: {REMEDY}")
    return found


def load() -> ModuleType:
    """Load the build that EVENROAD_ARCH names, or else the newest, and return its module."""
    names = usable()
    wanted = os.environ.get(ENVIRONMENT) or names[-1]
    if wanted not in names:
        raise UnknownName.among(f"instruction set in {ENVIRONMENT}", wanted, names)
    module = import_module(module_name(wanted))
    # A clone has the sources beside its builds, an installed wheel has not.
    if os.path.isdir(SOURCES) and digest_of(SOURCES) != module.SOURCES:
        raise NotAvailable(f"the native kernel {wanted} is built from other sources than {SOURCES}: run `make native`")
    return module
