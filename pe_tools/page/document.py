"""The page as one self-contained HTML file: sections, style sheets, scripts and security policy.
The content security policy lets the page run and load what it was written with, and nothing else.
Scripts and style sheets are allowed by their SHA-256. Style attributes cannot be allowed so: each
becomes a rule of a style sheet, selected by a number."""

import base64
import hashlib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import pe_core as pe
from pe_core import study as studies

from .. import jobs
from ..templating import Markup
from .markup import css_string, render
from .report_context import About, ReportContext, keyed_contexts
from .sections import SECTIONS, Section

PAGE = studies.REVIEW_PAGE
STYLES = Path(__file__).with_name("styles")
STYLE_SHEETS = ("base", "parts", "print", "drawn", "scene3d")
NO_INFO = About()
FONT = "font: 8pt system-ui, sans-serif; color: #57606a"
PAGES = f'@bottom-right {{ content: counter(page) " / " counter(pages); {FONT} }}'
"""Of the margins of a printed page: letters, and page numbers."""
STYLE_ATTRIBUTE = re.compile(r' style="([^"]*)"')


class PagePart(NamedTuple):
    """A section of one study, or of all: its HTML, and data for its scripts."""

    section: Section
    context: ReportContext
    html: Markup
    data: Mapping[str, Any]


def page_bytes(
    contexts: Sequence[ReportContext],
    progress: Callable[[float], None] = lambda _share: None,
    about: About = NO_INFO,
) -> bytes:
    """Return the page of one study, or of several side by side. `contexts`: one to six, else
    `InputError`. `progress`: called before each section with the share of sections that are done, 0
    to 1. An exception that it raises ends the work."""
    contexts = keyed_contexts(contexts)
    steps = [
        (section, group)
        for section in SECTIONS
        for group in ([contexts] if section.joint else [(context,) for context in contexts])
    ]
    parts = []
    for done, (section, group) in enumerate(steps):
        progress(done / len(steps))
        data = section.data(group if section.joint else group[0])
        if data is not None:
            html = section.html(group, data)
            parts.append(PagePart(section, group[0], html, data.get("script_data", {})))
    chapters = [(section, list(own)) for section, own in groupby(parts, lambda part: part.section)]
    names = " and ".join(context.name for context in contexts)
    title = about.title or f"Sensor review: {names}"
    revision = f"Revision {about.revision}" if about.revision else ""
    margin = " \N{MIDDLE DOT} ".join(filter(None, (title, revision)))
    return html_file(
        title,
        render("body.html", contexts=contexts, chapters=chapters, about=about),
        dict.fromkeys(script for section, _ in chapters for script in section.scripts()),
        author=about.author,
        margin=margin,
    )


def write_page(
    contexts: Sequence[ReportContext],
    folder: str | Path,
    *,
    replace: bool = False,
    about: About = NO_INFO,
) -> Path:
    """Write the page to a folder; return its path. `InputError` when the folder cannot be written,
    or contains a page that this program did not write or that was changed since. `contexts`,
    `about`: as of `page_bytes`. `replace`: whether an existing page is replaced, whoever wrote
    it."""
    folder = jobs.prepare_folder(folder, () if replace else (PAGE,))
    with jobs.FileSet(folder, (PAGE,) if replace else ()) as files:
        files.add(PAGE, page_bytes(contexts, about=about))
    return folder / PAGE


def html_file(
    title: str, body: Markup, scripts: Iterable[str] = (), *, author: str = "", margin: str = ""
) -> bytes:
    """Return a whole page; `margin` is printed at the lower left of each sheet of paper."""
    body, rules = without_style_attributes(body)
    css = [(STYLES / f"{name}.css").read_text("utf-8") for name in STYLE_SHEETS]
    css += [f"@page {{ @bottom-left {{ content: {css_string(margin)}; {FONT} }} {PAGES} }}", rules]
    sheets = [Markup(f"\n{sheet}\n") for sheet in css]
    # What would end the script element within a string of the script is escaped.
    safe = [s.replace("</script", "<\\/script").replace("<!--", "<\\!--") for s in scripts]
    programs = [Markup(f"\n{script}\n") for script in safe]
    policy = "; ".join(
        (
            "default-src 'none'",
            "img-src data: blob:",
            "media-src data:",
            f"style-src {_hashes(sheets)}",
            f"script-src {_hashes(programs)}",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )
    page = render(
        "page.html",
        title=title,
        author=author,
        version=pe.__version__,
        policy=Markup(policy),
        sheets=sheets,
        body=body,
        scripts=programs,
    )
    return f"{page}\n".encode()


def without_style_attributes(html: str) -> tuple[Markup, str]:
    """Replace style attributes by numbers; return the HTML, and the style sheet with their rules.
    Texts in the HTML must be escaped, so that a quotation mark occurs only around attributes."""
    rules: dict[str, int] = {}

    def number_of(attribute: re.Match[str]) -> str:
        return f' data-s="{rules.setdefault(attribute[1], len(rules))}"'

    numbered = STYLE_ATTRIBUTE.sub(number_of, html)
    # The selector is repeated so that the rule outranks those of classes, as an attribute does.
    sheet = "\n".join(f'[data-s="{n}"][data-s][data-s]{{{rule}}}' for rule, n in rules.items())
    return Markup(numbered), sheet


def _hashes(contents: Iterable[str]) -> str:
    digests = [hashlib.sha256(content.encode("utf-8")).digest() for content in contents]
    sources = dict.fromkeys(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests)
    return " ".join(sources) or "'none'"
