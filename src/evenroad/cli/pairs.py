"""``evenroad pairs``: of each pair of links that nobody tests, whether the two ever touch."""

from __future__ import annotations

from dataclasses import dataclass, replace
from json import dumps
from pathlib import Path

from evenroad._checks import require_positive
from evenroad._terminal import print_table, progress_shown
from evenroad.certificates.certify_pairs import certify_pairs
from evenroad.certificates.link_pairs import LinkPair, Links, untested_pairs
from evenroad.certificates.robot_files import ReadRobot
from evenroad.cli.options import Positional
from evenroad.cli.plan import RobotOptions
from evenroad.errors import InvalidValue, Undecided
from evenroad.loading.groups import EVERY


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
    certificate: Path | None = None
    """Also write a certificate of the pairs that never touch, which `evenroad-verify` checks."""
    embed: bool = False
    """The certificate carries the robot's files."""
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
        read = ReadRobot(self.sources(self.robot, None, self.embed), ())
        links = Links(read.urdf)
        with progress_shown("pairs") as progress:
            pairs = untested_pairs(links, model.dropped, self.seconds, progress)
        never = all(pair.status == "never" for pair in pairs if not pair.adjacent)
        if self.json:
            record = {"robot": self.robot, "srdf": None if self.srdf is None else str(self.srdf)}
            print(dumps(record | {"pairs": [_record(pair) for pair in pairs]}, indent=2))
        else:
            rows = [(" ".join(pair.links), pair.reason, str(len(pair.joints)), _said(pair)) for pair in pairs]
            print_table(rows or [("none", "", "", "")], ("links", "not tested", "joints between", "ever in contact"))
        if self.certificate is not None:
            count = certify_pairs(read, links, pairs, self.certificate)
            if not self.json:
                print(
                    f"certificate of pairs that never touch ({count}): {self.certificate}, which evenroad-verify checks"
                )
        return int(not never)


def _record(pair: LinkPair) -> dict[str, object]:
    """Return a pair as plain JSON values."""
    keys = ("links", "reason", "status", "joints", "configuration", "nearest", "steps")
    return {key: getattr(pair, key) for key in keys}


def _said(pair: LinkPair) -> str:
    """Return in words what is known of a pair."""
    adjacent = " (adjacent)" if pair.adjacent else ""
    if pair.status == "never":
        return f"never, proved in {pair.steps} steps{adjacent}" if pair.joints else "never: fixed to each other"
    where = ", ".join(f"{name}={value:.6g}" for name, value in pair.configuration.items())
    if pair.status == "touches":
        return (f"at {where}" if pair.joints else "always: fixed to each other") + adjacent
    near = "" if pair.nearest is None else f", {pair.nearest:.3g} m apart at {where}"
    return f"undecided{near}"
