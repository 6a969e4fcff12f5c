"""Files that commands write: none overwrites a file that is read, and each can be written."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from evenroad._files import require_writable_folder
from evenroad.errors import InvalidValue


def require_output(option: str, file: Path, inputs: Iterable[Path | None]) -> None:
    """Raise InvalidValue for a file that would overwrite an input, BrokenFile for one that cannot be written."""
    if file.resolve() in {each.resolve() for each in inputs if each is not None}:
        raise InvalidValue(f"{option} would overwrite the file {file}")
    require_writable_folder(file)


def require_certifiable(
    certificate: Path | None, bodies: Path | None, inputs: Iterable[Path | None], *, embed: bool = False
) -> None:
    """Raise InvalidValue for a certificate of bodies that the robot's file lacks; else as `require_output`."""
    if certificate is not None:
        if bodies is not None:
            raise InvalidValue("--certificate goes without --bodies: it is about the bodies of the robot's file")
        require_output("--certificate", certificate, inputs)
    elif embed:
        raise InvalidValue("--embed goes with --certificate, which carries the robot and its scene")
