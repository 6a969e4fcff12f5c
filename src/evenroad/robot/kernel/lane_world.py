"""LaneWorld: a robot in a scene as compiled programs take it, by addresses."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._shared import once, once_property
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import address
from evenroad.robot.kernel.layout import LANES, MOST_WAITING, WORKSPACE, Given
from evenroad.robot.kernel.scene_surfaces import SceneSurfaces

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class LaneWorld:
    """A robot in a scene as compiled programs take it.

    Attributes
    ----------
    tables : int64 array
        ``ArmTables.lanes``.
    by_joint : float64 array
        In one piece: low, high and period of each joint, (3, dim); how fast each moves each capsule, (dim, capsules),
        and the two of a pair against each other, (dim, capsule pairs), at most [m/rad].
    resolution : float
        Largest distance between neighbouring states of a motion.
    at : tuple of two int, optional
        Addresses of the two arrays, where they are known.
    surfaces : SceneSurfaces, optional
        The clouds and meshes of the scene.
    """

    tables: npt.NDArray[np.int64]
    by_joint: Floats
    resolution: float
    at: tuple[int, int] | None = None
    surfaces: SceneSurfaces | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how a copy is made, here or in another process: it finds out for itself where its arrays are."""
        return LaneWorld, (self.tables, self.by_joint, self.resolution, None, self.surfaces)

    def arguments(self, more: int) -> tuple[Floats, Given]:
        """Return `more` doubles of memory, and what a program ends with: what ``checks_of`` takes, and their address.

        The memory is this thread's, for the next call of a program only.
        """
        checks, tables, by_joint, doubles = self.addresses
        array, begin = _memory.array, _memory.address
        if len(array) < doubles + more:
            array = _memory.array = np.empty(doubles + more)
            begin = _memory.address = address(array)
        given = checks, self.resolution, tables, by_joint, begin, begin + 8 * doubles
        return array[doubles : doubles + more], given

    @once_property
    def addresses(self) -> tuple[int, int, int, int]:
        """Addresses of the checks and of the two arrays, and how much memory a program's checks need."""
        header = self.tables[: at.HEADER].tolist()
        dim, things = header[at.COORDINATES], header[at.CAPSULES] + header[at.PAIRS]
        floats = (LANES + 3) * dim + LANES + things + 2 * MOST_WAITING
        doubles = WORKSPACE + 2 * LANES + floats + header[at.SCRATCH] // 2 + len(self.tables)
        checks = _address_of_checks(header[at.HULL_PAIRS] > 0)
        tables, by_joint = self.at or (address(self.tables), address(self.by_joint))
        if self.surfaces is not None:
            tables = address(self._with_surfaces)
        return checks, tables, by_joint, doubles

    @once_property
    def _with_surfaces(self) -> Ints:
        """The tables with the addresses of clouds and meshes, where there are any."""
        assert self.surfaces is not None
        from evenroad.robot.kernel.surface_contact import surface_check_address

        return self.surfaces.added_to(self.tables, surface_check_address())


class _Memory(threading.local):
    """What a thread's programs work in: taken anew, it would cost as much as a short motion."""

    array: Floats = np.empty(0)
    address: int = 0


_memory = _Memory()


@once
def check_addresses(with_hulls: bool) -> Ints:
    """Return the addresses of the checks of a motion, of sixteen configurations and of hulls, good for this process.

    They are compiled when first asked for; that of hulls, which few robots have, is 0 without them.
    """
    # Imported late: where the vector type cannot even be defined, all else still works.
    from evenroad.robot.kernel.lane_check import check_address
    from evenroad.robot.kernel.motion_checks import motion_check_address

    hulls = 0
    if with_hulls:
        from evenroad.robot.kernel.hull_lanes import meeting_address

        hulls = meeting_address()
    return np.array([motion_check_address(), check_address(), hulls])


@cache
def _address_of_checks(with_hulls: bool) -> int:
    return address(check_addresses(with_hulls))
