"""Write the address of the repository into all files that name it: once, before the first release.

python tools/name_repository.py https://github.com/OWNER/evenroad
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROJECTS = ("pyproject.toml", "studies/pyproject.toml", "checker/pyproject.toml")
PAGES = {"Repository": "", "Issues": "/issues", "Changelog": "/blob/main/CHANGELOG.md"}
ADDRESS = re.compile(r"https://[\w.-]+(?:/[\w.-]+)+")


def write_address(root: Path, address: str) -> list[Path]:
    """Write an address into the files below a folder, in place of one that is there; return what changed."""
    if not ADDRESS.fullmatch(address):
        raise SystemExit(f"the address must be like https://github.com/OWNER/evenroad, got {address!r}")
    address = address.removesuffix(".git")
    urls = "[project.urls]\n" + "".join(f'{name} = "{address}{page}"\n' for name, page in PAGES.items())
    changes = dict.fromkeys(PROJECTS, (r"(?m)^\[project\.urls\]\n(?:\w+ = .*\n)*", urls))
    changes["CITATION.cff"] = (r"(?m)^repository-code: .*\n", f'repository-code: "{address}"\n')
    changes["packaging/recipe.yaml"] = (r"(?m)^  repository: .*\n", f"  repository: {address}\n")
    changed = []
    for name, (pattern, text) in changes.items():
        file = root / name
        said = file.read_text(encoding="utf-8")
        found, count = re.subn(pattern, lambda _, text=text: text, said)
        if count != 1:
            raise SystemExit(f"{name} has no place for the address, or several")
        if found != said:
            file.write_text(found, encoding="utf-8")
            changed.append(file)
    return changed


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    for each in write_address(ROOT, sys.argv[1]):
        print(f"wrote {each.relative_to(ROOT)}")
