"""A page of HTML as a tree of elements, by Python's own parser."""

from collections.abc import Iterator
from html.parser import HTMLParser

VOID = {"meta", "img", "br", "link", "input", "hr", "wbr", "path", "rect", "circle", "line"}


class Element:
    """An element: its tag, its attributes, and in `parts` the texts and elements inside."""

    def __init__(self, tag: str, attributes: dict[str, str]) -> None:
        self.tag = tag
        self.attributes = attributes
        self.parts: list[Element | str] = []

    def __iter__(self) -> "Iterator[Element]":
        """Yield the element and all elements inside, as they stand."""
        yield self
        for part in self.parts:
            if isinstance(part, Element):
                yield from part

    @property
    def text(self) -> str:
        """All text inside."""
        return "".join(part if isinstance(part, str) else part.text for part in self.parts)

    @property
    def classes(self) -> list[str]:
        """Names of its classes."""
        return self.attributes.get("class", "").split()

    def all(self, tag: str, **wanted: str) -> "list[Element]":
        """Return the elements inside with a tag and attributes: `http_equiv` is http-equiv."""
        named = {name.replace("_", "-"): value for name, value in wanted.items()}
        return [
            each for each in self if each.tag == tag and named.items() <= each.attributes.items()
        ]

    def one(self, tag: str, **wanted: str) -> "Element":
        """Return the only element with a tag and attributes."""
        (found,) = self.all(tag, **wanted)
        return found


class _Tree(HTMLParser):
    """Builds the tree; an element that ends inside another one is a failure."""

    def __init__(self) -> None:
        super().__init__()
        self.open = [Element("", {})]

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        element = Element(tag, {name: value or "" for name, value in attributes})
        self.open[-1].parts.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop().tag == tag, (tag, [each.tag for each in self.open[-4:]])

    def handle_data(self, data: str) -> None:
        self.open[-1].parts.append(data)


def parsed(html: str) -> Element:
    """Return an element that holds all of a page or of a part of one; each element must end."""
    tree = _Tree()
    tree.feed(html)
    tree.close()
    assert len(tree.open) == 1, [each.tag for each in tree.open]
    return tree.open[0]


def scripts(page: Element, start: str) -> dict[str, str]:
    """Return the texts of the page's scripts whose id begins so, by the rest of the id."""
    named = {each.attributes.get("id", ""): each.text for each in page.all("script")}
    return {
        name.removeprefix(start): text for name, text in named.items() if name.startswith(start)
    }


def policy_of(page: Element) -> str:
    """Return the page's Content-Security-Policy."""
    return page.one("meta", http_equiv="Content-Security-Policy").attributes["content"]


def tagged_rows(page: Element) -> list[tuple[str, list[str]]]:
    """Return the heads, without numbers, and the tag's classes of rows with a tag: "tag met"."""
    rows = [(row.all("th", scope="row"), row.all("span")) for row in page.all("tr")]
    return [
        (str(heads[0].parts[0]).partition(" ")[2], spans[0].classes)
        for heads, spans in rows
        if heads and spans and "tag" in spans[0].classes
    ]
