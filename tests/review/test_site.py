"""The site of the documentation: built strictly, served, and walked through in a real browser."""

import functools
import http.server
import importlib.util
import json
import os
import re
import subprocess
import sys
import threading
import urllib.parse
from collections import Counter, deque
from html.parser import HTMLParser
from pathlib import Path

import pytest

from pe_core import catalog
from pe_core.study import setting_keys
from pe_tools.cli.verbs import parser
from tests.limits import HANG_S
from tests.needed import unavailable
from tests.review.browser import DESKTOP, PHONE, Heard, settle

pytestmark = pytest.mark.thorough
ROOT = Path(__file__).resolve().parents[2]
SIDEWAYS = "() => document.documentElement.scrollWidth - window.innerWidth"
SOME = ("index.html", "guide.html", "settings.html", "howto/requirements.html",
        "reference/catalogue/hesai.html", "reference/commands.html")  # fmt: skip
"""Pages that are opened by a phone, and wide."""
CLICKS = 3


class Page(HTMLParser):
    """Addresses, identifiers and text of a page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.sources: list[str] = []
        self.names: set[str] = set()
        self.text = ""
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.names |= {given[key] for key in ("id", "name") if given.get(key)}
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if tag in ("img", "script", "source", "iframe") and given.get("src"):
            self.sources.append(given["src"])
        if tag == "link" and given.get("rel") != "canonical":
            self.sources.append(given["href"])

    def handle_data(self, data):
        self.text += data


def built(folder: Path) -> None:
    """Build the site strictly into a folder."""
    options = ("--site-dir", str(folder))  # not --quiet: it silences what a strict build counts
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", *options],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        timeout=HANG_S,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING" not in done.stderr, done.stderr


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder of the site."""
    if importlib.util.find_spec("mkdocs") is None:
        unavailable("there is no MkDocs: install the extra docs")
    folder = tmp_path_factory.mktemp("site")
    built(folder)
    return folder


@pytest.fixture(scope="module")
def pages(site):
    """Every page, by its path in the site."""
    found = {p.relative_to(site).as_posix(): p for p in sorted(site.rglob("*.html"))}
    own = {name: p for name, p in found.items() if not is_result(name)}
    return {name: Page(path.read_text("utf-8")) for name, path in own.items()}


def is_result(name):
    """Whether a page is a result that the site only carries along."""
    return name.startswith("reviews/") or name.endswith("/review.html")


@pytest.fixture(scope="module")
def address(site):
    """The address of a local server of the site."""

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    handler = functools.partial(Quiet, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()


def is_elsewhere(link):
    return re.match(r"\w+:|//", link) is not None


def target_of(page, link):
    """Return the path in the site and the anchor that a link of a page leads to."""
    path, _, anchor = urllib.parse.unquote(link).partition("#")
    joined = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
    return joined, anchor


def test_every_link_leads_to_a_file_and_an_anchor(site, pages):
    for name, page in pages.items():
        if name == "404.html":  # its addresses begin at the server's root
            continue
        for link in filter(lambda link: not is_elsewhere(link), page.links):
            path, anchor = target_of(name, link)
            assert (site / path).is_file() or link == ".", f"{name}: {link}"
            if anchor and path in pages:
                assert anchor in pages[path].names, f"{name}: {link}"


def test_no_page_loads_anything_from_another_host(site, pages):
    for name, page in pages.items():
        for source in page.sources:
            assert not is_elsewhere(source) or source.startswith("data:"), f"{name}: {source}"
            if name != "404.html":
                assert (site / target_of(name, source)[0]).is_file(), f"{name}: {source}"
    for style in site.rglob("*.css"):
        assert not re.search(r"url\(\W?(https?:)?//", style.read_text("utf-8")), style


def test_the_search_has_every_key_verb_and_sensor(site):
    documents = json.loads((site / "search" / "search_index.json").read_text("utf-8"))["docs"]
    text = "\n".join(f"{entry['title']}\n{entry['text']}" for entry in documents)
    tables = {entry["title"]: entry["text"] for entry in documents}
    for key, *_ in setting_keys():
        table, _, name = key.rpartition(".")
        assert name in (tables[f"[{table}]"] if table else text), key
    verbs = next(a for a in parser()._actions if a.dest == "==SUPPRESS==" or a.choices)
    for verb in verbs.choices:
        assert f"pe {verb}" in text, verb
    for name in catalog.names():
        assert name in text, name


def clicks_from(pages, first, most):
    """Return how many links lead from a page to each other one, of at most so many."""
    distance = {first: 0}
    waiting = deque([first])
    while waiting:
        here = waiting.popleft()
        if distance[here] == most:
            continue
        for link in pages[here].links:
            there = target_of(here, link)[0]
            if not is_elsewhere(link) and there in pages and there not in distance:
                distance[there] = distance[here] + 1
                waiting.append(there)
    return distance


def test_every_page_is_within_three_clicks(pages):
    assert set(pages) - set(clicks_from(pages, "index.html", CLICKS)) <= {"404.html"}


def fits(page):
    """Whether the page ends up as wide as the window; a busy machine draws it again late."""
    for _ in range(20):
        settle(page)
        if page.evaluate(SIDEWAYS) <= 0:
            return True
    return False


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_pages_open_without_complaints_and_fit_the_width(chromium, address, pages, size):
    """All pages as narrow as a phone, and some made wide again after that.

    Of a folder of many, which one template made, every fifth.
    """
    width, height = size
    context = chromium.new_context(
        viewport={"width": width, "height": height},
        is_mobile=size == PHONE,
        has_touch=size == PHONE,
    )
    page = context.new_page()
    heard = Heard(page)
    folders = Counter(str(Path(name).parent) for name in pages)
    folders["."] = 0  # each of these is written by hand
    many = [name for name in sorted(pages) if folders[str(Path(name).parent)] > 20]
    every = sorted({*pages} - {*many} | {*many[::5]})
    for name in every if size == DESKTOP else SOME:
        page.goto(f"{address}/{name}")
        for each in (PHONE[0], width) if name in SOME else (PHONE[0],):
            page.set_viewport_size({"width": each, "height": height})
            assert fits(page), (name, each)
        assert not heard.complaints, (name, heard.complaints)
    assert all(asked.startswith((address, "data:", "blob:")) for asked in heard.asked)
    context.close()


def test_the_search_finds_a_key_and_leads_to_it(chromium, address):
    context = chromium.new_context(viewport={"width": DESKTOP[0], "height": DESKTOP[1]})
    page = context.new_page()
    page.goto(f"{address}/index.html")
    page.get_by_role("textbox", name="Search").click()
    page.keyboard.type("cleaning_reach")
    found = page.locator(".md-search-result__link", has_text="limits").first
    found.wait_for()
    found.click()
    page.wait_for_url(re.compile("settings|mounts_and_search"))
    assert "cleaning_reach" in page.inner_text("main")
    context.close()
