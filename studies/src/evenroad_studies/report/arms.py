"""The arms' part of a report: tables of all robots and of each, pictures of success over points and over its cost."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evenroad._arrays import Bools, Floats, Ints
from evenroad_studies.arms.execute import KEPT, TREES
from evenroad_studies.arms.outcomes import is_of_arms
from evenroad_studies.arms.results import (
    ALL,
    REFERENCE,
    TABLE_HEADER,
    Line,
    robots_and_k,
    table_rows,
    title_of,
)
from evenroad_studies.arms.scenes import GENERATORS
from evenroad_studies.bench.rows import Rows
from evenroad_studies.report.tables import Table, row

STYLES = {
    "uniform": ("0.75", ":"),
    "sobol scrambled": ("0.45", "-"),
    "halton scrambled": ("0.6", "--"),
    "even": ("tab:green", "--"),
    "hickernell": ("tab:olive", ":"),
    "mpmc": ("tab:purple", ":"),
    "rejection": ("tab:cyan", "-"),
    "control": ("tab:blue", "-"),
    REFERENCE: ("tab:red", "-"),
}
"""Sampler -> colour and line."""

CURVES = ("sobol scrambled", "control", REFERENCE)
"""Samplers whose costs are drawn, beside trees."""

OTHERS = ("owen", "control")
"""What gains are listed for, as tables call it: points of the joint box, and the fair control."""

LEVEL = 0.05
"""A gain or loss counts as certain where the corrected p is below this."""


def summary_tables(lines: Sequence[Line]) -> tuple[Table, ...]:
    """Return what all robots say together: success by sampler, what the roadmap gains, and where it loses."""
    lines = [line for line in lines if line.n]
    return (_samplers_table(lines), _gains_table(lines), _losses_table(lines)) if lines else ()


def _samplers_table(lines: Sequence[Line]) -> Table:
    robots = {line.robot for line in lines}
    counts = sorted({line.n for line in lines})
    shares: dict[tuple[str, str], dict[int, dict[str, float]]] = {}
    for line in lines:
        if line.generator == ALL:
            by_robot = shares.setdefault((line.k, title_of(line)), {}).setdefault(line.n, {})
            by_robot[line.robot] = line.success
    whole = {
        way: {n: f"{100 * np.mean(list(of.values())):.1f}" for n, of in by.items() if set(of) == robots}
        for way, by in shares.items()
    }
    note = "Each robot counts as much as another; – where one of them was not run."
    if missing := [title for _, title in dict.fromkeys(way for way, by in whole.items() if not by)]:
        note += f" Not run for all robots: {', '.join(dict.fromkeys(missing))}."
    return Table(
        name="arms-samplers",
        title=f"success [%], mean of {len(robots)} robot{'s' if len(robots) > 1 else ''}",
        header=("k", "points", *(f"N = {n}" for n in counts)),
        rows=[row(*way, *(by.get(n, "–") for n in counts)) for way, by in whole.items() if by],
        labels=2,
        notes=(note,),
    )


def _gains_table(lines: Sequence[Line]) -> Table:
    counts = sorted({line.n for line in lines})
    gains: dict[tuple[str, str, str], dict[int, str]] = {}
    for line in lines:
        if line.generator == ALL and title_of(line) in OTHERS and not np.isnan(line.gain):
            text = f"{100 * line.gain:+.1f} ± {100 * line.error:.1f}"
            gains.setdefault((line.robot, line.k, title_of(line)), {})[line.n] = text
    return Table(
        name="arms-gains",
        title="success of the roadmap minus that of others [percentage points], all generators",
        header=("robot", "k", "points", *(f"N = {n}" for n in counts)),
        rows=[row(*way, *(by.get(n, "–") for n in counts)) for way, by in gains.items()],
        labels=3,
        notes=("Paired by problem, with standard errors over problems.",),
    )


def _losses_table(lines: Sequence[Line]) -> Table:
    tested = [line for line in lines if line.generator != ALL and not np.isnan(line.p)]
    certain = [line for line in tested if line.p_corrected < LEVEL]
    gains = [line for line in certain if line.gain > 0.0]
    losses = [line for line in certain if line.gain < 0.0]
    return Table(
        name="arms-losses",
        title="where the roadmap solves less",
        header=("robot", "k", "N", "points", "generator", "roadmap - this [percentage points]"),
        rows=[
            row(line.robot, line.k, line.n, title_of(line), line.generator, gain)
            for line in losses
            for gain in [f"{100 * line.gain:+.1f} ± {100 * line.error:.1f}"]
        ],
        labels=5,
        notes=(
            f"Of {len(tested)} comparisons by generator the roadmap solves more in {len(gains)} and less in"
            f" {len(losses)}, at {LEVEL:g} after Holm's correction over all; the others are not certain.",
        ),
    )


def arm_tables(lines: Sequence[Line]) -> tuple[Table, ...]:
    """Return a table for each robot and number of neighbours."""
    note = (
        "Success [%] by generator. Milestones and motions of the joint box know nothing of the robot; rejection and"
        " control are free of it and of its cell. Differences are paired by problem, with standard errors over"
        " problems, tests by sign flips, and Holm's correction over all tables."
    )
    return tuple(
        Table(
            name=f"arms-{robot}-k{k}",
            title=f"{robot}, k = {k}: success [%]" if k != "-" else f"{robot}: trees",
            header=TABLE_HEADER,
            rows=[row(*texts) for texts in rows],
            labels=2,
            notes=(note,),
        )
        for (robot, k), rows in table_rows(lines).items()
    )


def draw_success(lines: Sequence[Line], robot: str, k: str) -> Figure:
    """Draw success over milestones for one robot, a panel for each generator."""
    mine = [line for line in lines if (line.robot, line.k) == (robot, k) and line.n]
    figure = Figure(figsize=(12.0, 3.2), layout="constrained")
    panels = figure.subplots(1, len(GENERATORS), sharey=True)
    counts = sorted({line.n for line in mine})
    for panel, generator in zip(panels, GENERATORS, strict=True):
        for sampler, (colour, style) in STYLES.items():
            for search in ("connect", KEPT):
                curve = [
                    line for line in mine if (line.sampler, line.generator, line.search) == (sampler, generator, search)
                ]
                if curve:
                    panel.plot(
                        [line.n for line in curve],
                        [100.0 * line.success for line in curve],
                        color=colour,
                        linestyle=style if search == KEPT else "-.",
                        marker="o",
                        markersize=3,
                        linewidth=2.2 if sampler == REFERENCE else 1.2,
                        label=title_of(curve[0]),
                    )
        panel.set(xscale="log", xticks=counts, xticklabels=counts, xlabel="milestones", title=generator)
        # Numbers of four digits touch where there are many.
        panel.tick_params(axis="x", labelsize="x-small", labelrotation=45 if len(counts) > 5 else 0)
        panel.minorticks_off()
    panels[0].set(ylabel="solved [%]", ylim=(-3, 103))
    panels[-1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.suptitle(f"{robot}, k = {k}", fontsize=10)
    return figure


def draw_costs(rows: Rows, robot: str, k: str) -> Figure:
    """Draw the share of problems that are solved within so many checks, and so many milliseconds."""
    mine = np.array([is_of_arms(name) and f"arm-{robot}-" in f"{name}" for name in rows.problem.names])
    rows = rows.where(mine[rows.problem.codes])
    counts = np.unique(rows.n[rows.sampler.is_in([REFERENCE])])
    kept = rows.rule.is_in([name for name in rows.rule.names if name.startswith(f"k={k} ends=")])
    figure = Figure(figsize=(11.5, 3.8), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for sampler in CURVES:
        for n, style in zip(counts[[0, len(counts) // 2, -1]].tolist(), (":", "--", "-"), strict=True):
            here = rows.sampler.is_in([sampler]) & kept & (rows.n == n)
            label = f"{'owen' if sampler.startswith('sobol') else sampler}, {n}"
            _cost_curves(panels, rows.where(here), label, STYLES[sampler][0], style)
    _cost_curves(panels, rows.where(rows.sampler.is_in([TREES])), TREES, "black", "-")
    panels[0].set(xscale="log", xlabel="motions and milestones checked", ylabel="solved [%]", ylim=(-3, 103))
    panels[1].set(xscale="log", xlabel="ms of one core, from the scene to the path")
    panels[1].legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.suptitle(f"{robot}, all generators, k = {k}", fontsize=10)
    return figure


def _cost_curves(panels: Sequence[Axes], rows: Rows, label: str, colour: str, style: str) -> None:
    if len(rows):
        # Of trees the configurations are those inside of motions.
        checks = rows.edges_checked + np.where(rows.search.is_in([TREES]), 0, rows.valid)
        cost_curve(panels, (checks, 1e3 * rows.seconds), rows.solved, label, colour, style)


def cost_curve(
    panels: Sequence[Axes],
    costs: Sequence[Floats | Ints],
    solved: Bools,
    label: str,
    colour: str,
    style: str,
) -> None:
    """Draw which share of all runs is solved within so much of each cost, a panel for each."""
    for panel, cost in zip(panels, costs, strict=True):
        taken: Floats = np.sort(np.asarray(cost, dtype=np.float64)[solved])
        share = 100.0 * np.arange(1, len(taken) + 1) / len(solved)
        panel.step(np.maximum(taken, 1e-3), share, where="post", color=colour, linestyle=style, label=label)


def arm_pictures(rows: Rows, lines: Sequence[Line]) -> list[tuple[str, str, Figure]]:
    """Return name, title and figure of each picture."""
    pictures = []
    for robot, k in robots_and_k(lines):
        title = f"{robot}, k = {k}"
        pictures.append(
            (f"arms-{robot}-k{k}", f"Success on the arms' problems: {title}", draw_success(lines, robot, k))
        )
        pictures.append((f"arms-{robot}-k{k}-costs", f"What success costs: {title}", draw_costs(rows, robot, k)))
    return pictures
