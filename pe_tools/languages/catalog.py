"""The messages of a language, and how a text that is shown is found among them.

A message is an English text with placeholders, `it is {gap} clear of the vehicle`. The texts that
the engine composes are matched with the messages: the values in place of the placeholders are
translated in turn, if they are messages themselves, and put into the translation.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from .po_file import PLACEHOLDER, placeholders

RAW = ("name", "path", "file", "folder", "filepath", "part", "key", "mesh", "command")
"""Ends of the names of placeholders that users' own names stand in: these are not translated."""
CLASSES = frozenset({"car", "cone", "cyclist", "motorcyclist", "pedestrian", "truck"})
"""Names of classes of objects: these are translated."""
MAX_CACHED = 8192
MIN_LETTERS = 8
"""A message with fewer letters beside its placeholders may occur in any sentence by chance."""
MAX_DEPTH = 5
"""A text in a text in a text: no message goes deeper."""
LETTERS = re.compile(r"[A-Za-z]{2}")
SENTENCE_END = re.compile(r"(?<=[.?!])\s+(?=[A-Z<\d])")
LIST_SEPARATOR = re.compile(r"(, | and )")
UNIT = re.compile(r" (m|mm|cm|nats|deg)\b|[%°]")
NUMBER = r"([^\s,;:()]*(?: to [^\s,;:()]+)?)"
"""Before a unit there is a number, or two."""
ENDS = ".:;,?!"
LEADS = "↓↑→·•× "
SINGLE = re.compile(r"[^\s<>]*|[\d.,%°×+−<x m-]+")


@dataclass(frozen=True)
class Style:
    """How a language writes lists and the ends of sentences.

    Attributes
    ----------
    marks : mapping of str to str
        Punctuation marks that differ from the English ones.
    list_comma, list_and : str
        Between the parts of a list, and before the last one.
    sentence_gap : str
        Between sentences.
    """

    marks: Mapping[str, str] = field(default_factory=dict)
    list_comma: str = ", "
    list_and: str = " and "
    sentence_gap: str = " "


@dataclass(frozen=True)
class Template:
    """A message with placeholders, ready to be matched."""

    pattern: re.Pattern[str]
    names: tuple[str, ...]
    longest: str
    is_weak: bool
    translation: str


