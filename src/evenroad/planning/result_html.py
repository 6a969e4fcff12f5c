"""HTML of a plan for notebooks: a table, and a drawing of its coordinates."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats

_WIDTH, _HEIGHT = 420, 120
_COLOURS = ("#1b9e5a", "#2f5fd0", "#d1343b", "#e6a23c", "#6b8aa8", "#3b3f46", "#8e5bb5")


def as_html(rows: dict[str, str], path: Floats | None) -> str:
    """Return a table of rows, and a drawing of the coordinates of a path, (p, dim), over its length."""
    # Imported late: only notebooks need it.
    from html import escape

    cells = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(text)}</td></tr>'
        for name, text in rows.items()
    )
    return f"<table>{cells}</table>{'' if path is None else _drawing(path)}"


def _drawing(path: Floats) -> str:
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    low, span = float(path.min()), max(float(path.max() - path.min()), 1e-9)
    x = 5.0 + (_WIDTH - 10.0) * along / max(float(along[-1]), 1e-9)
    y = 5.0 + (_HEIGHT - 10.0) * (1.0 - (path - low) / span)
    lines = "".join(
        f'<polyline fill="none" stroke-width="2" stroke="{_COLOURS[j % len(_COLOURS)]}" points="'
        + " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, column, strict=True))
        + f'"><title>coordinate {j}</title></polyline>'
        for j, column in enumerate(y.T)
    )
    return f'<svg width="{_WIDTH}" height="{_HEIGHT}" style="background:#fff">{lines}</svg>'
