"""The file of a robot, how it is to be read, and where the packages and meshes are that it names."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from evenroad.errors import BrokenFile
from evenroad.loading.xml_file import read_xml


@dataclass(frozen=True)
class RobotFile:
    """The file of a robot, and how it is to be read.

    With `use_visuals`, links without collision geometry get what is drawn of them; with `as_drawn` all links do, where
    anything is.  With `upright_meshes`, the y axis of a glTF becomes z.  `packages` are folders of packages, (name,
    folder), beside those that are found; `arguments` are those of a xacro, (name, value).
    """

    path: Path
    use_visuals: bool = False
    packages: tuple[tuple[str, str], ...] = ()
    arguments: tuple[tuple[str, str], ...] = ()
    as_drawn: bool = False
    upright_meshes: bool = False


def package_folder(name: str, file: RobotFile) -> Path:
    """Return the folder of a package; LookupError if there is none."""
    for folder in _package_folders(name, file):
        if folder.is_dir():
            return folder
    raise LookupError(name)


def find_mesh(name: str, file: RobotFile, link: str) -> Path:
    """Return the file that a URDF means by `name`.

    ``package://PACKAGE/FILE`` is looked for in the given packages, in the folder of the URDF and those above it, either
    inside of a folder PACKAGE, or one whose ``package.xml`` has this name, or in one, and where ROS keeps packages
    (``ROS_PACKAGE_PATH``, ``AMENT_PREFIX_PATH``); so is what a xacro finds.
    ``file://`` is absolute; all else is relative to the URDF.  Raises BrokenFile if there is none; the text says where
    it was looked for.
    """
    candidates = list(_candidates(name, file))
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    looked = ", ".join(str(candidate) for candidate in candidates[:4]) + (", ..." if len(candidates) > 4 else "")
    package = name.removeprefix("package://").partition("/")[0] if name.startswith("package://") else ""
    hint = f"; --package {package}=FOLDER says where that package is" if package else ""
    where = f"of link {link!r} in {file.path}"
    raise BrokenFile(f"the mesh {name!r} {where} is missing; looked for {looked}{hint}")


def _candidates(name: str, file: RobotFile) -> Iterator[Path]:
    folder = file.path.absolute().parent
    scheme, separator, rest = name.partition("://")
    if not separator:
        yield folder / name
        return
    # Imported late: it brings much, and few meshes are URLs.
    from urllib.parse import unquote

    rest = unquote(rest)
    if scheme == "file":
        yield Path(rest)
        return
    package, _, inside = rest.partition("/")
    for found in _package_folders(package, file):
        yield found / inside


def _package_folders(package: str, file: RobotFile) -> Iterator[Path]:
    """Yield the folders in which a package may be, whether they exist or not."""
    given, folder = dict(file.packages), file.path.absolute().parent
    if package in given:
        yield Path(given[package])
    for above in (folder, *folder.parents):
        if package in (above.name, _said_name(above / "package.xml")):
            yield above
        yield above / package
    for root in _paths("ROS_PACKAGE_PATH"):
        yield root if root.name == package else root / package
    for root in _paths("AMENT_PREFIX_PATH"):
        yield root / "share" / package


def _said_name(manifest: Path) -> str:
    """Return the name that a ``package.xml`` gives its package, if it is there."""
    try:
        return (read_xml(manifest, "package", "a package", "package").findtext("name") or "").strip()
    except BrokenFile:
        return ""


def _paths(variable: str) -> list[Path]:
    return [Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry]
