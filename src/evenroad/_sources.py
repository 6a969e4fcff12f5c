"""What the names of kept machine code say: of which sources it was made, and for which processor."""

from __future__ import annotations

import hashlib
import os
import platform
import re
import sys
from functools import cache

import numba
from llvmlite import binding

ROOT = os.path.dirname(os.path.abspath(__file__))
_IMPORT = re.compile(rb"^(?:from (evenroad[\w.]*) import (\([^)]*\)|[^\n]*)|import (evenroad[\w.]*))", re.MULTILINE)


@cache
def machine() -> str:
    """Return a short text for all that code is compiled for and by: processor, system, numba and its compiler."""
    features = binding.get_host_cpu_features().flatten()
    names = (binding.get_host_cpu_name(), features, platform.system(), platform.machine())
    settings = (numba.config.CPU_NAME, numba.config.CPU_FEATURES, numba.config.OPT)
    text = repr((names, settings, numba.__version__, binding.llvm_version_info))
    return hashlib.sha256(text.encode()).hexdigest()[:8]


@cache
def digest_of(source: str) -> str:
    """Return a short text for a file and all that it imports of evenroad, directly or by way of others."""
    found, waiting = {os.path.abspath(source)}, [os.path.abspath(source)]
    while waiting:
        new = _read(waiting.pop())[1] - found
        found |= new
        waiting += new
    text = "".join(sorted(_read(path)[0] for path in found))
    return hashlib.sha256(text.encode()).hexdigest()[:12]


@cache
def _read(path: str) -> tuple[str, frozenset[str]]:
    """Return the digest of a file and the files of evenroad that it imports at its top level."""
    try:
        with open(path, "rb") as file:
            text = file.read()
    except OSError:
        return "", frozenset()
    names = set()
    for package, several, module in _IMPORT.findall(text):
        names.add(package or module)
        names |= {package + b"." + word for word in re.findall(rb"\w+", several)}
    files = {file for name in names for file in _files_of(name.decode())}
    return hashlib.sha256(text).hexdigest(), frozenset(files)


@cache
def _files_of(name: str) -> tuple[str, ...]:
    """Return the file of a module, or of a package that hands on names; nothing for what is no module."""
    top, *inside = name.split(".")
    # Of another package that compiles with this one, as the studies do, the folder that it was loaded from.
    root = ROOT if top == "evenroad" else os.path.dirname(getattr(sys.modules.get(top), "__file__", None) or ROOT)
    base = os.path.join(root, *inside)
    return tuple(file for file in (f"{base}.py", os.path.join(base, "__init__.py")) if os.path.isfile(file))
