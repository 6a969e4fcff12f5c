from xml.etree import ElementTree

import numpy as np

from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.roadmap import Status
from evenroad.space import BoxSpace
from evenroad.world import FunctionWorld

WORLD = FunctionWorld(BoxSpace([0.0, 0.0], [1.0, 1.0]), lambda q: q[:, 0] < 2.0, resolution=0.05)


def html_of(result):
    """The page, read as XML: a notebook shows nothing of one that is broken."""
    return ElementTree.fromstring(f"<div>{result._repr_html_()}</div>")


def test_a_solved_plan_shows_its_answer_and_one_line_a_coordinate():
    result = plan(WORLD, [0.1, 0.5], [0.4, 0.5], PRM(draw("halton", 64, 2)))
    assert result.status is Status.SOLVED
    page = html_of(result)
    assert "solved" in "".join(page.itertext())
    lines = page.findall(".//polyline")
    assert len(lines) == 2
    assert all(len(line.get("points").split()) == len(result.path) for line in lines)


def test_a_plan_without_path_says_why():
    result = plan(WORLD, np.array([0.1, 0.5]), np.array([5.0, 0.5]), PRM(draw("halton", 8, 2)))
    page = html_of(result)
    assert "goal" in "".join(page.itertext())
    assert page.findall(".//polyline") == []
