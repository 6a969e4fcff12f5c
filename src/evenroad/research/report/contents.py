"""Contents: which sections a report has, in their order."""

from __future__ import annotations

import re

from evenroad.research.report.analysis import Analysis
from evenroad.research.report.fair_names import is_fair, pooled_rules
from evenroad.research.report.figures.canvas import as_png
from evenroad.research.report.figures.curves import draw_curves
from evenroad.research.report.figures.fair_gains import draw_fair_gains
from evenroad.research.report.figures.maze_success import draw_maze_success, maze_questions
from evenroad.research.report.figures.point_sets import draw_point_sets
from evenroad.research.report.figures.scenes import draw_scene, scenes_among
from evenroad.research.report.page import Picture, Section
from evenroad.research.report.runs import Question
from evenroad.research.report.sections.expected import expected_table, verdict_counts
from evenroad.research.report.sections.failures import failure_table
from evenroad.research.report.sections.fair import fair_table, lazy_table
from evenroad.research.report.sections.paired import paired_tables
from evenroad.research.report.sections.sets import spread_table
from evenroad.research.report.sections.success import success_table


def sections_of(analysis: Analysis) -> tuple[Section, ...]:
    """Return all sections that the analysis has something for."""
    questions = [question for question in analysis.runs.questions if not is_fair(question)]
    sections = [_expected(analysis), _fair(analysis), *(_question(analysis, each) for each in questions)]
    sections += [_mazes(analysis, questions), _scenes(questions), _point_sets()]
    if analysis.failures:
        sections.append(Section("failures", "Failures", tables=(failure_table(analysis.failures),)))
    return tuple(section for section in sections if section is not None)


def _expected(analysis: Analysis) -> Section | None:
    if not analysis.verdicts:
        return None
    tables = tuple(expected_table(table, verdicts) for table, verdicts in analysis.verdicts.values())
    text = " ".join(
        f"{table.title}: {verdict_counts(verdicts)}." for table, verdicts in analysis.verdicts.values()
    )
    return Section("expected", "Published and independent results beside ours", text, tables=tables)


def _fair(analysis: Analysis) -> Section | None:
    if not analysis.pooled:
        return None
    rules = pooled_rules(analysis.runs.questions)
    tables = [fair_table(grouping, found, rules) for grouping, found in analysis.pooled.items()]
    if analysis.lazy:
        tables.append(lazy_table(analysis.lazy))
    picture = Picture("fair-gains", "Gain over uniform points", as_png(draw_fair_gains(analysis.pooled)))
    return Section("fair", "Fair suite: random worlds, starts and goals", "", (picture,), tuple(tables))


def _question(analysis: Analysis, question: Question) -> Section:
    name = slug(str(question))
    picture = Picture(name, str(question), as_png(draw_curves(analysis.cells_of(question), str(question))))
    spread = spread_table(analysis, question, f"{name}-sets")
    tables = [success_table(analysis, question, f"{name}-success"), *paired_tables(analysis, question, name)]
    return Section(
        name, str(question), "", (picture,), tuple(tables if spread is None else [*tables, spread])
    )


def _mazes(analysis: Analysis, questions: list[Question]) -> Section | None:
    mazes = maze_questions(questions)
    if not mazes:
        return None
    cells = [cell for cell in analysis.cells if cell.question in mazes]
    picture = Picture("maze-success", "Success on the mazes", as_png(draw_maze_success(cells)))
    text = "The paper's figure, on our mazes: its own are not published."
    return Section("maze-success", "Success on the mazes", text, (picture,))


def _scenes(questions: list[Question]) -> Section | None:
    problems = scenes_among([question.problem for question in questions])
    if not problems:
        return None
    pictures = tuple(
        Picture(f"scene-{slug(problem)}", f"{problem} with a path", as_png(draw_scene(problem)))
        for problem in problems
    )
    return Section("scenes", "Scenes with a found path", pictures=pictures)


def _point_sets() -> Section:
    picture = Picture("point-sets", "Point sets in the unit square", as_png(draw_point_sets()))
    text = (
        "The first set of each sampler in two dimensions. Discrepancies in ten dimensions are drawn by"
        " `python -m benchmarks.discrepancy_d10`."
    )
    return Section("point-sets", "Point sets", text, (picture,))


def slug(text: str) -> str:
    """Return a name for files and links: lower-case letters, digits and hyphens."""
    return re.sub(r"[^a-z0-9.]+", "-", text.lower()).strip("-")
