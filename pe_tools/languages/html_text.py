"""Texts of HTML: sentences between the tags of blocks, and attributes that are read aloud."""

from __future__ import annotations

import re
from html import escape, unescape
from typing import Protocol

INLINE = frozenset({"a", "b", "code", "em", "i", "small", "span", "strong", "sub", "sup", "u"})
"""Elements within a sentence; all others begin a new one."""
SKIPPED = re.compile(r"<(script|style|pre)\b.*?</\1>", re.DOTALL)
TAG = re.compile(r"<(/?)([a-zA-Z][\w-]*)((?:[^<>\"]|\"[^\"]*\")*)>")
ATTRIBUTE = re.compile(r'\b(alt|aria-label|title|data-copied|data-selected)="([^"]*)"')
LETTERS = re.compile(r"[A-Za-z]{2}")
SENTENCE_GAP = re.compile(r"(?<=[.?!])(\s+)(?=[A-Z<\d])")
QUOTES = {"&#x27;": "'", "&quot;": '"'}


class Translator(Protocol):
    """What translates: a `Catalog`, or what notes the texts."""

    def message(self, text: str) -> str | None:
        """Return the translation of a text that is one message; None if it is not."""

    def translated(self, text: str) -> str:
        """Return the translation of a text, or the text."""


class _Notes:
    def __init__(self) -> None:
        self.texts: list[str] = []

    def message(self, text: str) -> str:
        self.texts.append(text)
        return text

    translated = message


def texts_of(html: str) -> list[str]:
    """Return the texts of HTML, as `translated_html` translates them."""
    notes = _Notes()
    translated_html(html, notes)
    return notes.texts


def translated_html(html: str, to: Translator) -> str:
    """Return HTML with its texts translated; scripts, style sheets and ``pre`` are left alone."""
    parts, at = [], 0
    for skipped in SKIPPED.finditer(html):
        parts += [_blocks(html[at : skipped.start()], to), skipped[0]]
        at = skipped.end()
    return "".join((*parts, _blocks(html[at:], to)))


def _blocks(html: str, to: Translator) -> str:
    """Translate the runs of text and inline elements between the tags of blocks."""
    done, start = [], 0
    for tag in TAG.finditer(html):
        if tag[2].lower() not in INLINE:
            done += [_run(html[start : tag.start()], to), _tag(tag[0], to)]
            start = tag.end()
    return "".join((*done, _run(html[start:], to)))


def _tag(tag: str, to: Translator) -> str:
    def attribute(match: re.Match[str]) -> str:
        if not LETTERS.search(match[2]):
            return match[0]
        return f'{match[1]}="{escape(to.translated(unescape(match[2])))}"'

    return ATTRIBUTE.sub(attribute, tag)


def _run(run: str, to: Translator) -> str:
    """Translate a run: as one message with its tags, otherwise sentence by sentence."""
    core = run.strip()
    if not LETTERS.search(TAG.sub("", core)):
        return _attributes(run, to)
    start = run.index(core)
    text = _with_quotes(core)
    found = to.message(text)
    if found is None:
        found = "".join(_sentence(part, to) for part in SENTENCE_GAP.split(text))
    return run[:start] + found + run[start + len(core) :]


def _sentence(text: str, to: Translator) -> str:
    """Translate a sentence; where it is no message, each text between its tags."""
    if not TAG.search(text):
        return to.translated(text) if LETTERS.search(text) else text
    found = to.message(text)
    if found is None and text[-1] in ".:":
        found = to.message(text[:-1])
        found = None if found is None else found + text[-1]
    return _pieces(text, to) if found is None else found


def _pieces(text: str, to: Translator) -> str:
    done, start = [], 0
    for tag in TAG.finditer(text):
        piece = text[start : tag.start()]
        done += [to.translated(piece) if LETTERS.search(piece) else piece, _tag(tag[0], to)]
        start = tag.end()
    rest = text[start:]
    return "".join((*done, to.translated(rest) if LETTERS.search(rest) else rest))


def _attributes(run: str, to: Translator) -> str:
    return TAG.sub(lambda tag: _tag(tag[0], to), run)


def _with_quotes(text: str) -> str:
    for entity, quote in QUOTES.items():
        text = text.replace(entity, quote)
    return text
