"""The page: its sections in their order, in one HTML file that needs no other."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from evenroad_studies.report.analysis import Analysis
from evenroad_studies.report.cells import Cell
from evenroad_studies.report.charts import (
    as_png,
    draw_curves,
    draw_fair_gains,
    draw_maze_success,
    draw_point_sets,
    maze_settings,
)
from evenroad_studies.report.fair import is_fair, pooled_rules
from evenroad_studies.report.runs import Setting
from evenroad_studies.report.scenes import draw_scene, scenes_among
from evenroad_studies.report.sections import (
    expected_table,
    failure_table,
    fair_table,
    lazy_table,
    paired_tables,
    spread_table,
    success_table,
    verdict_counts,
)
from evenroad_studies.report.tables import Table, as_html

_STYLE = "\n" + (Path(__file__).parent / "page.css").read_text(encoding="utf-8")


class Picture(NamedTuple):
    """A PNG picture: its file's name without ending, what it shows, and its bytes."""

    name: str
    title: str
    png: bytes


def _picture(name: str, title: str, figure: Figure) -> Picture:
    return Picture(name, title, as_png(figure))


class Section(NamedTuple):
    """A heading, and below it text, pictures and tables, in this order."""

    name: str
    title: str
    text: str = ""
    pictures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()


def sections_of(analysis: Analysis) -> tuple[Section, ...]:
    """Return the sections of the page, those without results left out."""
    settings = [setting for setting in analysis.runs.settings if not is_fair(setting)]
    sections = []
    if analysis.verdicts:
        sections.append(_expected(analysis))
    if analysis.pooled:
        sections.append(_fair(analysis))
    sections += [_setting(analysis, each) for each in settings]
    if mazes := maze_settings(settings):
        sections.append(_mazes([cell for cell in analysis.cells if cell.setting in mazes]))
    if scenes := scenes_among([setting.problem for setting in settings]):
        sections.append(_scenes(scenes))
    sections.append(_point_sets())
    if analysis.failures:
        sections.append(Section("failures", "Failures", tables=(failure_table(analysis.failures),)))
    return tuple(sections)


def _expected(analysis: Analysis) -> Section:
    found = analysis.verdicts.values()
    tables = tuple(expected_table(table, verdicts) for table, verdicts in found)
    text = " ".join(f"{table.title}: {verdict_counts(verdicts)}." for table, verdicts in found)
    return Section("expected", "Published and independent results beside ours", text, tables=tables)


def _fair(analysis: Analysis) -> Section:
    rules = pooled_rules(analysis.runs.settings)
    tables = [fair_table(grouping, found, rules) for grouping, found in analysis.pooled.items()]
    tables += [lazy_table(analysis.lazy)] if analysis.lazy else []
    picture = _picture("fair-gains", "Gain over uniform points", draw_fair_gains(analysis.pooled))
    return Section("fair", "Fair suite: random worlds, starts and goals", "", (picture,), tuple(tables))


def _setting(analysis: Analysis, setting: Setting) -> Section:
    name = slug(str(setting))
    picture = _picture(name, str(setting), draw_curves(analysis.cells_of(setting), str(setting)))
    tables = (
        success_table(analysis, setting, f"{name}-success"),
        *paired_tables(analysis, setting, name),
        spread_table(analysis, setting, f"{name}-sets"),
    )
    return Section(name, str(setting), "", (picture,), tuple(each for each in tables if each is not None))


def _mazes(cells: list[Cell]) -> Section:
    picture = _picture("maze-success", "Success on the mazes", draw_maze_success(cells))
    text = "The paper's figure, on our mazes; the paper's own are not published."
    return Section("maze-success", "Success on the mazes", text, (picture,))


def _scenes(names: Sequence[str]) -> Section:
    pictures = [_picture(f"scene-{slug(name)}", f"{name} with a path", draw_scene(name)) for name in names]
    return Section("scenes", "Scenes with a found path", pictures=tuple(pictures))


def _point_sets() -> Section:
    picture = _picture("point-sets", "Point sets in the unit square", draw_point_sets())
    text = (
        "The first set of each sampler in two dimensions. Discrepancies in ten dimensions are drawn by"
        " `python -m studies.benchmarks.discrepancy_d10`."
    )
    return Section("point-sets", "Point sets", text, (picture,))


def slug(text: str) -> str:
    """Return a name for files and links: lower-case letters, digits and hyphens."""
    return re.sub(r"[^a-z0-9.]+", "-", text.lower()).strip("-")


def as_page(title: str, facts: Sequence[tuple[str, str]], sections: Sequence[Section]) -> str:
    """Return the page: title, facts, contents, sections.  Pictures are part of the file."""
    terms = "".join(f"<dt>{escape(term)}</dt><dd>{escape(fact)}</dd>" for term, fact in facts)
    links = "".join(f"<li><a href='#{each.name}'>{escape(each.title)}</a></li>" for each in sections)
    return (
        f"<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><title>{escape(title)}</title>"
        f"<meta name='viewport' content='width=device-width'><style>{_STYLE}</style></head>\n<body>\n"
        f"<h1>{escape(title)}</h1>\n<dl>{terms}</dl>\n<nav><ul>{links}</ul></nav>\n"
        + "".join(map(_section_html, sections))
        + "</body></html>\n"
    )


def _section_html(section: Section) -> str:
    text = f"<p>{escape(section.text)}</p>\n" if section.text else ""
    pictures = "".join(map(_picture_html, section.pictures))
    tables = "".join(map(as_html, section.tables))
    heading = f"<h2 id='{section.name}'>{escape(section.title)}</h2>"
    return f"<section>{heading}\n{text}{pictures}{tables}</section>\n"


def _picture_html(picture: Picture) -> str:
    data = base64.b64encode(picture.png).decode()
    # Readers see the title in the picture or as a heading above it; this is for those who cannot see it.
    return f"<figure><img alt='{escape(picture.title, quote=True)}' src='data:image/png;base64,{data}'></figure>\n"
