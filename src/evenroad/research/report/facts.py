"""Facts that head a report: where its numbers come from."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from evenroad import __version__
from evenroad.research.bench.rows import Rows
from evenroad.research.bench.store import Session
from evenroad.research.bench.task import PROTOCOL


def facts_of(store: Path, rows: Rows, sessions: Sequence[Session], command: str) -> list[tuple[str, str]]:
    """Return (term, fact): command, rows, failures, seeds, versions, machines."""
    failed = int((~rows.answered).sum())
    by_status = ", ".join(
        f"{int(rows.status.is_in([status]).sum())} {status}"
        for status in rows.status.present()
        if not bool(rows.answered[rows.status.is_in([status])].any())
    )
    seeds = ", ".join(str(seed) for seed in np.unique(rows.seed))
    facts = [
        ("command", command),
        ("store", f"{store.name}: {len(rows)} rows of {', '.join(rows.suite.present())}"),
        ("failures", f"{failed}" + (f" ({by_status})" if failed else "")),
        ("seeds", seeds),
        ("protocol", f"{PROTOCOL}; rows of others are left out"),
        ("report by", f"evenroad {__version__}"),
    ]
    if sessions:
        facts += [
            ("runs by", "; ".join(dict.fromkeys(_versions(session) for session in sessions))),
            ("machines", "; ".join(dict.fromkeys(session.platform for session in sessions))),
            ("started", f"{sessions[0].started}, last resumed {sessions[-1].started}"),
        ]
    return facts


def _versions(session: Session) -> str:
    parts = (f"evenroad {session.evenroad}", f"Python {session.python}", f"numpy {session.numpy}")
    return ", ".join((*parts, f"scipy {session.scipy}", f"numba {session.numba}"))
