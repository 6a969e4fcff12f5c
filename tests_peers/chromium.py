"""A page in Debian's Chromium, without a screen; skips where there is none."""

from contextlib import contextmanager

import pytest

CHROMIUM = "/usr/bin/chromium"
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
FLAGS += ["--disable-background-networking", "--no-first-run"]


@contextmanager
def opened(address, width, height, colours="light"):
    """Give a tab with a page; `requests` are the addresses that it loads, `wrong` what its scripts complain of."""
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as browsers:
        try:
            browser = browsers.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        except playwright.Error as error:
            pytest.skip(f"no Chromium: {error}")
        tab = browser.new_page(viewport={"width": width, "height": height}, color_scheme=colours)
        # Where other processes keep all processors busy, half a minute is not enough.
        tab.set_default_timeout(120_000)
        tab.requests, tab.wrong = [], []
        tab.on("request", lambda request: tab.requests.append(request.url))
        tab.on("pageerror", lambda error: tab.wrong.append(str(error)))
        tab.on("console", lambda message: tab.wrong.append(message.text))
        tab.goto(address)
        yield tab
        browser.close()
