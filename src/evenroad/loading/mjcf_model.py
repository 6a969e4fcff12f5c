"""A compiled MJCF: MuJoCo's model, the names in it, and notes on what is read otherwise than it stands there."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mujoco import MjModel


@dataclass(frozen=True, eq=False)
class CompiledMjcf:
    """A model that MuJoCo compiled from the file `where`."""

    mujoco: ModuleType
    model: MjModel
    where: str
    notes: list[str] = field(default_factory=list)

    def name(self, kind: str, number: int) -> str:
        """Return the name of a body, joint, geom or other element by its number; `kind` and number if it has none."""
        return str(getattr(self.model, kind)(number).name) or f"{kind}_{number}"

    def kind_of(self, enumeration: str, prefix: str, value: int) -> str:
        """Return the word for a value of one of MuJoCo's enumerations, such as ``hinge`` for ``mjJNT_HINGE``."""
        return str(getattr(self.mujoco, enumeration)(int(value)).name).removeprefix(prefix).lower()
