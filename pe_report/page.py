"""The page: results.json in words and tables. No figure here comes from anywhere else."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.text import read_bytes, write_bytes

from .facts import Facts
from .sections import SECTIONS

PAGE = "README.md"
TITLE = "# The paper's experiments, reproduced"
WIDTH = 100


def check_ours(folder: Path, title: str = TITLE, verb: str = "pe reproduce") -> None:
    """Raise `InputError` when a page of somebody else's is where ours would be."""
    path = folder / PAGE
    if path.is_file() and not read_bytes(path).startswith(title.encode()):
        found = "another; it stays as it is, choose another folder"
        raise InputError(path, "output", f"no file, or a page of {verb}", found)


def write_page(data: Mapping[str, Any], folder: Path) -> None:
    """Write the page beside its plots."""
    write_bytes(folder / PAGE, page(Facts(data)).encode())


def page(facts: Facts) -> str:
    """Return the page as Markdown."""
    return put_together(part(facts) for part in SECTIONS)


def put_together(sections: Iterable[str]) -> str:
    """Return sections of Markdown as one page, in lines of even width."""
    blocks = (block for part in sections for block in part.strip().split("\n\n"))
    return "\n\n".join(map(_wrapped, blocks)) + "\n"


def _wrapped(block: str) -> str:
    """Return a paragraph in lines of even width; tables, headings and the like as they are."""
    if block.startswith(("|", "#", "-", "!")):
        return block
    return textwrap.fill(block, WIDTH, break_long_words=False, break_on_hyphens=False)
