"""The code of pages that need other people's planners is run here, where those are installed."""

import pytest
from tools import run_pages

PAGES = [page for page in run_pages.pages() if page.name in run_pages.NEEDS]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_code_of_the_page_runs(page, tmp_path, monkeypatch):
    for package in run_pages.NEEDS[page.name]:
        pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    assert [text for _, text in run_pages.run_page(page)]
