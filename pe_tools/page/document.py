"""The page as one self-contained HTML file: sections, style sheets, scripts and security policy.

The content security policy lets the page run and load what it was written with, and nothing else.
Scripts and style sheets are allowed by their SHA-256. Style attributes cannot be allowed so: each
becomes a rule of a style sheet, selected by a number.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import count
from pathlib import Path

import pe_core as pe
from pe_core import study as studies

from .. import jobs
from .markup import css_string, escaped, script_json
from .report_context import About, ReportContext, Section, keyed_contexts
from .sections import BOTTOM_SECTIONS, STUDY_SECTIONS, TOP_SECTIONS

PAGE = studies.REVIEW_PAGE
HERE = Path(__file__).parent
STYLES = ("base.css", "parts.css", "print.css")
NO_INFO = About()


def page_bytes(
    contexts: Sequence[ReportContext],
    progress: Callable[[float], None] = lambda _share: None,
    about: About = NO_INFO,
) -> bytes:
    """Return the page of one study, or of several side by side.

    Parameters
    ----------
    contexts : sequence of ReportContext
    progress : callable, optional
        Called before each section with the share of sections that are done, 0 to 1. An exception
        that it raises ends the work.
    about : About
        Title, author, date and revision.

    Raises
    ------
    InputError
        When there is no study, or more than six.
    """
    contexts = keyed_contexts(contexts)
    build = _with_progress(
        len(TOP_SECTIONS) + len(STUDY_SECTIONS) * len(contexts) + len(BOTTOM_SECTIONS), progress
    )
    chapters = _joint_chapters(TOP_SECTIONS, contexts, build)
    chapters += _study_chapters(contexts, build)
    chapters += _joint_chapters(BOTTOM_SECTIONS, contexts, build)
    return _document(contexts, chapters, about).encode("utf-8")


def write_page(
    contexts: Sequence[ReportContext],
    folder: str | Path,
    *,
    name: str = PAGE,
    replace: bool = False,
    about: About = NO_INFO,
) -> Path:
    """Write the page to a folder; return its path.

    Parameters
    ----------
    contexts : sequence of ReportContext
    folder : path
    name : str
    replace : bool
        Whether an existing page is replaced, whoever wrote it.
    about : About
        Title, author, date and revision.

    Raises
    ------
    InputError
        When the folder cannot be written, or contains a page that this program did not write or
        that was changed since.
    """
    folder = pe.prepare_folder(folder, () if replace else (name,))
    with jobs.FileSet(folder, (name,) if replace else ()) as files:
        files.add(name, page_bytes(contexts, about=about))
    return folder / name


JointSection = Callable[[tuple[ReportContext, ...]], Section]
Chapter = list[tuple[ReportContext, Section]]
"""One section of the page for each of the studies."""
BuildSection = Callable[[Callable[[], Section]], Section]
"""Calls a section's function and reports progress."""


def _with_progress(sections: int, progress: Callable[[float], None]) -> BuildSection:
    """Return a function that builds a section after it has reported the share done so far."""
    done = count()

    def build(section: Callable[[], Section]) -> Section:
        progress(next(done) / sections)
        return section()

    return build


def _joint_chapters(
    sections: Sequence[JointSection], contexts: tuple[ReportContext, ...], build: BuildSection
) -> list[Chapter]:
    """Build sections that show all studies together; empty ones are left out."""
    built = [(contexts[0], build(partial(section, contexts))) for section in sections]
    return [[(context, section)] for context, section in built if section.html]


def _study_chapters(contexts: tuple[ReportContext, ...], build: BuildSection) -> list[Chapter]:
    """Build the sections of each study, the same section of all studies side by side."""
    chapters = [
        [(context, build(partial(section, context))) for context in contexts]
        for section in STUDY_SECTIONS
    ]
    filled = [[pair for pair in chapter if pair[1].html] for chapter in chapters]
    return [chapter for chapter in filled if chapter]


def _document(contexts: tuple[ReportContext, ...], chapters: list[Chapter], about: About) -> str:
    sections = [section for chapter in chapters for _, section in chapter]
    body, style_sheet = without_style_attributes(_body(contexts, chapters, about))
    css = [*((HERE / name).read_text("utf-8") for name in STYLES)]
    css += [sheet for section in sections for sheet in section.styles]
    css += [_print_margins(contexts, about), style_sheet]
    sheets = [f"\n{sheet}\n" for sheet in dict.fromkeys(css)]
    programs = dict.fromkeys(script for section in sections for script in section.scripts)
    scripts = [f"\n{_safe_script(program)}\n" for program in programs]
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy(sheets, scripts)}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<meta name="generator" content="perception-entropy {pe.__version__}">',
            *([f'<meta name="author" content="{escaped(about.author)}">'] if about.author else []),
            f"<title>{escaped(_title(contexts, about))}</title>",
            *(f"<style>{sheet}</style>" for sheet in sheets),
            "</head>",
            body,
            *(_data(context, section) for chapter in chapters for context, section in chapter),
            *(f"<script>{script}</script>" for script in scripts),
            "</body>\n</html>\n",
        ]
    )