class Catalog:
    """Translations of one language.

    Parameters
    ----------
    messages : mapping of str to str
        Translations by their English messages.
    style : Style
    names : set of str
        Users' own names: these texts are not translated, also where they are messages.
    """

    def __init__(
        self,
        messages: Mapping[str, str],
        style: Style | None = None,
        names: frozenset[str] = frozenset(),
    ) -> None:
        self.messages = dict(messages)
        self.style = style or Style()
        self.names = names
        plain = {text: to for text, to in messages.items() if not placeholders(text)}
        self.plain: Mapping[str, str] = plain
        composed = sorted(messages.keys() - plain.keys(), key=_literal_length, reverse=True)
        self._templates = tuple(_template(text, messages[text]) for text in composed)
        self._cached = lru_cache(MAX_CACHED)(self._shown)

    def with_names(self, names: Iterable[str]) -> Catalog:
        """Return the same catalogue that leaves these names as they are."""
        return Catalog(self.messages, self.style, frozenset(names))

    def translated(self, text: str) -> str:
        """Return a text in this language; a text that is no message is returned as it is."""
        if not self.messages or not LETTERS.search(text):
            return text
        return self._cached(text)

    def filled(self, message: str, **values: object) -> str:
        """Return the translation of a message with values in place of its placeholders."""
        return _filled(self.messages.get(message, message), values)

    def message(self, text: str) -> str | None:
        """Return the translation of a text that is one message; None if it is not."""
        return self._message(text, 0)

    def _shown(self, text: str) -> str:
        return self._translated(text, 0)

    def _translated(self, text: str, depth: int) -> str:
        """Return a text in this language; spaces around it stay."""
        core = text.strip()
        if depth > MAX_DEPTH or not LETTERS.search(core):
            return text
        found = self._message(core, depth)
        if found is None:
            found = next(self._in_parts(core, depth), core)
        start = text.index(core)
        return text[:start] + found + text[start + len(core) :]

    def _message(self, text: str, depth: int) -> str | None:
        """Return the translation of a text that is one message; None if it is not."""
        if text in self.names:
            return text
        for form in dict.fromkeys((text, text[:1].lower() + text[1:])):
            found = self.plain.get(form)
            if found is None:
                found = self._composed(form, depth)
            if found is not None:
                return found if form is text else found[:1].upper() + found[1:]
        return None

    def _composed(self, text: str, depth: int) -> str | None:
        for template in self._templates:
            if template.longest not in text:
                continue
            match = template.pattern.fullmatch(text)
            if match is not None and self._suits(template, match.groups(), depth):
                pairs = zip(template.names, match.groups(), strict=True)
                values = {name: self._value(name, value, depth) for name, value in pairs}
                return _filled(template.translation, values)
        return None

    def _suits(self, template: Template, values: tuple[str, ...], depth: int) -> bool:
        """Whether a match is one: with few own letters, each value is a word or a message."""
        if not template.is_weak:
            return True
        return all(
            value in self.names
            or SINGLE.fullmatch(value)
            or (depth < MAX_DEPTH and self._message(value, depth + 1) is not None)
            for value in values
        )

    def _value(self, name: str, value: str, depth: int) -> str:
        """Return the value of a placeholder; users' own names are not translated."""
        if name.rstrip("0123456789").endswith(RAW) and value not in CLASSES:
            return value
        return self._translated(value, depth + 1)

    def _in_parts(self, text: str, depth: int) -> Iterator[str]:
        """Yield what a text is that is put together of several messages."""
        sentences = SENTENCE_END.split(text)
        if len(sentences) > 1:
            parts = [self._translated(sentence, depth + 1) for sentence in sentences]
            if parts != sentences:
                yield self.style.sentence_gap.join(parts)
        if text[0] in LEADS and len(core := text.lstrip(LEADS)) > 1:
            yield text[: len(text) - len(core)] + self._translated(core, depth + 1)
        if text[-1] in ENDS and (found := self._translated(text[:-1], depth + 1)) != text[:-1]:
            yield found + self.style.marks.get(text[-1], text[-1])
        yield from self._labelled(text, depth)
        yield from self._halves(text, depth)
        yield from self._lists(text, depth)

    def _labelled(self, text: str, depth: int) -> Iterator[str]:
        """Yield a text after a label: "lidar_left: field of view"."""
        label, colon, rest = text.partition(": ")
        if colon and (found := self._translated(rest, depth + 1)) != rest:
            yield self._translated(label, depth + 1) + ": " + found

    def _halves(self, text: str, depth: int) -> Iterator[str]:
        """Yield a text of clauses with a semicolon, or with a bracket at the end."""
        clauses = text.split("; ")
        if len(clauses) > 1:
            parts = [self._translated(clause, depth + 1) for clause in clauses]
            if parts != clauses:
                yield (self.style.marks.get(";") or "; ").join(parts)
        if text[-1] == ")" and (cut := text.find(" (")) > 0:
            before, inside = text[:cut], text[cut + 2 : -1]
            parts = [self._translated(part, depth + 1) for part in (before, inside)]
            if parts != [before, inside]:
                yield f"{parts[0]} ({parts[1]})"

    def _lists(self, text: str, depth: int) -> Iterator[str]:
        """Yield a list of parts; each is a message or a single word."""
        pieces = LIST_SEPARATOR.split(text)
        if len(pieces) == 1:
            return
        items = [self._translated(piece, depth + 1) for piece in pieces[::2]]
        pairs = list(zip(items, pieces[::2], strict=True))
        if items == pieces[::2] or any(a == b and not SINGLE.fullmatch(b) for a, b in pairs):
            return
        marks = {", ": self.style.list_comma, " and ": self.style.list_and}
        yield "".join(
            items[k // 2] if k % 2 == 0 else marks[piece] for k, piece in enumerate(pieces)
        )


def _literal_length(message: str) -> int:
    return len(PLACEHOLDER.sub("", message))


def _template(message: str, translation: str) -> Template:
    """Return a message ready to be matched; a placeholder may hold any text."""
    pieces = PLACEHOLDER.split(message)
    literals = pieces[::2]
    pattern = re.escape(literals[0]) + "".join(
        (NUMBER if UNIT.match(literal) else "(.*?)") + re.escape(literal)
        for literal in literals[1:]
    )
    names = tuple(pieces[1::2])
    is_weak = sum(map(str.isalpha, "".join(pieces[::2]))) < MIN_LETTERS
    return Template(re.compile(pattern), names, max(pieces[::2], key=len), is_weak, translation)


def _filled(translation: str, values: Mapping[str, object]) -> str:
    return PLACEHOLDER.sub(lambda hole: str(values.get(hole[1], hole[0])), translation)
