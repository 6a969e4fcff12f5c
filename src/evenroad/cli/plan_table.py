"""What the terminal shows after a plan: a short table, within 100 columns."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from evenroad.cli.console import print_table
from evenroad.roadmap import PlanResult

PROOFS = {
    "exact": "exact: no motion touches anything, up to rounding",
    "certified": "certified: the robot's capsules touch nothing anywhere along the path",
    "resolution": "resolution: motions are free at states close together; what lies between them is not seen",
}


def print_plan(result: PlanResult, files: Sequence[Path], more: Sequence[tuple[str, str]] = ()) -> None:
    """Print a plan as a table of two columns; `more` are rows of its own."""
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    colour = "green" if result.solved else "red"
    table.add_row("status", Text.assemble((str(result.status), colour), f": {result.message}"))
    counts = result.counts
    if result.rule != "none":
        table.add_row("points", Text(str(result.origin)))
    elif "nodes" in counts:
        table.add_row(
            "planner", f"{result.planner}: {counts['nodes']} nodes, {counts['edges_checked']} motions checked"
        )
    if result.roadmap is not None:
        table.add_row("milestones", f"{counts['valid']} valid of {counts['points']}")
        table.add_row(
            "edges", f"{counts['edges_free']} free of {counts['edges_checked']} checked ({result.rule})"
        )
    if result.cost is not None and result.milestone_cost is not None:
        before = "before it was straightened" if result.roadmap is None else "along the roadmap"
        table.add_row("cost", f"{result.cost:.6g} ({before} {result.milestone_cost:.6g})")
    if result.stages and result.cost is not None and "rounds" in counts:
        first = result.stages[0]
        table.add_row(
            "improved",
            f"from {first.cost:.6g} after {1e3 * first.seconds:.1f} ms, in {counts['rounds']} rounds",
        )
    if result.proof is not None:
        table.add_row("proved", PROOFS[result.proof])
    phases = ", ".join(f"{phase} {1e3 * value:.1f}" for phase, value in result.seconds.items())
    table.add_row(Text("time [ms]"), phases)
    for name, value in more:
        table.add_row(name, Text(value))
    # As Text: a file's name may hold brackets, which would be read as markup.
    table.add_row("files", Text(", ".join(map(str, files))))
    print_table(table)
