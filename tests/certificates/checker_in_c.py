"""The checker in C, compiled once, as a command and as a process that checks many certificates."""

import hashlib
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.certificates.written import accepts

SOURCES = Path(__file__).parents[2] / "checker" / "c"
STRICT = ["-std=c99", "-O1", "-g", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
SANITIZERS = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
ACCEPTED, REFUSED, BAD_INPUT = 0, 1, 2


def compilers():
    """Return commands that may compile C, the first one that works is taken: yours, the system's, clang's wheel."""
    found = [shlex.split(os.environ["CC"])] if "CC" in os.environ else []
    found += [[path] for name in ("gcc", "clang", "cc") if (path := shutil.which(name))]
    with_sanitizers = [[*command, *SANITIZERS] for command in found]
    wheel = [[sys.executable, "-m", "ziglang", "cc"]] if find_spec("ziglang") else []
    return [*with_sanitizers, *found, *wheel]


@cache
def program(name):
    """Return the compiled `command`, or `serve`, which checks many certificates; skip where nothing compiles C."""
    sources = sorted(SOURCES.glob("*.c"))
    if name == "serve":
        sources = [*(each for each in sources if each.name != "main.c"), Path(__file__).with_name("serve.c")]
    content = b"".join(each.read_bytes() for each in (*sources, *sorted(SOURCES.glob("*.h"))))
    kept = Path(tempfile.gettempdir()) / f"evenroad-{name}-{hashlib.sha256(content).hexdigest()[:20]}"
    if kept.is_file():
        return kept
    for compiler in compilers():
        made = Path(tempfile.mkdtemp()) / name
        line = [*compiler, *STRICT, f"-I{SOURCES}", *map(str, sources), "-lm", "-o", str(made)]
        done = subprocess.run(line, capture_output=True, text=True)
        if done.returncode == 0:
            os.replace(shutil.copy(made, f"{kept}.{os.getpid()}"), kept)
            return kept
    if not compilers():
        pytest.skip("no compiler of C: set CC, or install ziglang")
    return pytest.fail(done.stderr)


class ManyChecks:
    """A process that checks certificates about the files of one robot and scene at a time."""

    def __init__(self):
        self._process = subprocess.Popen([program("serve")], stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.stdin.close()
        assert self._process.wait(30) == 0, "the checker in C stopped"
        self._process.stdout.close()

    def read(self, robot, scene, srdf=None):
        """Return the exit code of reading some files."""
        return self._ask(b"R", "\n".join((str(robot), str(scene), str(srdf or ""))).encode())

    def code(self, certificate):
        """Return the exit code of a certificate about the files that were read last."""
        return self._ask(b"C", bytes(certificate))

    def accepts(self, certificate):
        """Return whether a certificate is accepted; anything but a refusal is an error."""
        code = self.code(certificate)
        assert code in (ACCEPTED, REFUSED)
        return code == ACCEPTED

    def agrees(self, certificate, inputs):
        """Return whether a certificate is accepted, which the checker in Python must say, too."""
        said = self.accepts(certificate)
        assert accepts(bytes(certificate), inputs) == said
        return said

    def _ask(self, letter, data):
        self._process.stdin.write(letter + struct.pack("<I", len(data)) + data)
        self._process.stdin.flush()
        code = self._process.stdout.read(1)
        assert code, "the checker in C stopped"
        return code[0]
