"""The digest of the kernel's sources, which each build carries: an editable install loads no build of other sources.

CMake writes it for C++ by `python digest.py HEADER`.
"""

from __future__ import annotations

import hashlib
import os
import sys

SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cpp")
"""Where a clone has the sources; an installed wheel has none."""


def digest_of(folder: str) -> str:
    """Return the digest of all sources in the folders of this folder: of their names and contents."""
    digest = hashlib.sha256()
    for part in sorted(os.listdir(folder)):
        for name in sorted(os.listdir(os.path.join(folder, part))):
            if name.endswith((".cpp", ".hpp")):
                with open(os.path.join(folder, part, name), "rb") as file:
                    content = file.read()
                digest.update(f"{part}/{name} {len(content)}\n".encode())
                digest.update(content)
    return digest.hexdigest()[:16]


if __name__ == "__main__":
    with open(sys.argv[1], "w", encoding="ascii") as header:
        header.write(f'#define EVENROAD_SOURCES "{digest_of(SOURCES)}"\n')
