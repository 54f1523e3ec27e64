"""Pages of Markdown: a template beside the study's code, filled with figures and verdicts."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.base import dump_json, read_bytes, write_bytes

from .results_file import RESULTS

PAGE = "README.md"
LINE_WIDTH = 100


def render(path: Path, values: Mapping[str, Any], **filters: Callable[..., str]) -> str:
    """Return a page from its template, in lines of even width.

    Templates have some filters: of this module, and those that are passed.
    """
    text = _templates(path, filters).get_template(path.name).render(values)
    blocks = (block.strip("\n") for block in text.split("\n\n"))
    return "\n\n".join(_wrapped(block) for block in blocks if block.strip()) + "\n"


def sentence(path: Path, macro: str, *values: Any) -> str:
    """Return what a macro of a template says, in one line."""
    module = _templates(path, {}).get_template(path.name).module
    return " ".join(str(getattr(module, macro)(*values)).split())


def _templates(path: Path, filters: Mapping[str, Callable[..., str]]) -> Any:
    import jinja2

    templates = jinja2.Environment(
        loader=jinja2.FileSystemLoader(path.parent),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters |= {"joined": joined, "range": range_text, "rho": rho_text, "p": p_text}
    templates.filters |= filters
    templates.globals |= {"table": table}
    return templates


def _wrapped(block: str) -> str:
    """Return a paragraph in lines of even width; tables, headings and lists as they are."""
    if block.startswith(("|", "#", "- ", "!")):
        return block
    return textwrap.fill(block, LINE_WIDTH, break_long_words=False, break_on_hyphens=False)


def joined(names: Sequence[Any]) -> str:
    """Return names as a sentence lists them: a, b and c."""
    texts = [str(name) for name in names]
    if len(texts) < 2:
        return "".join(texts) or "none"
    return f"{', '.join(texts[:-1])} and {texts[-1]}"


def range_text(values: Sequence[float], digits: int = 2) -> str:
    """Return the range of some numbers: 1.20 to 1.35."""
    low, high = (f"{v:.{digits}f}" for v in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def rho_text(value: float | None) -> str:
    """Return a rank correlation as text; a dash where it is not defined."""
    return "-" if value is None else f"{round(value, 2) + 0.0:+.2f}"


def p_text(p: float | None) -> str:
    """Return a p value as text; a dash where there is none."""
    return "-" if p is None else f"{p:.3f}" if p >= 0.001 else "< 0.001"


def table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    rule = ["---"] * len(head)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, rule, *lines))


def write_study(folder: Path, found: Mapping[str, Any], page: str) -> None:
    """Write what was found, and the page of it, into the folder of a study."""
    write_bytes(folder / RESULTS, dump_json(found).encode())
    write_bytes(folder / PAGE, page.encode())


def check_page(folder: Path, title: str, study: str) -> None:
    """Raise `InputError` when the folder has a page that the study did not write."""
    path = folder / PAGE
    if path.is_file() and not read_bytes(path).startswith(title.encode()):
        found = "another page, which is kept; choose another folder"
        raise InputError(path, "output", f"no file, or a page of python -m studies.{study}", found)
