"""What is shown, and where: in the browser, below a notebook's cell, or in a viewer of pictures."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

import evenroad as er
import evenroad.viz.show as shows
from tests.refused import refused

CELLS = np.zeros((40, 60), dtype=bool)
MAP = er.GridMap(CELLS, resolution=0.1)
ON_A_MAP = er.plan(MAP.world(radius=0.2), (0.5, 3.5), (5.5, 3.5))
OF_AN_ARM = er.plan(er.ArmWorld("ur5"), (0, -1.5, 0, -1.5, 0, 0), (0.5, -1.5, 0.5, -1.5, 0, 0))


class Page:
    address = "http://127.0.0.1:1234"

    def __init__(self, world, result, plan, file, *, port):
        self.planned = plan(world, result.start, result.goal)
        self.done = []

    def serve(self):
        self.done.append("served")
        raise KeyboardInterrupt

    def close(self):
        self.done.append("closed")


@pytest.fixture
def pages(monkeypatch):
    """The pages that a browser was opened for."""
    opened = []
    monkeypatch.setattr(shows, "ArmPage", Page)
    monkeypatch.setattr(shows.webbrowser, "open", lambda address: opened.append(address) is None)
    return opened


@pytest.fixture
def notebook(monkeypatch):
    """What a notebook displays."""
    displayed = []
    shell = type("ZMQInteractiveShell", (), {})()
    display = SimpleNamespace(display=displayed.append, IFrame=lambda *given: given)
    ipython = SimpleNamespace(get_ipython=lambda: shell, display=display, version_info=(9, 0))
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    return displayed


def test_an_arm_is_served_to_the_browser_until_ctrl_c(pages):
    page = er.show(OF_AN_ARM)
    assert pages == [page.address]
    assert page.done == ["served", "closed"]
    assert page.planned.solved


def test_in_a_notebook_an_arm_stays_below_the_cell(pages, notebook):
    page = er.show(OF_AN_ARM)
    assert (pages, page.done) == ([], [])
    assert notebook == [(page.address, "100%", shows.HEIGHT)]


def test_without_a_browser_it_is_said_and_nothing_is_left_open(pages, monkeypatch):
    closed = []
    monkeypatch.setattr(shows.webbrowser, "open", lambda address: False)
    monkeypatch.setattr(Page, "close", lambda page: closed.append(page))
    refused(er.errors.NotAvailable, r"no browser .* result\.plot", er.show, OF_AN_ARM)
    assert len(closed) == 1


@pytest.mark.parametrize("what", [MAP, ON_A_MAP])
def test_maps_and_disks_are_pictures(what, notebook, monkeypatch):
    assert np.array_equal(np.asarray(er.show(what)), np.asarray(what.plot()))
    assert len(notebook) == 1
    monkeypatch.delitem(sys.modules, "IPython")
    viewed = []
    monkeypatch.setattr(Image.Image, "show", lambda picture: viewed.append(picture))
    assert viewed == [er.show(what)]


@pytest.mark.parametrize("what", ["plan.json", None, np.zeros((3, 2))])
def test_only_plans_and_maps_are_shown(what):
    refused(er.errors.InvalidValue, "a plan or a map can be shown", er.show, what)
