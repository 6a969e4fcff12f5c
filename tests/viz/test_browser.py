"""Whether a browser opens: on a desktop, and not over SSH, where it would take the terminal."""

import webbrowser

import pytest

from evenroad.viz import browser
from evenroad.viz.browser import how_to_open, open_browser

ADDRESS = "http://127.0.0.1:8080/token"


@pytest.mark.parametrize(
    ("system", "environment", "opens"),
    [
        ("linux", {"DISPLAY": ":0"}, True),
        ("linux", {"WAYLAND_DISPLAY": "wayland-0"}, True),
        ("linux", {"SSH_CONNECTION": "a b"}, False),
        ("linux", {"BROWSER": "lynx"}, True),
        ("darwin", {}, True),
        ("darwin", {"SSH_CONNECTION": "a b"}, False),
    ],
)
def test_a_browser_opens_only_on_a_desktop_or_where_one_is_named(monkeypatch, system, environment, opens):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SSH_CONNECTION", "BROWSER"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(browser.sys, "platform", system)
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) is None)
    assert open_browser(ADDRESS) == opens
    assert opened == [ADDRESS] * opens


def test_a_browser_that_breaks_is_as_none(monkeypatch):
    def broken(address):
        raise webbrowser.Error("no such browser")

    monkeypatch.setenv("BROWSER", "nosuch")
    monkeypatch.setattr(webbrowser, "open", broken)
    assert not open_browser(ADDRESS)


def test_where_none_opens_a_second_line_says_how_another_computer_reaches_the_page():
    assert how_to_open(ADDRESS, True) == f"{ADDRESS}   (Ctrl-C ends it)"
    first, second = how_to_open(ADDRESS, False).splitlines()
    assert first.startswith(ADDRESS)
    assert "ssh -L 8080:127.0.0.1:8080" in second
