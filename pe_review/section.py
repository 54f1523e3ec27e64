"""A section of the page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Section:
    """What a section puts on the page.

    Attributes
    ----------
    anchor : str
        Its place in the page's addresses: lower-case letters and hyphens.
    title : str
        Plain text; the page writes the heading.
    html : str
        What stands below it, whole and well formed, names escaped (`markup`). Headings begin at
        h3; an id ends in ``-KEY`` of the `Reviewed`, as there may be several on a page. Empty: the
        section is left out.
    data : dict
        For its scripts, plain JSON: the text of ``#data-ANCHOR-KEY``.
    scripts : tuple of str
        JavaScript, whole programs. Each is put on the page once, after everything else, however
        many sections bring it; it looks for ``[data-section=ANCHOR]``, whose ``data-key`` is KEY.
    styles : tuple of str
        CSS, each on the page once.
    """

    anchor: str
    title: str
    html: str
    data: Mapping[str, Any] = field(default_factory=dict)
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()
