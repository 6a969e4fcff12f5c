"""Trajectory: states of all joints over time."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._checks import as_times, counted, require_known, require_positive
from evenroad._hints import KnowsElsewhere
from evenroad._rows import Rows
from evenroad.errors import InvalidValue, shown
from evenroad.trajectory.limits import Limits
from evenroad.world import World

ON_MAPS = "x", "y", "angle"
"""Names of what moves in place of joints on a map; a disk has the first two."""
MOST_SAMPLES = 1_000_000
"""Largest number of rows that a trajectory is sampled at."""
STEP = 0.008
"""Time between two states of a trajectory [s]: the cycle of a UR controller, 125 Hz."""


@explains_calls
@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Trajectory(Rows, metaclass=KnowsElsewhere):
    """States of a robot at equal steps of time, from rest to rest; to NumPy the rows of its positions.

    Attributes
    ----------
    names : tuple of str
        Names of the joints.
    times : ndarray, shape (n,)
        Times from 0, at equal steps [s].
    positions, velocities, accelerations : ndarrays, shape (n, dim)
        [rad or m, and per second].
    waypoints : ndarray, shape (p, dim)
        Waypoints of the path.
    limits : Limits
        Limits that it keeps.
    deviation : float
        Largest distance from the path [rad or m].
    stops : int
        Number of corners at which the robot stops because a rounded corner would collide.
    highest : mapping of str to float
        Largest used shares of limits: ``velocity``, ``acceleration``, ``jerk`` and so on.  They are upper bounds; with
        a limit of jerk, of a tip or of torques, and in motion, they are measured on a fine grid.
    held : mapping of str to float
        Joints of the same controller that do not move, and their positions [rad or m].
    controller : tuple of str
        All joints of the controller, in its order; empty if unknown.
    proof : str
        Proof of the motions from state to state: ``exact``, ``certified`` or ``resolution``; ``unchecked`` without a
        world, and from a file, until :func:`evenroad.trajectory.proved_in`.
    radii : tuple of float
        Distance of the tip from each inner waypoint at which rounding may begin [m], see
        :func:`evenroad.trajectory.urscript.with_radii`; empty if not computed.
    source : mapping of str to JSON values
        Inputs of the ``evenroad plan`` or ``evenroad run`` that made it; empty if unknown.
    world : World or None
        World that it was made in; None if unknown.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> trajectory = er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0)
    >>> trajectory
    Trajectory(5.992 s, 2 joints, 750 states)
    """

    names: tuple[str, ...]
    times: Floats
    positions: Floats
    velocities: Floats
    accelerations: Floats
    waypoints: Floats
    limits: Limits
    deviation: float
    stops: int = 0
    highest: Mapping[str, float] = field(default_factory=dict)
    held: Mapping[str, float] = field(default_factory=dict)
    controller: tuple[str, ...] = ()
    proof: str = "unchecked"
    radii: tuple[float, ...] = ()
    source: Mapping[str, Any] = field(default_factory=dict)
    world: World | None = None

    def to_ros(self, order: Sequence[str] | None = None) -> Any:
        """Return it as a message of ROS 2, ``trajectory_msgs/JointTrajectory``.

        Parameters
        ----------
        order : sequence of str, optional
            The joints of the controller, in its order; default: moving joints, then held ones.

        Returns
        -------
        trajectory_msgs.msg.JointTrajectory

        Raises
        ------
        NotAvailable
            If there is no ROS: source a workspace, or install the extra ``ros2``.
        UnknownName, InvalidValue
            For an unknown joint, or a moving one that is missing.

        Examples
        --------
        >>> import evenroad as er
        >>> trajectory = er.plan("box-reach", "home", "inside", robot="ur5").trajectory()
        >>> try:
        ...     message = trajectory.to_ros()
        ... except er.errors.NotAvailable:  # without ROS
        ...     pass
        """
        from evenroad.ros2.messages import ros_message
        from evenroad.trajectory.formats import joint_trajectory

        return joint_trajectory(self, ros_message, order)

    def at(self, t: npt.ArrayLike) -> Floats:
        """Return positions at given times; between states they follow a cubic of positions and velocities.

        Parameters
        ----------
        t : array_like
            Times, 0 <= t <= duration [s].

        Returns
        -------
        ndarray, shape (..., dim)
            [rad or m].

        Raises
        ------
        InvalidValue
            For a time outside of it.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> trajectory = er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0)
        >>> trajectory.at([0.0, trajectory.duration]).round(9).tolist()
        [[3.0, 3.0], [27.0, 17.0]]
        """
        times = as_times(t, self.duration)
        if len(self.times) == 1:
            return np.broadcast_to(self.positions[0], (*times.shape, len(self.names))).copy()
        return self._between(times)

    __call__ = at

    def _between(self, times: Floats) -> Floats:
        """Return the cubics between the states around each time: those of SciPy's CubicHermiteSpline, of few states."""
        before = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2)
        after = before + 1
        lasts = (self.times[after] - self.times[before])[..., np.newaxis]
        since = (times - self.times[before])[..., np.newaxis]
        slope = (self.positions[after] - self.positions[before]) / lasts
        bend = (self.velocities[before] + self.velocities[after] - 2 * slope) / lasts
        square, cube = (slope - self.velocities[before]) / lasts - bend, bend / lasts
        linear = self.positions[before] + self.velocities[before] * since
        return np.asarray(linear + square * (since * since) + cube * (since * since * since))

    def sample(self, dt: float) -> Floats:
        """Return positions at times 0, dt, 2 dt, ... and at the end.

        Parameters
        ----------
        dt : float
            Time between two rows, > 0 [s].

        Returns
        -------
        ndarray, shape (n, dim)
            [rad or m].

        Raises
        ------
        InvalidValue
            If `dt` is not a finite number > 0, or so small that there would be more than a million rows.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0).sample(0.5).shape
        (13, 2)
        """
        count = self.duration / require_positive("dt", dt)
        if count > MOST_SAMPLES:
            raise InvalidValue(f"dt must be at least {self.duration / MOST_SAMPLES:.3g} s here, got {shown(dt)}")
        return self.at(np.append(np.arange(np.ceil(count - 1e-9)) * dt, self.duration))

    @property
    def _rows(self) -> Floats:  # type: ignore[override]
        return self.positions

    def columns(self, order: Sequence[str] | None = None) -> tuple[tuple[str, ...], tuple[Floats, Floats, Floats]]:
        """Return names, positions, velocities and accelerations of moving and held joints.

        Parameters
        ----------
        order : sequence of str, optional
            Order of the joints.  Default: that of the controller, else moving ones first.

        Returns
        -------
        tuple of str, and tuple of three ndarrays, shape (n, joints)

        Raises
        ------
        UnknownName
            For an unknown joint.
        InvalidValue
            If a moving one is missing.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> trajectory = er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0)
        >>> trajectory.columns()[0]
        ('x', 'y')
        """
        order = tuple(order or self.controller or (*self.names, *self.held))
        for name in order:
            require_known("joint of the trajectory", name, (*self.names, *self.held))
        if missing := sorted(set(self.names) - set(order)):
            raise InvalidValue(f"the order of joints must have every one that moves; {missing[0]!r} is not in it")
        tables = []
        for rows, held in ((self.positions, self.held), (self.velocities, {}), (self.accelerations, {})):
            own = dict(zip(self.names, rows.T, strict=True))
            constant = {name: np.full(len(rows), held.get(name, 0.0)) for name in self.held}
            tables.append(np.column_stack([(constant | own)[name] for name in order]))
        return order, (tables[0], tables[1], tables[2])

    def only(self, names: Sequence[str]) -> Trajectory:
        """Return the trajectory of some of its joints, such as those of one controller; all others are left out.

        Parameters
        ----------
        names : sequence of str
            Joints that move, one or more, in any order.

        Returns
        -------
        Trajectory
            Its proof is ``unchecked``: it is that of all joints.

        Raises
        ------
        UnknownName
            For a joint that does not move here.
        InvalidValue
            For no joint, or one that is named twice.

        Examples
        --------
        >>> import evenroad as er
        >>> trajectory = er.plan("box-reach", "home", "inside", robot="ur5").trajectory()
        >>> trajectory.only(["elbow_joint"]).positions.shape[1]
        1
        """
        names = (names,) if isinstance(names, str) else tuple(names)
        for name in names:
            require_known("joint of the trajectory", name, self.names)
        if not names or len(set(names)) < len(names):
            raise InvalidValue(f"names must be one joint or more, each once, got {shown(names)}")
        columns = [self.names.index(name) for name in names]
        tables = ("positions", "velocities", "accelerations", "waypoints")
        rows: dict[str, Any] = {name: getattr(self, name)[:, columns] for name in tables}
        others = {*self.names} - {*names}
        return replace(
            self,
            **rows,
            names=names,
            limits=self.limits.of(columns),
            controller=tuple(name for name in self.controller if name not in others),
            proof="unchecked",
            # Its file and its world are of all joints.
            source={},
            world=None,
        )

    def save(self, path: str | os.PathLike[str], order: Sequence[str] | None = None) -> None:
        """Write it in the format of the file's suffix; see :func:`evenroad.trajectory.save_trajectory`.

        Parameters
        ----------
        path : str or path-like
            A ``.json``, ``.csv``, ``.yaml`` (ROS 2), ``.mcap`` (a bag), ``.script`` or ``.movej.script`` (URScript).
        order : sequence of str, optional
            As for :meth:`columns`.

        Raises
        ------
        UnknownName
            For another suffix, or an unknown joint.
        InvalidValue
            If a joint that moves is missing in `order`, or a URScript does not have six joints.
        NotAvailable
            If the package that writes the format is not installed.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
        >>> trajectory = er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     trajectory.save(f"{folder}/go.csv")
        """
        from evenroad.trajectory.formats import save_trajectory

        save_trajectory(path, self, order)

    def __repr__(self) -> str:
        joints, states = counted(len(self.names), "joint"), counted(len(self.times), "state")
        return f"Trajectory({self.duration:.4g} s, {joints}, {states})"

    @property
    def step(self) -> float:
        """Time between two states [s]; the default for the single state of a robot that does not move."""
        return float(self.times[1]) if len(self.times) > 1 else STEP

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.times[-1])
