"""XML, read without entity definitions and with limited depth, as hostile files abuse both."""

import re
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from pe_core.base.errors import InputError

NO_LINE_END = re.compile(r"[^\n]")
MAX_DEPTH = 100  # Maximum levels of elements; calibrations have fewer than ten


def text_in(element: Element | None) -> str | None:
    """Return the text of an element without its comments; None if there is no element."""
    return None if element is None else "".join(element.itertext())


def parse_xml(source: str, data: bytes, *, comments: bool = False) -> Element:
    """Return the root of an XML document, with its `comments` if asked for. Definitions in the
    document (``<!DOCTYPE a [...]>``) are refused: a few lines of them can expand to gigabytes. A
    DOCTYPE without definitions is ignored. `InputError` when it is not well-formed, has definitions
    or is nested deeper than `MAX_DEPTH`."""
    tree = TreeBuilder(insert_comments=comments)
    parser = expat.ParserCreate()
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise InputError(source, "file", f"elements at most {MAX_DEPTH} deep", "more")
        tree.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        tree.end(tag)

    def doctype(_name: str, _system: str | None, _public: str | None, internal: bool) -> None:
        if internal:
            expected = "XML without definitions"
            found = "a DOCTYPE with definitions"
            raise InputError(source, "file", expected, found)

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = tree.data
    parser.StartDoctypeDeclHandler = doctype
    parser.CommentHandler = tree.comment if comments else None
    try:
        parser.Parse(data, True)
        root: Element = tree.close()
    except InputError:
        raise
    except (expat.ExpatError, AssertionError, ValueError, LookupError) as error:
        raise InputError(source, "file", "well-formed XML", error) from None
    return root


def without_comments(text: str) -> str:
    """Return XML with blanks in place of its comments, in one pass; an unclosed comment extends to
    the end."""
    first, *parts = text.split("<!--")
    plain = [first]
    for part in parts:
        comment, end, after = part.partition("-->")
        plain += [NO_LINE_END.sub(" ", f"<!--{comment}{end}"), after]
    return "".join(plain)
