"""The documentation is built as ``make docs`` builds it, with warnings as errors, and its pages are looked through.

Needs the extra [docs], which [dev] has.
"""

import importlib.util
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from urllib.parse import unquote, urlsplit

import pytest

pytest.importorskip("sphinx")
pytest.importorskip("furo")
pytest.importorskip("myst_parser")

from tools import docs_pages
from tools.run_examples import EXAMPLES

import evenroad

ROOT = Path(__file__).parents[1]
STRICT = ("-q", "-W", "--keep-going")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    out = tmp_path_factory.mktemp("site")
    built = subprocess.run(
        [sys.executable, "-m", "sphinx", *STRICT, "-d", out / "doctrees", ROOT / "docs", out / "html"],
        capture_output=True,
        text=True,
    )
    assert built.returncode == 0, built.stderr
    return {str(path.relative_to(out / "html")): Page(path) for path in sorted((out / "html").rglob("*.html"))}


class Page(HTMLParser):
    """What a page loads, where it leads, and where it can be led to."""

    def __init__(self, path):
        super().__init__()
        self.path, self.text = path, path.read_text()
        self.loads, self.links, self.places = [], [], set()
        self.feed(self.text)

    def handle_starttag(self, tag, attrs):
        named = dict(attrs)
        self.places.add(named.get("id"))
        if tag in ("script", "img", "source", "iframe"):
            self.loads.append(named.get("src"))
        elif tag == "link" and named.get("rel") in ("stylesheet", "icon", "preload"):
            self.loads.append(named.get("href"))
        elif tag == "a":
            self.links.append(named.get("href"))


def test_nothing_is_loaded_from_the_network(site):
    for page in site.values():
        for loaded in filter(None, page.loads):
            parts = urlsplit(loaded)
            assert parts.scheme in ("", "data"), f"{page.path.name} loads {loaded}"
            if not parts.scheme:
                assert (page.path.parent / unquote(parts.path)).exists(), f"{page.path.name} loads {loaded}"
    (root,) = {page.path for name, page in site.items() if name == "index.html"}
    for sheet in (root.parent / "_static").rglob("*.css"):
        assert not re.search(r"(?:@import|url\()\s*['\"]?(?:https?:)?//", sheet.read_text()), sheet.name


def test_links_lead_to_pages_and_places_that_are_there(site):
    root = site["index.html"].path.parent
    for name, page in site.items():
        for link in filter(None, page.links):
            parts = urlsplit(link)
            if parts.scheme or link == "#":
                continue
            target = (page.path.parent / unquote(parts.path)).resolve() if parts.path else page.path
            assert target.is_file(), f"{name} leads to {link}"
            if parts.fragment and target.suffix == ".html":
                there = site[str(target.relative_to(root.resolve()))].places
                assert unquote(parts.fragment) in there, f"{name} leads to {link}"


def test_every_public_name_is_in_the_reference(site):
    homes = [home for _, homes in docs_pages.REFERENCE.values() for home in homes]
    documented = set().union(*(page.places for name, page in site.items() if "reference" in name))
    # Adapters are only read: here as they would be without what they adapt is nothing for the tests after this one.
    for name in [each for each in homes if "adapters" in each]:
        text = Path(importlib.util.find_spec(name).origin).read_text()
        for defined in re.findall(r"^(?:def|class) ([A-Za-z]\w*)", text, flags=re.MULTILINE):
            assert f"{name}.{defined}" in documented, f"{name}.{defined} is not in the reference"
    modules = ["evenroad", "evenroad.qmc", *(each for each in homes if "adapters" not in each)]
    for module in map(importlib.import_module, modules):
        names = [name for name in docs_pages.public_names(module) if not name.startswith("_")]
        assert names, f"{module.__name__} offers nothing"
        for name in names:
            if not isinstance(getattr(module, name), ModuleType):
                shown = docs_pages.documented_name(f"{module.__name__}.{name}")
                assert shown in documented, f"{module.__name__}.{name} is not in the reference"


def test_every_name_of_the_root_is_in_the_first_table(site):
    table = site["generated/reference.html"].text
    for name in evenroad.__all__:
        assert name.startswith("_") or re.search(rf">{name}<", table), name


def test_every_example_is_a_page(site):
    for script in EXAMPLES:
        page = site[f"generated/examples/{script.stem}.html"]
        assert script.stem in site["examples.html"].text
        assert any("_images" in (loaded or "") for loaded in page.loads) or script.stem[:2] in ("03", "09", "10")


def test_every_page_can_be_reached_from_the_first(site):
    seen, left = set(), ["index.html"]
    root = site["index.html"].path.parent.resolve()
    while left:
        name = left.pop()
        if name in seen or name not in site:
            continue
        seen.add(name)
        for link in filter(None, site[name].links):
            parts = urlsplit(link)
            if not parts.scheme and parts.path:
                target = (site[name].path.parent / unquote(parts.path)).resolve()
                left.append(str(target.relative_to(root)))
    assert set(site) - seen <= {"genindex.html", "search.html", "py-modindex.html"}


def test_the_site_names_no_machine(site):
    for name, page in site.items():
        assert str(ROOT) not in page.text, name
        assert str(Path.home()) not in page.text, name
