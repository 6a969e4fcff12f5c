"""The page: one HTML file that needs no other."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from evenroad.research.report.tables import Table, as_html

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #22262b; max-width: 1560px; margin: 2rem auto; padding: 0 1rem }
h1 { font-size: 1.7rem } h2 { font-size: 1.3rem; margin-top: 2.6rem; border-bottom: 1px solid #ccd2d9 }
figure { margin: 1.4rem 0 } figcaption { font-weight: 600; margin-bottom: .35rem }
img { max-width: 100%; height: auto } .wide { overflow-x: auto }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums }
th, td { padding: .18rem .45rem; text-align: right; white-space: nowrap; border-bottom: 1px solid #e6e9ed }
th { border-bottom: 1.5px solid #69727d } td.label, th:first-child { text-align: left }
td.better { background: #d9f0e1 } td.worse { background: #fbe0de } td.differs { background: #fdecc8 }
td.better::after { content: " ▲" } td.worse::after { content: " ▼" } td.differs::after { content: " ≠" }
td.faint { color: #99a1aa }
.note { font-size: 12.5px; color: #59626c; margin: .3rem 0; max-width: 60rem }
nav ul { columns: 2; font-size: 14px } dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem }
dt { font-weight: 600 } dd { margin: 0 } pre { background: #f4f6f8; padding: .5rem .8rem; overflow-x: auto }
"""


@dataclass(frozen=True)
class Picture:
    """A PNG picture: its file's name without ending, what it shows, and its bytes."""

    name: str
    title: str
    png: bytes


@dataclass(frozen=True)
class Section:
    """A heading with what stands below it, in this order: text, pictures, tables."""

    name: str
    title: str
    text: str = ""
    pictures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()


def as_page(title: str, facts: Sequence[tuple[str, str]], sections: Sequence[Section]) -> str:
    """Return the page: title, facts as a list of terms, contents, sections; pictures are inside."""
    terms = "".join(f"<dt>{escape(term)}</dt><dd>{escape(fact)}</dd>" for term, fact in facts)
    links = "".join(f"<li><a href='#{each.name}'>{escape(each.title)}</a></li>" for each in sections)
    return (
        f"<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><title>{escape(title)}</title>"
        f"<meta name='viewport' content='width=device-width'><style>{_STYLE}</style></head>\n<body>\n"
        f"<h1>{escape(title)}</h1>\n<dl>{terms}</dl>\n<nav><ul>{links}</ul></nav>\n"
        + "".join(map(_section, sections))
        + "</body></html>\n"
    )


def _section(section: Section) -> str:
    text = f"<p>{escape(section.text)}</p>\n" if section.text else ""
    pictures = "".join(map(_picture, section.pictures))
    tables = "".join(map(as_html, section.tables))
    heading = f"<h2 id='{section.name}'>{escape(section.title)}</h2>"
    return f"<section>{heading}\n{text}{pictures}{tables}</section>\n"


def _picture(picture: Picture) -> str:
    data = base64.b64encode(picture.png).decode()
    # The title stands in the picture or above it as a heading; here it is for those who do not see it.
    return f"<figure><img alt='{escape(picture.title, quote=True)}' src='data:image/png;base64,{data}'></figure>\n"
