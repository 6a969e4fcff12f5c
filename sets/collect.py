"""Collects for the wheel what evenroad's own leaves out: one list, in evenroad's pyproject.toml, serves both."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

DATA = "src/evenroad/points/bank/data"


class Collect(BuildHookInterface):  # type: ignore[misc]
    """Puts each file that matches an `exclude` of evenroad's wheel into the folder of its family."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the files to those of the wheel."""
        checkout = Path(self.root).parent
        settings = tomllib.loads((checkout / "pyproject.toml").read_text(encoding="utf-8"))
        patterns = settings["tool"]["hatch"]["build"]["targets"]["wheel"]["exclude"]
        files = sorted(file for pattern in patterns for file in checkout.glob(pattern))
        for file in files:
            inside = file.relative_to(checkout / DATA)
            build_data["force_include"][str(file)] = f"evenroad_sets/data/{inside.as_posix()}"
