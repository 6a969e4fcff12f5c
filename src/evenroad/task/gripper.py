"""Steps of a task that move the fingers of a gripper: joints below the arm that are not planned for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real

from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad._checks import as_row
from evenroad.errors import InvalidValue, shown

To = float | str | Mapping[str, float] | None
"""Where fingers go: one value for all of their joints, a named state, or joint -> value [rad or m]."""


@explains_calls
@dataclass(frozen=True)
class Open:
    """The fingers open; the arm does not move.

    The fingers are the movable joints below the arm that are not planned for.  They may touch each other and the hand.

    Parameters
    ----------
    to : float, str or mapping of str to float, optional
        Value of all finger joints [rad or m]; a named state of the robot or the scene; or joint -> value.  Default:
        the state ``open``, if there is one, else the limits at which the fingers are farthest apart.
    link : str
        The hand, if the robot has several.

    Raises
    ------
    InvalidValue
        If `to` is none of these, or `link` is no text.

    Examples
    --------
    >>> from evenroad.task import Open
    >>> Open(0.03).to
    0.03
    """

    to: To = None
    link: str = ""

    def __post_init__(self) -> None:
        _require_valid(self)


@explains_calls
@dataclass(frozen=True)
class Close:
    """The fingers close, to their limits or until they touch an object; the arm does not move.

    Parameters
    ----------
    to : float, str or mapping of str to float, optional
        As for :class:`Open`.  Default: the state ``close`` or ``closed``, if there is one, else the limits at which the
        fingers are nearest to each other.
    until : str
        The obstacle at which they stop when the first of them touches it.
    link : str
        The hand, if the robot has several.

    Raises
    ------
    InvalidValue
        If `to` is none of these, or a name is no text.

    Examples
    --------
    >>> from evenroad.task import Close
    >>> Close(until="can").until
    'can'
    """

    to: To = None
    until: str = ""
    link: str = ""

    def __post_init__(self) -> None:
        _require_valid(self)
        if not isinstance(self.until, str):
            raise InvalidValue(f"until of Close must be the name of an obstacle, got {shown(self.until)}")


OfFingers = Open | Close


def _require_valid(step: OfFingers) -> None:
    kind, to = type(step).__name__, step.to
    if not isinstance(step.link, str):
        raise InvalidValue(f"link of {kind} must be a name, got {shown(step.link)}")
    if isinstance(to, Mapping):
        if not to:
            raise InvalidValue(f"to of {kind} must have one finger joint or more, got {{}}")
        given = {str(joint): as_row(f"joint {joint!r} of {kind}", [value], 1)[0] for joint, value in to.items()}
        set_fields(step, to=given)
    elif isinstance(to, Real) and not isinstance(to, bool):
        set_fields(step, to=as_row(f"to of {kind}", [to], 1)[0])
    elif to is not None and not isinstance(to, str):
        known = "a number, the name of a state, or joint -> value"
        raise InvalidValue(f"to of {kind} must be {known}, got {shown(to)}")
