"""The page: sections put together to one file that asks for no other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import count
from pathlib import Path

from .about import About
from .engine import pe, studies
from .markup import css_string, escaped, script_json
from .policy import policy, without_style_attributes
from .reviewed import Reviewed, reviewed_together
from .section import Section
from .sections import LAST, SECTIONS, TOGETHER

PAGE = studies.REVIEW_PAGE
HERE = Path(__file__).parent
STYLES = ("look.css", "parts.css", "paper.css")
NOTHING_SAID = About()


def page_bytes(
    each: Sequence[Reviewed],
    watch: Callable[[float], None] = lambda _share: None,
    about: About = NOTHING_SAID,
) -> bytes:
    """Return the page of one study, or of several side by side.

    Parameters
    ----------
    each : sequence of Reviewed
    watch : callable, optional
        Called before each section with the share of sections that are made, 0 to 1; what it raises
        ends the work.
    about : About
        Title, author, date and revision.

    Raises
    ------
    InputError
        When there is no study, or more than a page has room for.
    """
    each = reviewed_together(each)
    watched = _counted(len(TOGETHER) + len(SECTIONS) * len(each) + len(LAST), watch)
    chapters = _of_all(TOGETHER, each, watched)
    chapters += _of_each(each, watched)
    chapters += _of_all(LAST, each, watched)
    return _document(each, chapters, about).encode("utf-8")


def write_page(
    each: Sequence[Reviewed],
    folder: str | Path,
    *,
    name: str = PAGE,
    replace: bool = False,
    about: About = NOTHING_SAID,
) -> Path:
    """Write the page to a folder; return its path.

    Parameters
    ----------
    each : sequence of Reviewed
    folder : path
    name : str
    replace : bool
        The user has agreed to replace the page that is there, whoever wrote it.
    about : About
        Title, author, date and revision.

    Raises
    ------
    InputError
        The folder cannot be written, or a page is there that is not ours or was changed since.
    """
    folder = pe.prepare_folder(folder, () if replace else (name,))
    with studies.FileSet(folder, (name,) if replace else ()) as files:
        files.add(name, page_bytes(each, about=about))
    return folder / name


Together = Callable[[tuple[Reviewed, ...]], Section]
Chapter = list[tuple[Reviewed, Section]]
"""A section of the page, as each study has it."""


Make = Callable[[Callable[[], Section]], Section]
"""Makes a section, and tells how far the page is."""


def _counted(sections: int, watch: Callable[[float], None]) -> Make:
    """Return what makes a section after telling how many of them are made."""
    made = count()

    def make(section: Callable[[], Section]) -> Section:
        watch(next(made) / sections)
        return section()

    return make


def _of_all(sections: Sequence[Together], each: tuple[Reviewed, ...], make: Make) -> list[Chapter]:
    """Sections of all studies at once; of a single one most have nothing to say."""
    found = [(each[0], make(partial(section, each))) for section in sections]
    return [[(one, made)] for one, made in found if made.html]


def _of_each(each: tuple[Reviewed, ...], make: Make) -> list[Chapter]:
    """Sections that each study has, those of one kind together."""
    chapters = [[(one, make(partial(section, one))) for one in each] for section in SECTIONS]
    kept = [[(one, made) for one, made in chapter if made.html] for chapter in chapters]
    return [chapter for chapter in kept if chapter]


def _document(each: tuple[Reviewed, ...], chapters: list[Chapter], about: About) -> str:
    made = [section for chapter in chapters for _, section in chapter]
    body, numbered = without_style_attributes(_body(each, chapters, about))
    css = [*(_own(name) for name in STYLES), *(css for s in made for css in s.styles)]
    sheets = [f"\n{sheet}\n" for sheet in _once([*css, _on_paper(each, about), numbered])]
    scripts = [f"\n{_closed(s)}\n" for s in _once(script for s in made for script in s.scripts)]
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy(sheets, scripts)}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<meta name="generator" content="perception-entropy {pe.__version__}">',
            *([f'<meta name="author" content="{escaped(about.author)}">'] if about.author else []),
            f"<title>{escaped(_title(each, about))}</title>",
            *(f"<style>{sheet}</style>" for sheet in sheets),
            "</head>",
            body,
            *(_data(one, section) for chapter in chapters for one, section in chapter),
            *(f"<script>{script}</script>" for script in scripts),
            "</body>\n</html>\n",
        ]
    )


def _body(each: tuple[Reviewed, ...], chapters: list[Chapter], about: About) -> str:
    return "\n".join(
        [
            f'<body class="{"several" if len(each) > 1 else "single"}">',
            '<a class="skip" href="#page">Skip to the review</a>',
            _masthead(each, about),
            _contents(chapters),
            '<main id="page">',
            *(_chapter(chapter, len(each)) for chapter in chapters),
            "</main>",
        ]
    )


def _title(each: tuple[Reviewed, ...], about: About) -> str:
    return about.title or f"Sensor review: {' and '.join(one.name for one in each)}"


def _on_paper(each: tuple[Reviewed, ...], about: About) -> str:
    """Return what stands in the margins of a printed page: title and revision, page numbers."""
    revision = f"Revision {about.revision}" if about.revision else ""
    left = css_string(" \N{MIDDLE DOT} ".join(filter(None, (_title(each, about), revision))))
    font = "font: 8pt system-ui, sans-serif; color: #57606a"
    return (
        f"@page {{ @bottom-left {{ content: {left}; {font} }} "
        f'@bottom-right {{ content: counter(page) " / " counter(pages); {font} }} }}'
    )


def _masthead(each: tuple[Reviewed, ...], about: About) -> str:
    kicker = "Review of sensors on a vehicle" if len(each) == 1 else "Sensors side by side"
    names = " <small>and</small> ".join(escaped(one.name) for one in each)
    heading = f"<h1>{escaped(about.title) or names}</h1>"
    below = f'<p class="of">{names}</p>' if about.title else ""
    said = f'<p class="about">{escaped(about.line)}</p>' if about.line else ""
    return f'<header class="masthead"><p class="kicker">{kicker}</p>{heading}{below}{said}</header>'


def _contents(chapters: list[Chapter]) -> str:
    """Links to the sections."""
    firsts = [chapter[0][1] for chapter in chapters]
    links = "".join(f'<li><a href="#{s.anchor}">{escaped(s.title)}</a></li>' for s in firsts)
    return f'<nav class="contents" aria-label="Contents"><ol>{links}</ol></nav>'


def _chapter(chapter: Chapter, studies_there: int) -> str:
    first = chapter[0][1]
    several = len(chapter) > 1
    inside = "".join(_part(one, section, several) for one, section in chapter)
    count = f' style="--beside:{studies_there}"' if several else ""
    css = ' class="beside"' if several else ""
    heading = f'<h2 id="h-{first.anchor}">{escaped(first.title)}</h2>'
    return (
        f'<section id="{first.anchor}" aria-labelledby="h-{first.anchor}">{heading}'
        f"<div{css}{count}>{inside}</div></section>"
    )


def _part(one: Reviewed, section: Section, several: bool) -> str:
    name = f'<p class="whose whose-{one.key}">{escaped(one.name)}</p>' if several else ""
    return (
        f'<div class="part" data-section="{section.anchor}" data-key="{one.key}">'
        f"{name}{section.html}</div>"
    )


def _data(one: Reviewed, section: Section) -> str:
    if not section.data:
        return ""
    name = f"data-{section.anchor}-{one.key}"
    return f'<script type="application/json" id="{name}">{script_json(section.data)}</script>'


def _own(name: str) -> str:
    return (HERE / name).read_text("utf-8")


def _once(texts: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(texts))


def _closed(script: str) -> str:
    """A script in whose strings nothing ends it."""
    return script.replace("</script", "<\\/script").replace("<!--", "<\\!--")
