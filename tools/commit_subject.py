"""Check the subject of a commit message: ``python tools/commit_subject.py FILE``, which git's commit-msg hook runs."""

from __future__ import annotations

import re
import sys
from pathlib import Path

LONGEST = 72
"""Number of characters of a subject, at most."""
OF_GIT = ("Merge ", "Revert ", "fixup! ", "squash! ", "amend! ")
"""How subjects begin that git writes itself: they are not checked."""
NO_VERB = (
    *("a", "an", "the", "this", "that", "these", "those", "it", "they", "we", "i", "its", "their", "our", "my"),
    *("no", "not", "of", "in", "on", "at", "by", "for", "from", "to", "with", "without", "and", "or", "but", "if"),
    *("what", "which", "who", "whether", "when", "where", "why", "how", "also", "more", "most", "less"),
    *("one", "two", "three", "some", "any", "all", "each", "every"),
)
"""First words that are certainly not verbs."""


def fault(subject: str) -> str | None:
    """Return what is wrong with the subject, or None."""
    if subject.startswith(OF_GIT):
        return None
    first, *rest = re.findall(r"[\w'-]+", subject) or [""]
    if len(subject) > LONGEST:
        return f"it has {len(subject)} characters; {LONGEST} are allowed"
    if not rest or "wip" in (first.lower(), *(word.lower() for word in rest)):
        return "it does not say what the commit does"
    if not re.match(r"[A-Z][a-z]+\s", subject) or not _may_be_imperative(first.lower()):
        return f"{first!r} is not an imperative: begin with one, in upper case, as in 'Add', 'Refuse', 'Move'"
    return "it ends with a full stop" if subject.endswith(".") else None


def _may_be_imperative(word: str) -> bool:
    """Return whether the word is neither a known other word, nor looks like a past, a participle or a plural."""
    past = word.endswith("ed") and word not in ("embed", "need", "feed", "speed", "shed", "seed")
    participle = word.endswith("ing") and word not in ("bring", "ring", "string", "swing")
    third = word.endswith("s") and not word.endswith("ss") and word not in ("focus", "bias", "canvas")
    return not (word in NO_VERB or past or participle or third)


def main(path: str) -> int:
    """Check the first line of a file; return 1, and say why, where it is refused."""
    lines = Path(path).read_text(encoding="utf-8").splitlines()
    subject = lines[0] if lines else ""
    wrong = fault(subject)
    if wrong:
        print(f"the subject {subject!r} is refused: {wrong}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
