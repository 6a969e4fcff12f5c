"""The cache of compiled code between runs, and the fallback where no folder can be written."""

from __future__ import annotations

import atexit
import gc
import os
import sys
from importlib import import_module
from threading import Lock
from types import ModuleType
from typing import Any

from evenroad.errors import NotAvailable

VARIABLE = "NUMBA_CACHE_DIR"
"""Names the folder of the user's choice; numba reads it."""


def provide_cache() -> None:
    """Give numba a folder of this process where it would find none, and say so in one line of the log.

    Numba keeps compiled code beside the module, else in the user's cache, and refuses to load a module at all where it
    can write to neither: read-only site-packages and no home, as in many containers.
    """
    beside = os.path.join(os.path.dirname(__file__), "__pycache__")
    if os.environ.get(VARIABLE) or _writable(beside) or _takes_files(user_cache("numba")):
        return
    import logging
    import shutil
    import tempfile

    folder, owner = tempfile.mkdtemp(prefix="evenroad-compiled-"), os.getpid()

    def remove() -> None:
        if os.getpid() == owner:
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)
    # Worker processes inherit it.
    os.environ[VARIABLE] = folder
    if not _writable(os.environ.get("XDG_CONFIG_HOME") or os.path.expanduser("~/.config")):
        # Nor would Matplotlib find a place, and it says so at length.
        os.environ.setdefault("MPLCONFIGDIR", folder)
    if "numba" in sys.modules:
        sys.modules["numba"].config.CACHE_DIR = folder
    logging.getLogger("evenroad").warning(
        "evenroad: no folder to keep compiled code in, so every run compiles anew, which takes up to a minute;"
        " set NUMBA_CACHE_DIR to a folder that can be written"
    )


def user_cache(program: str) -> str:
    """Return the folder where a program keeps what it can make again, as the platform has it."""
    if sys.platform == "darwin":
        return os.path.expanduser(f"~/Library/Caches/{program}")
    if sys.platform == "win32":
        return os.path.join(os.environ.get("LOCALAPPDATA", os.path.expanduser("~")), program, "Cache")
    return os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), program)


def _takes_files(folder: str) -> bool:
    """Return whether a file can be made in a folder, by doing so as numba does: rights do not tell of every disk."""
    import tempfile

    try:
        os.makedirs(folder, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def _writable(folder: str) -> bool:
    """Return whether a folder can be written, or could be made; nothing is made here."""
    while not os.path.lexists(folder) and os.path.dirname(folder) != folder:
        folder = os.path.dirname(folder)
    return os.path.isdir(folder) and os.access(folder, os.W_OK)


def is_kept(function: Any) -> bool:
    """Return whether code of a function of numba's is loaded or kept for this machine; True where nobody can tell."""
    if function.signatures:
        return True
    try:
        machine = function.targetctx.codegen().magic_tuple()
        return any(key[1] == machine for key in function._cache._cache_file._load_index())
    except Exception:
        # Inner parts of numba, of which each version has its own.
        return True


MOST_HELPERS = 3
_beginning = Lock()


def compile_beside(*modules: str) -> None:
    """Compile the programs of modules in processes beside this one, as far as there are processors.

    Each process takes what nobody has begun, this one what it needs next; it waits for what another has begun.  Nothing
    happens where the first module's programs are kept or no interpreter can be started.
    """
    from evenroad._njit import HELPERS, is_missing

    free = min(processors() - 1, MOST_HELPERS)
    python = os.path.basename(sys.executable or "").startswith("python")
    with _beginning:
        if free > 0 and python and not HELPERS and is_missing(modules[0]):
            _start_helpers(free, modules)


def _start_helpers(free: int, modules: tuple[str, ...]) -> None:
    import shutil
    import subprocess
    import tempfile

    from evenroad._njit import HELPERS, compile_all, share

    try:
        folder = tempfile.mkdtemp(prefix="evenroad-compiling-")
    except OSError:
        return
    share(folder)
    root, nowhere = os.path.dirname(os.path.dirname(os.path.abspath(__file__))), subprocess.DEVNULL
    work = f"from {compile_all.__module__} import compile_all; compile_all({[*modules]!r}, {folder!r})"
    # Compiling makes very many objects and little garbage.
    command = [sys.executable, "-c", f"import gc, sys; gc.disable(); sys.path.insert(0, {root!r}); {work}"]
    owner = os.getpid()

    def end() -> None:
        if os.getpid() == owner:
            for helper in HELPERS:
                if helper.poll() is None:
                    # Nobody waits for it any more; what it has finished is kept.
                    helper.terminate()
                    helper.wait()
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(end)
    for _ in range(free):
        try:
            helper = subprocess.Popen(command, stdin=nowhere, stdout=nowhere, stderr=nowhere)
        except OSError:
            return
        HELPERS.append(helper)


def processors() -> int:
    """Return how many processors this process may use; 1 for a worker of others, which use the rest."""
    import multiprocessing

    if multiprocessing.parent_process() is not None:
        return 1
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def defer_blas() -> None:
    """Keep numba from loading SciPy's linear algebra, a quarter of the start of a command, until code needs it.

    Numba only looks whether it is there, and looks again when it compiles a product of matrices.
    """
    name = "scipy.linalg.cython_blas"
    if name not in sys.modules:
        sys.modules[name] = ModuleType(name)
        try:
            import_module("numba.np.arraymath")
        finally:
            del sys.modules[name]


def say_if_compiling(module: str, function: str, seconds: int) -> bool:
    """Have it said that a first run takes so long, once code is compiled, if a function is yet to be; return whether.

    Not at once: bad input may be refused first.
    """
    defer_blas()
    try:
        compiled = getattr(import_module(module), function)
    except (ImportError, NotAvailable):
        # Where sixteen lanes cannot be had, others plan.
        return False
    if is_kept(compiled):
        return False
    # Compiling makes very many objects and little garbage.
    gc.set_threshold(100_000, 50, 50)
    from evenroad._njit import show_progress

    line = f"evenroad: compiling for this machine, once: about {seconds} s"
    show_progress(line, once=not sys.stderr.isatty())
    return True
