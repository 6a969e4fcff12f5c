"""numba's decorators for evenroad: cached code has a digest of its sources and its processor in its name.

Numba names what it keeps after the function, and sees changes in the function's own file only.  Here the name has a
digest of this file and all that it imports of evenroad, and one of numba and the processor: what is stale, or another
machine's, is never found, and two processes that save at once do not take each other's place.  Each file is sealed by
a digest: machine code with a flipped bit would not fail, but end the process or compute something else.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import pickle
import platform
import sys
import time
from collections.abc import Callable
from glob import escape, glob
from importlib import import_module
from subprocess import Popen
from typing import Any, ClassVar

import numba
import numpy
from llvmlite import binding
from numba.core import event
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

from evenroad._seal import read_sealed, sealed
from evenroad._sources import ROOT, digest_of, machine

_LOOK = 0.02
"""Seconds between two looks for what another process compiles."""
_BETWEEN_LINES = 0.2
"""Seconds between two lines of progress."""

HELPERS: list[Popen[bytes]] = []
"""Processes that compile for this one; see ``_compiled.compile_beside``."""


class _Claims:
    """Who of several processes compiles what: whoever makes a file of its name first, in a folder of theirs."""

    folder = ""
    own: ClassVar[set[str]] = set()


class _Taken(Exception):
    """Another process is compiling this."""


def share(folder: str) -> None:
    """Share what is to be compiled with the other processes that are given this folder."""
    _Claims.folder = folder


def _claim(name: str) -> bool:
    """Return whether it is this process that compiles a program."""
    if not _Claims.folder or name in _Claims.own:
        return True
    try:
        os.close(os.open(os.path.join(_Claims.folder, name), os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return False
    except OSError:
        # The folder is gone: the others have ended.
        return True
    _Claims.own.add(name)
    return True


class _Part(JITCodeLibrary):
    """Code that is only ever put into other code: numba would make it ready to run by itself, too."""

    def get_pointer_to_function(self, name: str) -> int:
        self._ensure_finalized()
        return 0

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    @property
    def codegen(self) -> Any:
        """What would be told where the Python objects of running code are: this does not run."""
        return _Nobody


class _RawPart(_Part):
    """Such code that is not even optimized by itself: that is done where it is put."""

    def _optimize_final_module(self) -> None:
        return


class _Nobody:
    """Stands for who runs code, of code that does not run."""

    @staticmethod
    def set_env(name: str, env: object) -> None:
        """Do nothing."""


class _PartCompiler(Compiler):
    """Numba's compiler, for parts of the checks, which are to be as quick as they can be."""

    part: ClassVar[type[_Part]] = _Part

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        super().__init__(typing, target, library or self.part(target.codegen(), "part"), *rest)


class _RawPartCompiler(_PartCompiler):
    """For parts of planners, which spend their time in checks that they call: what is compiled sooner is better."""

    part = _RawPart


def njit(*function: Callable[..., Any], **options: Any) -> Any:
    """Return what ``numba.njit`` does, kept as this module says where `cache` is asked for.

    What Python cannot call is compiled as a part of what calls it, in half of the time; a part of planners where
    `_nrt` is False, as of ``layout.quick``.
    """
    if not options.pop("cache", False):
        if options.get("no_cpython_wrapper"):
            options["pipeline_class"] = _PartCompiler if options.get("_nrt", True) else _RawPartCompiler
        return numba.njit(*function, **options)
    compiler = numba.njit(**options)

    def decorate(function: Callable[..., Any]) -> Any:
        compiled = compiler(function)
        if hasattr(compiled, "enable_caching"):
            compiled._cache = KernelCache(function)
        return compiled

    return decorate(*function) if function else decorate