def _body(contexts: tuple[ReportContext, ...], chapters: list[Chapter], about: About) -> str:
    return "\n".join(
        [
            f'<body class="{"several" if len(contexts) > 1 else "single"}">',
            '<a class="skip" href="#page">Skip to the review</a>',
            _masthead(contexts, about),
            _contents(chapters),
            '<main id="page">',
            *(_chapter(chapter, len(contexts)) for chapter in chapters),
            "</main>",
        ]
    )


def _title(contexts: tuple[ReportContext, ...], about: About) -> str:
    names = " and ".join(context.name for context in contexts)
    return about.title or f"Sensor review: {names}"


def _print_margins(contexts: tuple[ReportContext, ...], about: About) -> str:
    """Return CSS for the margins of a printed page: title and revision, page numbers."""
    revision = f"Revision {about.revision}" if about.revision else ""
    title = _title(contexts, about)
    left = css_string(" \N{MIDDLE DOT} ".join(filter(None, (title, revision))))
    font = "font: 8pt system-ui, sans-serif; color: #57606a"
    return (
        f"@page {{ @bottom-left {{ content: {left}; {font} }} "
        f'@bottom-right {{ content: counter(page) " / " counter(pages); {font} }} }}'
    )


def _masthead(contexts: tuple[ReportContext, ...], about: About) -> str:
    kicker = (
        "Review of the sensors on a vehicle" if len(contexts) == 1 else "Comparison of sensor rigs"
    )
    names = " <small>and</small> ".join(escaped(context.name) for context in contexts)
    heading = f"<h1>{escaped(about.title) or names}</h1>"
    below = f'<p class="of">{names}</p>' if about.title else ""
    line = ", ".join(about.parts)
    line = f'<p class="about">{escaped(line)}</p>' if line else ""
    return f'<header class="masthead"><p class="kicker">{kicker}</p>{heading}{below}{line}</header>'


def _contents(chapters: list[Chapter]) -> str:
    """Return links to the sections."""
    firsts = [chapter[0][1] for chapter in chapters]
    links = "".join(f'<li><a href="#{s.anchor}">{escaped(s.title)}</a></li>' for s in firsts)
    return f'<nav class="contents" aria-label="Contents"><ol>{links}</ol></nav>'


def _chapter(chapter: Chapter, study_count: int) -> str:
    first = chapter[0][1]
    several = len(chapter) > 1
    inside = "".join(_part(context, section, several) for context, section in chapter)
    count = f' style="--beside:{study_count}"' if several else ""
    css = ' class="beside"' if several else ""
    heading = f'<h2 id="h-{first.anchor}">{escaped(first.title)}</h2>'
    return (
        f'<section id="{first.anchor}" aria-labelledby="h-{first.anchor}">{heading}'
        f"<div{css}{count}>{inside}</div></section>"
    )


def _part(context: ReportContext, section: Section, several: bool) -> str:
    name = f'<p class="whose whose-{context.key}">{escaped(context.name)}</p>' if several else ""
    return (
        f'<div class="part" data-section="{section.anchor}" data-key="{context.key}">'
        f"{name}{section.html}</div>"
    )


def _data(context: ReportContext, section: Section) -> str:
    if not section.data:
        return ""
    name = f"data-{section.anchor}-{context.key}"
    data = script_json(section.data)
    return f'<script type="application/json" id="{name}">{data}</script>'


def _safe_script(script: str) -> str:
    """Escape what would end the script element within a string of the script."""
    return script.replace("</script", "<\\/script").replace("<!--", "<\\!--")


STYLE_ATTRIBUTE = re.compile(r' style="([^"]*)"')


def policy(styles: Iterable[str], scripts: Iterable[str]) -> str:
    """Return the content security policy of a page with exactly these sheets and scripts."""
    return "; ".join(
        (
            "default-src 'none'",
            "img-src data: blob:",
            f"style-src {_hashes(styles)}",
            f"script-src {_hashes(scripts)}",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )


def without_style_attributes(html: str) -> tuple[str, str]:
    """Replace style attributes by numbers; return the HTML, and the style sheet with their rules.

    Texts in the HTML must be escaped, so that a quotation mark occurs only around attributes.
    """
    rules: dict[str, int] = {}

    def number_of(attribute: re.Match[str]) -> str:
        return f' data-s="{rules.setdefault(attribute[1], len(rules))}"'

    html = STYLE_ATTRIBUTE.sub(number_of, html)
    # The selector is repeated so that the rule outranks those of classes, as an attribute does.
    sheet = "\n".join(f'[data-s="{n}"][data-s][data-s]{{{rule}}}' for rule, n in rules.items())
    return html, sheet


def _hashes(contents: Iterable[str]) -> str:
    digests = [hashlib.sha256(content.encode("utf-8")).digest() for content in contents]
    sources = dict.fromkeys(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests)
    return " ".join(sources) or "'none'"
