"""XML, read without entity definitions and with limited depth, as hostile files abuse both."""

from __future__ import annotations

from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from pe_core.base.errors import InputError

MAX_DEPTH = 100
"""Maximum levels of elements; calibrations have fewer than ten."""


def parse_xml(source: str, data: bytes) -> Element:
    """Return the root of an XML document.

    Definitions in the document (``<!DOCTYPE a [...]>``) are refused: a few lines of them can
    expand to gigabytes. A DOCTYPE without definitions is ignored.

    Raises
    ------
    InputError
        When it is not well-formed, has definitions or is nested deeper than `MAX_DEPTH`.
    """
    handlers = _Handlers(source)
    parser = expat.ParserCreate()
    parser.StartElementHandler = handlers.start
    parser.EndElementHandler = handlers.end
    parser.CharacterDataHandler = handlers.tree.data
    parser.StartDoctypeDeclHandler = handlers.doctype
    try:
        parser.Parse(data, True)
        root: Element = handlers.tree.close()
    except InputError:
        raise
    except (expat.ExpatError, AssertionError, ValueError, LookupError) as error:
        raise InputError(source, "file", "well-formed XML", error) from None
    return root


class _Handlers:
    """Handlers of the parser's events."""

    def __init__(self, source: str) -> None:
        self.source, self.tree, self.depth = source, TreeBuilder(), 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            self.refuse(f"elements at most {MAX_DEPTH} deep", "more")
        self.tree.start(tag, attributes)

    def end(self, tag: str) -> None:
        self.depth -= 1
        self.tree.end(tag)

    def doctype(self, name: str, system: str | None, public: str | None, internal: bool) -> None:
        if internal:
            self.refuse("XML without definitions", "a DOCTYPE with definitions")

    def refuse(self, expected: str, found: str) -> NoReturn:
        raise InputError(self.source, "file", expected, found)