def cfunc(signature: Any, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return what ``numba.cfunc`` does, always kept."""
    options.pop("cache", None)

    def decorate(function: Callable[..., Any]) -> Any:
        compiled: Any = CFunc(function, (signature.args, signature.return_type), locals={}, options=options)
        compiled._cache = KernelCache(function)
        compiled.compile()
        return compiled

    return decorate


def compile_all(modules: list[str], folder: str) -> None:
    """Compile the programs of modules that no other process compiles, as a helper: see `share`.

    These are what Python calls with numbers alone, and what is called by its address.
    """
    share(folder)
    for name in modules:
        for made in list(vars(import_module(name)).values()):
            try:
                if getattr(made, "__module__", "") != name:
                    continue
                if isinstance(getattr(made, "_cache", None), KernelCache):
                    parameters = inspect.signature(made.py_func).parameters.values()
                    made.compile(tuple(_NUMBERS[each.annotation] for each in parameters))
                elif getattr(made, "__name__", "").endswith("_address"):
                    made()
            except _Taken:
                continue


def is_missing(name: str) -> bool:
    """Return whether a module has a program that is neither loaded nor kept; False where it cannot be had."""
    try:
        made = vars(import_module(name)).values()
    except Exception:
        # The vector type, which not every machine and version has; others plan then.
        return False
    own = [each for each in made if isinstance(getattr(each, "_cache", None), KernelCache)]
    return any(not (each.signatures or each._cache.holds_any()) for each in own if each.__module__ == name)


_NUMBERS = {
    "int": numba.int64,
    "float": numba.float64,
    "Pair": numba.types.UniTuple(numba.int64, 2),
    "Given": numba.types.Tuple([numba.int64, numba.float64, *[numba.int64] * 4]),
}
"""What parameters of programs may be, see ``robot.kernel.layout``."""


class _Progress(event.Listener):
    """A line that counts seconds while code is compiled, and goes when there is no more for now; or is said once."""

    def __init__(self) -> None:
        self.line, self.once, self._depth, self._shown = "", False, 0, 0.0
        self._began = time.monotonic()

    def on_start(self, event: Any) -> None:
        self._depth += 1
        self._show()

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        self._show()
        if self._depth == 0 and not self.once:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
            self._shown = 0.0

    def _show(self) -> None:
        if self.once:
            if self.line:
                print(self.line, file=sys.stderr, flush=True)
            self.line = ""
        elif (now := time.monotonic()) - self._shown > _BETWEEN_LINES:
            self._shown = now
            print(f"\r{self.line}; {now - self._began:.0f} s", end="", file=sys.stderr, flush=True)


def show_progress(line: str, once: bool = False) -> None:
    """Show a line, and what it takes so far, whenever code is compiled from now on; or `once`, without that."""
    global _progress
    if _progress is None:
        _progress = _Progress()
        event.register("numba:compile", _progress)
    _progress.line, _progress.once = line, once


_progress: _Progress | None = None


class _Files(IndexDataCacheFile):
    """Names data by what it is for, not by number, and writes it before the index that tells of it; all sealed."""

    def save(self, key: Any, data: Any) -> None:
        name = self._data_name(int(hashlib.sha256(repr(key).encode()).hexdigest()[:12], 16))
        self._save_data(name, data)
        self._save_index({**self._load_index(), key: name})

    def _load_index(self) -> dict[Any, str]:
        stamp, names = self._read(self._index_name) or (None, {})
        return names if stamp == self._source_stamp else {}

    def _save_index(self, names: dict[Any, str]) -> None:
        self._write(self._index_name, (self._source_stamp, names))

    def _load_data(self, name: str) -> Any:
        return self._read(name)

    def _save_data(self, name: str, data: Any) -> None:
        self._write(name, data)

    def _read(self, name: str) -> Any:
        """Return what is kept in a file; None where there is none, or it was damaged."""
        content = read_sealed(self._data_path(name), name, "compiled code")
        # Numba keeps machine code in this form; the digest was checked before a byte of it is read.
        return None if content is None else pickle.loads(content)

    def _write(self, name: str, value: Any) -> None:
        with self._open_for_write(self._data_path(name)) as file:
            file.write(sealed(self._dump(value), name))


class _Named(CompileResultCacheImpl):
    """Says what files are called; numba says in which folder."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._source = inspect.getfile(function)
        super().__init__(function)

    def get_filename_base(self, name: str, abiflags: str) -> str:
        base: str = super().get_filename_base(name, abiflags)
        line = self.locator.get_disambiguator()
        self.any_source = f"{escape(name)}-*{escape(base.removeprefix(f'{name}-{line}'))}.{machine()}-*.nb[ci]"
        return f"{base}.{machine()}-{digest_of(self._source)}"


class KernelCache(FunctionCache):
    """What is kept of a function of evenroad's."""

    _impl_class = _Named

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        impl = self._impl
        self._cache_file = _Files(self._cache_path, impl.filename_base, impl.locator.get_source_stamp())

    def holds_any(self) -> bool:
        """Return whether code for any kind of arguments is kept."""
        return bool(self._cache_file._load_index())

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return compiled code that was kept, or that another process is just making; else None."""
        found = super().load_overload(sig, target_context)
        if found is not None or _claim(self._impl.filename_base):
            return found
        if not HELPERS:
            raise _Taken
        # Events, so that clocks stand still and progress is seen.
        data = {"waiting": self._py_func.__module__}
        with event.trigger_event("numba:compile", data=data):
            while any(helper.poll() is None for helper in HELPERS) and not self.holds_any():
                time.sleep(_LOOK)
                with event.trigger_event("numba:compile", data=data):
                    continue
        return super().load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep compiled code where that can be written, and remove what was kept of earlier sources."""
        try:
            super().save_overload(sig, data)
        except OSError:
            # A full disk, or a file that is not ours: the next run compiles again, and that is all.
            return
        own = self._impl.filename_base + "."
        for path in glob(self._impl.any_source, root_dir=self._cache_path):
            if not path.startswith(own):
                try:
                    os.unlink(os.path.join(self._cache_path, path))
                except OSError:
                    # Another process was quicker, or the file is not ours to remove.
                    continue


def surroundings() -> dict[str, str]:
    """Return what code is compiled by and for, and in which folder it is kept."""
    versions = (
        ("Python", platform.python_version()),
        ("numpy", numpy.__version__),
        ("numba", numba.__version__),
    )
    folder = KernelCache(_claim).cache_path
    beside = os.path.basename(folder) == "__pycache__"
    return {
        "runs on": ", ".join(" ".join(each) for each in versions),
        "processor": f"{binding.get_host_cpu_name()} ({machine()})",
        "compiled code": f"{ROOT}/**/__pycache__" if beside else os.path.dirname(folder),
    }
