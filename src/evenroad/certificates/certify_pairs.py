"""Writing a certificate that pairs of links never touch, whatever the joints between them do."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from evenroad.certificates.certify import packed, write_certificate
from evenroad.certificates.link_pairs import LinkPair, Links, Proof
from evenroad.certificates.plain import plain_scene
from evenroad.certificates.robot_files import ReadRobot
from evenroad.certificates.sources import SceneFiles
from evenroad.errors import NotAvailable
from evenroad.scenes.scene import Scene

MAGIC = "evenroad certificate of pairs 1\n"
_HALVE_CELL, _HALVE_SECOND = 0, 2
_LONGEST = 1 << 16
"""A checker may refuse a longer header [bytes]."""


def certify_pairs(read: ReadRobot, of: Links, pairs: Sequence[LinkPair], file: Path) -> int:
    """Write the certificate of those pairs of a robot's links that are proved never to touch; return their number.

    Pairs that are fixed to each other are left out.  Raises NotAvailable if none is left.
    """
    shown = [(pair.links, pair.proof) for pair in pairs if pair.proof]
    if not shown:
        raise NotAvailable("no certificate: it would have no pair of links that is proved never to touch")
    bodies = [link for link in of.robot.links if link in of.shapes]
    proofs = [proof for _, proof in shown]
    answers = np.concatenate([proof.answers.answers for proof in proofs])
    directions = np.concatenate([proof.answers.directions for proof in proofs])
    lines = [_line([bodies.index(link) for link in links], proof) for links, proof in shown]
    lines += [f"answers {len(answers)}", f"directions {len(directions)}"]
    if sum(map(len, lines)) > _LONGEST // 2:
        raise NotAvailable(f"no certificate: {len(shown)} pairs of links are more than one can name")
    joints = {*of.claimed.joints, *of.claimed.held}
    files = read.without_srdf(joints), SceneFiles(plain_scene(Scene()), "-")
    write_certificate(file, MAGIC, files, of.claimed, lines, packed(answers) + directions.astype("<f4").tobytes())
    return len(shown)


def _line(bodies: Sequence[int], proof: Proof) -> str:
    """Return the line of a pair: its bodies, and the columns along which cells are halved, as far as any is."""
    levels = [0]
    for number, answer in enumerate(proof.answers.answers.tolist()):
        if answer <= _HALVE_SECOND:
            levels += 2 * [levels[number] + (answer == _HALVE_CELL)]
    return " ".join(map(str, ["pair", *bodies, *proof.columns[: max(levels)].tolist()]))
