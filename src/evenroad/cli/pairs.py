"""``evenroad pairs``: of each pair of links that nobody tests, whether the two ever touch."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from json import dumps

from evenroad._checks import require_positive
from evenroad._terminal import print_table, progress_shown
from evenroad.certificates.link_pairs import LinkPair, untested_pairs
from evenroad.cli.options import Positional
from evenroad.cli.plan import RobotOptions
from evenroad.errors import InvalidValue, Undecided
from evenroad.loading.groups import EVERY
from evenroad.loading.load import read_robot


@dataclass(frozen=True, kw_only=True)
class Pairs(RobotOptions):
    """Show of each pair of links that is not tested, as an SRDF disables it, whether the two ever touch.

    A pair is proved never to touch, at all values of the joints between its links and without gaps; or a state is shown
    in which the two are in contact; or neither is known when the time is over.  The shapes of the robot's file decide,
    meshes by their triangles.

    Exit code: 1 if a pair of links with two joints or more between them touches or is undecided, else 0.

    Example: evenroad pairs ur5
    """

    robot: Positional[str]
    """A URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others."""
    seconds: float = 60.0
    """Time for the proofs of all pairs, > 0; reading the files is not counted."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Load, prove, print; return 0 if all pairs that are not adjacent never touch, else 1."""
        require_positive("--seconds", self.seconds)
        if self.bodies is not None:
            raise InvalidValue("evenroad pairs goes without --bodies: it is about the shapes of the robot's file")
        try:
            model = self.read_robot(self.robot)
        except Undecided:
            # No group is planned for here.
            model = replace(self, group=(EVERY,)).read_robot(self.robot)
        assert model.file is not None
        shapes = read_robot(model.file).shapes
        with progress_shown("pairs") as progress:
            pairs = untested_pairs(model.robot, shapes, model.dropped, self.seconds, progress)
        never = all(pair.status == "never" for pair in pairs if not pair.adjacent)
        if self.json:
            record = {"robot": self.robot, "srdf": None if self.srdf is None else str(self.srdf)}
            print(dumps(record | {"pairs": [asdict(pair) for pair in pairs]}, indent=2))
            return int(not never)
        rows = [(" ".join(pair.links), pair.reason, str(len(pair.joints)), _said(pair)) for pair in pairs]
        print_table(rows or [("none", "", "", "")], ("links", "not tested", "joints between", "ever in contact"))
        return int(not never)


def _said(pair: LinkPair) -> str:
    """Return in words what is known of a pair."""
    adjacent = " (adjacent)" if pair.adjacent else ""
    if pair.status == "never":
        return f"never, proved on {pair.lines} lines{adjacent}" if pair.joints else "never: fixed to each other"
    where = ", ".join(f"{name}={value:.6g}" for name, value in pair.configuration.items())
    if pair.status == "touches":
        return (f"at {where}" if pair.joints else "always: fixed to each other") + adjacent
    near = "" if pair.nearest is None else f", {pair.nearest:.3g} m apart at {where}"
    return f"undecided after {pair.lines} lines{near}"
