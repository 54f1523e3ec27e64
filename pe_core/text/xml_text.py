"""XML without what makes it dangerous: definitions of its own, and depth."""

from __future__ import annotations

from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from ..errors import InputError

DEEPEST = 100
"""Levels of elements; calibrations have under ten."""


def parse_xml(source: str, data: bytes) -> Element:
    """Return the root of an XML document.

    Definitions in the document itself (``<!DOCTYPE a [...]>``) are refused: a few lines of them
    can stand for gigabytes. A bare DOCTYPE is passed over.

    Raises
    ------
    InputError
        When it is not well-formed, defines anything or is nested deeper than `DEEPEST`.
    """
    reader = _Reader(source)
    parser = expat.ParserCreate()
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.tree.data
    parser.StartDoctypeDeclHandler = reader.doctype
    try:
        parser.Parse(data, True)
        root: Element = reader.tree.close()
    except InputError:
        raise
    except (expat.ExpatError, AssertionError, ValueError, LookupError) as error:
        raise InputError(source, "file", "well-formed XML", error) from None
    return root


class _Reader:
    """What the parser calls on its way."""

    def __init__(self, source: str) -> None:
        self.source, self.tree, self.depth = source, TreeBuilder(), 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.depth += 1
        if self.depth > DEEPEST:
            self.refuse(f"elements at most {DEEPEST} deep", "more")
        self.tree.start(tag, attributes)

    def end(self, tag: str) -> None:
        self.depth -= 1
        self.tree.end(tag)

    def doctype(self, name: str, system: str | None, public: str | None, own: bool) -> None:
        if own:
            self.refuse("XML without definitions of its own", "a DOCTYPE with some")

    def refuse(self, expected: str, found: str) -> NoReturn:
        raise InputError(self.source, "file", expected, found)
