"""Text of OpenUSD layers (.usda): what a layer's text says, as prims with their values, and values
as text. Composition is in `usd_stage`. The grammar is that of OpenUSD's "crate-free" text format,
version 1.0; what has no meaning for poses and sensors (connections, splines, relocates) is read
over."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, shown

from .foreign_values import plain_number

MAGIC = "#usda"
SPECIFIERS = ("def", "over", "class")
EDITS = ("prepend", "append", "add", "delete", "reorder")
FLAGS = ("custom", "uniform", "varying", "config")
SAMPLES = ".timeSamples"
MAX_NESTING = 200  # Prims in a row, each in the one before; tuples, lists and dictionaries so
MAX_PRIMS = 200_000
ARRAY = re.compile(r"""\[[^\[\]"'@<#]*\]""")  # Of numbers or tuples of them: its text is kept
TOKEN = re.compile(
    r"""
    (?P<blank>(?:[ \t\r\n,]+|\#[^\n]*|//[^\n]*|/\*.*?\*/)+)
  | (?P<string>\"\"\"(?:[^\\]|\\.)*?\"\"\"|'''(?:[^\\]|\\.)*?'''
      |"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')
  | (?P<asset>@@@(?:.)*?@@@|@[^@\n]*@)
  | (?P<path><[^<>\n]*>)
  | (?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])|-inf\b)
  | (?P<word>[^\W\d][\w:]*(?:\.[^\W\d]\w*)?|[^\W\d][\w:]*)
  | (?P<mark>[()\[\]{}=;:&.])
    """,
    re.VERBOSE | re.DOTALL,
)
_NO_BRACKETS = str.maketrans("[](),\r\n\t", "        ")
_IS_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII).fullmatch
ARCS = {"references", "payload", "inherits", "specializes"}
LIST_ORDER = {"prepend": 0, "": 1, "add": 2, "append": 3}
WORDS = {"true": True, "false": False, "None": None, "inf": math.inf, "nan": math.nan}
ESCAPES = {"n": "\n", "t": "\t", "r": "\r"}
ESCAPED = re.compile(r"\\(x[0-9a-fA-F]{2}|.)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Asset:
    """A path to another file, as the text has it, and the folder of the file that says it."""

    path: str
    folder: Path


@dataclass(frozen=True, slots=True)
class PrimPath:
    """A path to a prim or property of a layer."""

    text: str


@dataclass(frozen=True, slots=True)
class Arc:
    """A reference or payload: the file (None: the same layer) and the prim ("": the default)."""

    asset: Asset | None
    prim: str


@dataclass(frozen=True, slots=True)
class RawArray:
    """An array of a text, not parsed until its numbers are asked for: meshes have long ones."""

    text: str

    @property
    def numbers(self) -> Floats | None:
        """The numbers (N,) in it, tuples one after the other; None for another content."""
        words = self.text.translate(_NO_BRACKETS).split()
        if not all(map(_IS_NUMBER, words)):
            return None
        return np.array(words, dtype=float)


@dataclass(slots=True)
class Prim:
    """What a layer says of a prim. `type` may be empty. `values` are those of its attributes and
    relationships by name; a value of time samples has the name with `SAMPLES`. `arcs` are lists of
    references, payloads, inherits and specializes, strongest first. `variants` are prims by the
    names of set and variant, and `selections` the variants that the layer selects."""

    name: str
    specifier: str = "over"
    type: str = ""
    metadata: dict[str, Any] = field(default_factory=dict)
    values: dict[str, Any] = field(default_factory=dict)
    children: dict[str, "Prim"] = field(default_factory=dict)
    arcs: dict[str, list[Arc]] = field(default_factory=dict)
    variants: dict[str, dict[str, "Prim"]] = field(default_factory=dict)
    selections: dict[str, str] = field(default_factory=dict)


def parse_layer(source: Path, text: str) -> Prim:
    """Return the pseudo-root of a layer. `InputError` with the line where its text is damaged."""
    if not text.lstrip("\ufeff").startswith(MAGIC):
        raise InputError(source, "file", f"a USD layer as text, which begins with {MAGIC}", "none")
    try:
        return LayerParser(source, text).layer()
    except RecursionError:
        raise InputError(source, "prims", f"at most {MAX_NESTING} in a row", "more") from None


class LayerParser:
    """A parser by recursive descent; `at` is the place in the text."""

    def __init__(self, source: Path, text: str) -> None:
        self.source = source
        self.text = text
        self.at = 0
        self.prims = 0
        self.kind = ""
        self.token = ""
        self._advance()

    def layer(self) -> Prim:
        """Parse a whole layer."""
        root = Prim("", "def")
        if self.token == "(":
            self._metadata(root)
        while self.kind:
            self._statement(root, 0)
        return root

    def _advance(self) -> None:
        """Go to the next token that is no blank or comment; `kind` is empty at the end."""
        while self.at < len(self.text):
            found = TOKEN.match(self.text, self.at)
            if found is None:
                self.token = self.text[self.at : self.at + 20]
                raise self._error("a word, number, text or bracket")
            self.at = found.end()
            self.kind = str(found.lastgroup)
            if self.kind != "blank":
                self.token = found[0]
                return
        self.kind = ""
        self.token = ""

    def _error(self, expected: str) -> InputError:
        line = self.text.count("\n", 0, max(self.at - len(self.token), 0)) + 1
        found = shown(self.token) if self.token else "the end of the file"
        return InputError(self.source, f"line {line}", expected, found)

    def _take(self, expected: str = "") -> str:
        """Return a token and go on; `InputError` unless it is the `expected` one, if any."""
        token = self.token
        if not self.kind or (expected and token != expected):
            raise self._error(expected or "more text")
        self._advance()
        return token

    def _text(self) -> str:
        if self.kind != "string":
            raise self._error("a text in quotes")
        return _unquoted(self._take())

    def _statement(self, prim: Prim, depth: int) -> None:
        """Parse a child, a set of variants or a property of a prim."""
        if depth > MAX_NESTING:
            raise self._error(f"at most {MAX_NESTING} prims in a row")
        if self.token == ";":
            self._advance()
        elif self.token in SPECIFIERS:
            child = self._prim(depth)
            known = prim.children.setdefault(child.name, child)
            if known is not child:
                raise self._error(f"a prim {child.name} once")
        elif self.token == "variantSet":
            self._advance()
            variants = prim.variants.setdefault(self._text(), {})
            self._take("=")
            self._take("{")
            while self.token != "}":
                name = self._text()
                variants[name] = self._body(Prim(prim.name), depth + 1)
            self._take("}")
        else:
            self._property(prim)

    def _prim(self, depth: int) -> Prim:
        self.prims += 1
        if self.prims > MAX_PRIMS:
            raise self._error(f"at most {MAX_PRIMS:,} prims")
        specifier = self._take()
        type_name = self._take() if self.kind == "word" else ""
        return self._body(Prim(self._text(), specifier, type_name), depth + 1)

    def _body(self, prim: Prim, depth: int) -> Prim:
        if self.token == "(":
            self._metadata(prim)
        self._take("{")
        while self.token != "}":
            self._statement(prim, depth)
        self._take("}")
        return prim

    def _metadata(self, prim: Prim) -> None:
        """Parse what stands in brackets behind a prim's name, and at a layer's head."""
        self._take("(")
        lists: dict[str, list[tuple[int, list[Arc]]]] = {}
        while self.token != ")":
            if self.kind == "string" or self.token == ";":  # a comment
                self._advance()
                continue
            edit = self._take() if self.token in EDITS else ""
            key = self._take()
            self._take("=")
            if key in ARCS:
                arcs = self._arcs()
                if edit in LIST_ORDER:
                    lists.setdefault(key, []).append((LIST_ORDER[edit], arcs))
            elif key == "subLayers":
                prim.arcs[key] = self._arcs()
            else:
                value = self._value(0)
                if key == "variants" and isinstance(value, dict):
                    prim.selections |= {k: v for k, v in value.items() if isinstance(v, str)}
                elif not edit or edit in LIST_ORDER:
                    prim.metadata[key] = value
        self._take(")")
        for key, parts in lists.items():
            parts.sort(key=lambda part: part[0])
            prim.arcs[key] = [arc for _, arcs in parts for arc in arcs]

    def _arcs(self) -> list[Arc]:
        """Parse references, payloads, inherits, specializes or sublayers: one, a list, or None."""
        if self.token == "None":
            self._advance()
            return []
        if self.token != "[":
            return [self._arc()]
        self._advance()
        arcs = []
        while self.token != "]":
            arcs.append(self._arc())
        self._take("]")
        return arcs

    def _arc(self) -> Arc:
        asset = None
        prim = ""
        if self.kind == "asset":
            asset = self._asset()
        elif self.kind != "path":
            raise self._error("a file between @ or a path between < and >")
        if self.kind == "path":
            prim = self._take()[1:-1]
        if self.token == "(":  # its offset in time
            self._skip_brackets()
        return Arc(asset, prim)

    def _asset(self) -> Asset:
        token = self._take()
        inner = token[3:-3] if token.startswith("@@@") else token[1:-1]
        return Asset(inner, self.source.parent)

    def _skip_brackets(self) -> None:
        """Read over what stands in brackets, whatever it is."""
        depth = 0
        while True:
            token = self._take()
            depth += (token in ("(", "[", "{")) - (token in (")", "]", "}"))
            if depth == 0:
                return

    def _property(self, prim: Prim) -> None:
        if self.token in ("reorder", "relocates"):
            self._take()
        edit = ""
        while self.token in FLAGS or self.token in EDITS:
            edit = self.token if self.token in EDITS else edit
            self._advance()
        if self.kind != "word":
            raise self._error("a prim or a property")
        name = self._take()  # its type, or the word rel
        if self.token == "[":
            self._take("[")
            self._take("]")
        if self.kind == "word":
            name = self._take()
        if self.token == ".":  # x:y.connect, where y has digits in front
            self._take(".")
            name = f"{name}.{self._take()}"
        if self.token == "=":
            value = self._value_after_equals()
            if edit != "delete":
                prim.values[name] = value
        if self.token == "(":
            self._skip_brackets()

    def _value_after_equals(self) -> Any:
        """Parse the value behind an equals sign; an array of numbers is kept as its text."""
        found = re.compile(r"\s*").match(self.text, self.at)
        start = self.at if found is None else found.end()
        array = ARRAY.match(self.text, start)
        if array is not None:
            self.at = array.end()
            self._advance()
            return RawArray(array[0])
        self._take("=")
        return self._value(0)

    def _value(self, depth: int) -> Any:
        if depth > MAX_NESTING:
            raise self._error(f"at most {MAX_NESTING} values in each other")
        kind = self.kind
        if kind == "string":
            return self._text()
        if kind == "number":
            return float(self._take())
        if kind == "asset":
            return self._asset()
        if kind == "path":
            return PrimPath(self._take()[1:-1])
        if kind == "word":
            return WORDS.get(word := self._take(), word)
        if self.token in ("(", "["):
            end = {"(": ")", "[": "]"}[self._take()]
            items = []
            while self.token != end:
                items.append(self._value(depth + 1))
            self._take(end)
            return items
        if self.token == "{":
            return self._dictionary(depth)
        raise self._error("a value")

    def _dictionary(self, depth: int) -> dict[str, Any]:
        """Parse a dictionary (type, key, value) or samples by time."""
        self._take("{")
        found: dict[str, Any] = {}
        while self.token != "}":
            if self.token == ";":
                self._advance()
                continue
            key = self._text() if self.kind == "string" else self._take()
            if self.token == "[":
                self._take("[")
                self._take("]")
            if self.token in (":", "="):
                self._advance()
            elif self.kind in ("word", "string"):  # the key was a type
                key = self._text() if self.kind == "string" else self._take()
                self._take("=")
            else:
                raise self._error("a key and its value")
            found[key] = self._value(depth + 1)
        self._take("}")
        return found


def _unquoted(token: str) -> str:
    quotes = 3 if token[:3] in ('"""', "'''") and len(token) >= 6 else 1

    def plain(found: re.Match[str]) -> str:
        inner = found[1]
        if inner[0] == "x" and len(inner) == 3:
            return chr(int(inner[1:], 16))
        return ESCAPES.get(inner, inner)

    return ESCAPED.sub(plain, token[quotes:-quotes])


def quoted(text: str) -> str:
    """Return a text in quotes, as a layer has it."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    escaped = escaped.replace("\n", "\\n").replace("\r", "\\r").replace("\t", "\\t")
    return f'"{escaped}"'


def number_text(value: float) -> str:
    """Return a number as text that reads back to the same bits; whole ones have no point."""
    return (
        str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else plain_number(value)
    )


def tuple_text(values: Sequence[float]) -> str:
    """Return a vector as text."""
    return f"({', '.join(map(number_text, values))})"


def array_text(values: Sequence[float]) -> str:
    """Return an array of numbers as text."""
    return f"[{', '.join(map(number_text, values))}]"


def dictionary_lines(data: Mapping[str, Any], indent: str) -> Iterator[str]:
    """Yield the lines of a dictionary of plain data: texts, numbers, flags, lists and tables. A
    list of tables becomes a table by their names (``name`` or ``figure``); what is None is left
    out."""
    for key, value in data.items():
        if isinstance(value, list) and value and all(isinstance(row, Mapping) for row in value):
            value = {str(row.get("name", row.get("figure", k))): row for k, row in enumerate(value)}
        if isinstance(value, Mapping):
            yield f"{indent}dictionary {quoted(key)} = {{"
            yield from dictionary_lines(value, indent + "    ")
            yield f"{indent}}}"
        elif value is not None:
            type_name, text = _plain_value(value)
            yield f"{indent}{type_name} {quoted(key)} = {text}"


def _plain_value(value: Any) -> tuple[str, str]:
    if isinstance(value, bool):
        return "bool", "1" if value else "0"
    if isinstance(value, int) and abs(value) < 1 << 31:
        return "int", str(value)
    if isinstance(value, int | float):
        return "double", plain_number(value)
    if isinstance(value, list | tuple):
        if value and all(isinstance(v, int | float) and not isinstance(v, bool) for v in value):
            return "double[]", array_text([float(v) for v in value])
        return "string[]", f"[{', '.join(quoted(str(v)) for v in value)}]"
    return "string", quoted(str(value))
