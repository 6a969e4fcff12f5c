"""Methods of a plan: show it, save it, sample it, make a trajectory of it."""

from __future__ import annotations

import os
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from evenroad._above import above
from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad.errors import InvalidValue
from evenroad.space.path import path_length, resample
from evenroad.world import World


@explains_calls
class ResultMethods:
    """Methods of :class:`evenroad.PlanResult`."""

    if TYPE_CHECKING:
        status: Any
        message: str
        path: Floats | None
        cost: float | None
        proof: str | None
        timings: dict[str, float]
        world: World | None

    @property
    def seconds(self) -> float:
        """Wall time of the query [s]: the sum of `timings`."""
        return sum(self.timings.values())

    @cached_property
    def length(self) -> float | None:
        """Length of `path` in the metric of the space; None without a path or a world."""
        if self.path is None or self.world is None:
            return None
        return path_length(self.path, self.world.space)

    @cached_property
    def bodies(self) -> str | None:
        """The kinds of the robot's bodies that the answer is about, as ``hulls and meshes`` or ``capsules``.

        None of what is no arm.
        """
        return getattr(self.world, "bodies", None)

    @property
    def _proved(self) -> str:
        """What is shown, and about which bodies."""
        return str(self.proof) if self.bodies is None else f"{self.proof} ({self.bodies})"

    def resample(self, step: float) -> Floats:
        """Return states along the path.

        Parameters
        ----------
        step : float
            Largest distance between neighbours, > 0, in the metric of the space.

        Returns
        -------
        ndarray, shape (s, dim)
            States of the path, waypoints included.

        Raises
        ------
        InvalidValue
            If `step` is not a finite number > 0, or there is no path.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> er.plan(world, (3, 3), (27, 17)).resample(0.5).shape
        (57, 2)
        """
        path, world = self._required("resampled")
        return resample(path, world.space, step)[0]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the plan to a file, atomically.

        Parameters
        ----------
        path : str or path-like
            ``.json``, all of it; ``.csv``, the waypoints; ``.png``, a picture.

        Raises
        ------
        UnknownName
            For another suffix.
        InvalidValue
            For a ``.csv`` without a path.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     er.plan(world, (3, 3), (27, 17)).save(f"{folder}/plan.json")
        ...     er.io.load_plan(f"{folder}/plan.json")[0].status
        <Status.SOLVED: 'solved'>
        """
        above("PlanResult.save")(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Return a plan that was saved, without its world, origin and searched graph.

        Parameters
        ----------
        path : str or path-like
            A ``.json`` of :meth:`save` or ``evenroad plan``; :func:`evenroad.io.load_plan` also returns the query.

        Returns
        -------
        PlanResult

        Raises
        ------
        BrokenFile
            If the file is missing, or is no such plan.

        Examples
        --------
        >>> import tempfile
        >>> import numpy as np
        >>> import evenroad as er
        >>> result = er.plan(er.GridMap(np.zeros((20, 30), dtype=bool)).world(2), (3, 3), (27, 17))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     result.save(f"{folder}/plan.json")
        ...     er.PlanResult.load(f"{folder}/plan.json").cost == result.cost
        True
        """
        plan: Self = above("PlanResult.load")(path)[0]
        return plan

    def plot(self, path: str | os.PathLike[str] | None = None, *, world: World | None = None) -> Any:
        """Return a picture of the plan, a PIL image, which a notebook shows; save it if a file is named.

        Parameters
        ----------
        path : str or path-like, optional
            A ``.png``.
        world : World, optional
            Default: the world of the plan.  Disks on maps and arms can be drawn.

        Returns
        -------
        PIL.Image.Image

        Raises
        ------
        NotAvailable
            If it is another world, or none is known.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> er.plan(world, (3, 3), (27, 17)).plot().mode
        'RGB'
        """
        return above("PlanResult.plot")(self, path, world)

    def trajectory(self, limits: Any = None, *, speed: float = 1.0, **options: Any) -> Any:
        """Return the path with times; the motion as driven is checked.

        Parameters
        ----------
        limits : Limits, or the file of a ``joint_limits.yaml``, optional
            Default: those of the robot; of worlds without one as `speed` says.
        speed : float
            With limits, 0 < speed <= 1: takes ``1 / speed`` as long as at full speed.  Without, as on a map: the
            largest speed along the path, > 0 [units of the map per second], which is reached in half a second.
        **options
            As :func:`evenroad.trajectory.arm_trajectory` takes them.

        Returns
        -------
        Trajectory

        Raises
        ------
        InvalidValue
            If there is no path, or there are no limits; else as :func:`evenroad.trajectory.make_trajectory`.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0)
        Trajectory(5.992 s, 2 joints, 750 states)
        """
        path, world = self._required("driven")
        return above("PlanResult.trajectory")(world, path, limits, speed=speed, **options)

    def _required(self, how: str) -> tuple[Floats, World]:
        """Return path and world, or raise InvalidValue that names the missing one."""
        if self.path is None:
            raise InvalidValue(f"there is no path that could be {how}: {self.message}")
        if self.world is None:
            raise InvalidValue(f"this plan does not know its world, without which it cannot be {how}")
        return self.path, self.world

    def __repr__(self) -> str:
        parts = [str(self.status)]
        if self.path is not None:
            parts += [f"{len(self.path)} waypoints", self._proved]
        if self.cost is not None:
            parts.insert(1, f"cost {self.cost:.4g}")
        took = self.seconds
        parts.append(f"{took:.3g} s" if took >= 1.0 else f"{1e3 * took:.3g} ms")
        return f"{type(self).__name__}({', '.join(parts)})"
