"""Templates: texts with tags, parsed into functions that write to a list. The tags are those of
Jinja that ours use: if, for, set, macro, call, include, from. A line break behind a tag, and blanks
before one that begins a line, are no text."""

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from .expressions import (
    CHECKS,
    Expression,
    ExpressionParser,
    Scope,
    TemplateError,
    ValueFilter,
    element,
)
from .markup import Markup, escape

TAG = re.compile(r"\{(?:%(-?)(.*?)(-?)%|\{(-?)(.*?)(-?)\}|#(-?)(.*?)(-?)#)\}", re.DOTALL)
JSON_IN_HTML = {ord(c): f"\\u{ord(c):04x}" for c in "<>&'"}
ALWAYS = Scope({"range": range})
"""What every template may name."""
BlockWriter = Callable[[Scope, list[str]], None]


class TemplatePiece(NamedTuple):
    """A part of a template: text, or what stands in a tag, with its sort: "text", "value", or the
    tag's first word."""

    sort: str
    text: str


class Loop:
    """What ``loop`` is: where a ``for`` is."""

    def __init__(self, count: int) -> None:
        self.index0 = 0
        self._count = count
        self._changed: tuple[Any, ...] | None = None

    @property
    def index(self) -> int:
        """Number of the item, from 1."""
        return self.index0 + 1

    @property
    def revindex(self) -> int:
        """Number of the item from the end, the last one 1."""
        return self._count - self.index0

    @property
    def first(self) -> bool:
        """Whether it is the first item."""
        return self.index0 == 0

    @property
    def last(self) -> bool:
        """Whether it is the last item."""
        return self.index0 == self._count - 1

    def changed(self, *values: Any) -> bool:
        """Whether values differ from those of the last call."""
        before = self._changed
        self._changed = values
        return before != values


class Templates:
    """The templates of a folder. `filters` are functions by name, beside those of `built_in`;
    `finalize` is called with each value before it is written. Unless `is_html`, nothing is escaped.
    """

    def __init__(
        self,
        folder: Path,
        filters: Mapping[str, ValueFilter] | None = None,
        finalize: Callable[[object], object] = lambda value: value,
        *,
        is_html: bool = True,
    ) -> None:
        self._folder = folder
        self._finalize = finalize
        self._is_html = is_html
        self._filters = {**built_in(self._named), **(filters or {})}
        self._known: dict[str, BlockWriter] = {}
        self._modules: dict[str, Scope] = {}

    def render(self, name: str, **values: Any) -> str:
        """Return a template filled with values; `TemplateError` for one that is wrong."""
        out: list[str] = []
        self._template(name)(Scope(values, ALWAYS), out)
        return self._text(out)

    def module(self, name: str) -> Mapping[str, Any]:
        """Return what a template defines: its macros, as functions."""
        if name not in self._modules:
            scope = Scope({}, ALWAYS)
            self._template(name)(scope, [])
            self._modules[name] = scope
        return self._modules[name].values

    def _named(self, name: str) -> ValueFilter:
        return self._filters[name]

    def _template(self, name: str) -> BlockWriter:
        if name not in self._known:
            text = (self._folder / name).read_text("utf-8").removesuffix("\n")
            pieces = list(_pieces(text))
            try:
                self._known[name] = self._block(pieces, ())
            except TemplateError as error:
                raise TemplateError(f"{name}: {error}") from None
        return self._known[name]

    def _text(self, out: Sequence[str]) -> str:
        text = "".join(out)
        return Markup(text) if self._is_html else text

    def _parser(self, text: str) -> ExpressionParser:
        return ExpressionParser(text, self._filters)

    def _block(self, pieces: list[TemplatePiece], ends: Sequence[str]) -> BlockWriter:
        """Take pieces up to one of the tags `ends`, which stays."""
        parts: list[BlockWriter] = []
        while pieces and pieces[0].sort not in ends:
            piece = pieces.pop(0)
            if piece.sort == "text":
                parts.append(partial(_write_text, piece.text))
            elif piece.sort == "value":
                parser = self._parser(piece.text)
                parts.append(partial(self._write_value, parser.expression()))
                parser.end()
            else:
                parts.append(self._statement(piece, pieces))
        if ends and not pieces:
            raise TemplateError(f"expected {ends[-1]}, found the end")

        def write(scope: Scope, out: list[str]) -> None:
            for part in parts:
                part(scope, out)

        return write

    def _write_value(self, value: Expression, scope: Scope, out: list[str]) -> None:
        found = self._finalize(value(scope))
        out.append(str(escape(found) if self._is_html else found))

    def _statement(self, piece: TemplatePiece, pieces: list[TemplatePiece]) -> BlockWriter:
        kinds: dict[str, Callable[[ExpressionParser, list[TemplatePiece]], BlockWriter]] = {
            "if": self._if,
            "for": self._for,
            "set": self._set,
            "macro": self._macro,
            "call": self._call,
            "include": self._include,
            "from": self._from,
        }
        if piece.sort not in kinds:
            raise TemplateError(f"unexpected {piece.sort}")
        return kinds[piece.sort](self._parser(piece.text), pieces)

    def _body(self, pieces: list[TemplatePiece], end: str) -> BlockWriter:
        """Take a block with its end."""
        block = self._block(pieces, (end,))
        pieces.pop(0)
        return block

    def _if(self, parser: ExpressionParser, pieces: list[TemplatePiece]) -> BlockWriter:
        condition = parser.expression()
        parser.end()
        block = self._block(pieces, ("elif", "else", "endif"))
        last = pieces.pop(0)
        other: BlockWriter = _write_nothing
        if last.sort == "elif":
            other = self._if(self._parser(last.text), pieces)
        elif last.sort == "else":
            other = self._body(pieces, "endif")

        def write(scope: Scope, out: list[str]) -> None:
            (block if condition(scope) else other)(scope, out)

        return write

    def _for(self, parser: ExpressionParser, pieces: list[TemplatePiece]) -> BlockWriter:
        names = parser.names()
        parser.expect("in")
        items = parser.condition()
        wanted = parser.condition() if parser.skip("if") else None
        parser.end()
        block = self._block(pieces, ("else", "endfor"))
        other: BlockWriter = _write_nothing
        if pieces.pop(0).sort == "else":
            other = self._body(pieces, "endfor")

        def write(scope: Scope, out: list[str]) -> None:
            scopes = [Scope(_bound(names, item), scope) for item in items(scope)]
            kept = [each for each in scopes if wanted is None or wanted(each)]
            loop = Loop(len(kept))
            for number, each in enumerate(kept):
                loop.index0 = number
                each.values["loop"] = loop
                block(each, out)
            if not kept:
                other(scope, out)

        return write

    def _set(self, parser: ExpressionParser, pieces: list[TemplatePiece]) -> BlockWriter:
        names = parser.names()
        if parser.skip("="):
            value = parser.values()
            parser.end()

            def store(scope: Scope, _out: list[str]) -> None:
                scope.values.update(_bound(names, value(scope)))

            return store
        parser.end()
        block = self._body(pieces, "endset")

        def keep(scope: Scope, _out: list[str]) -> None:
            scope.values[names[0]] = self._written(block, Scope({}, scope))

        return keep

    def _written(self, block: BlockWriter, scope: Scope) -> str:
        out: list[str] = []
        block(scope, out)
        return self._text(out)

    def _macro(self, parser: ExpressionParser, pieces: list[TemplatePiece]) -> BlockWriter:
        name = parser.name()
        parser.expect("(")
        defaults: dict[str, Expression | None] = {}
        while not parser.skip(")"):
            argument = parser.name()
            defaults[argument] = parser.expression() if parser.skip("=") else None
            parser.skip(",")
        block = self._body(pieces, "endmacro")

        def define(scope: Scope, _out: list[str]) -> None:
            def macro(*values: Any, **named: Any) -> str:
                given = dict(zip(defaults, values, strict=False)) | named
                for argument, default in defaults.items():
                    if argument not in given and default is not None:
                        given[argument] = default(scope)
                return self._written(block, Scope(given, scope))

            scope.values[name] = macro

        return define

    def _call(self, parser: ExpressionParser, pieces: list[TemplatePiece]) -> BlockWriter:
        name = parser.name()
        parser.expect("(")
        taken = parser.arguments()
        parser.end()
        block = self._body(pieces, "endcall")

        def write(scope: Scope, out: list[str]) -> None:
            values, named = taken(scope)
            out.append(
                str(
                    scope[name](
                        *values, caller=lambda: self._written(block, Scope({}, scope)), **named
                    )
                )
            )

        return write

    def _include(self, parser: ExpressionParser, _: list[TemplatePiece]) -> BlockWriter:
        name = parser.expression()

        def write(scope: Scope, out: list[str]) -> None:
            self._template(name(scope))(Scope({}, scope), out)

        return write

    def _from(self, parser: ExpressionParser, _: list[TemplatePiece]) -> BlockWriter:
        template = parser.expression()
        parser.expect("import")
        names = parser.names()

        def store(scope: Scope, _out: list[str]) -> None:
            found = self.module(template(scope))
            scope.values.update({name: found[name] for name in names})

        return store


def built_in(named: Callable[[str], ValueFilter]) -> dict[str, ValueFilter]:
    """Return the filters of Jinja that ours use; `named` finds those that are applied to each of
    several values."""

    def mapped(values: Iterable[Any], *name: Any, attribute: str = "") -> Iterator[Any]:
        for value in values:
            if attribute:
                yield _at(value, attribute)
            else:
                yield named(name[0])(value, *name[1:])

    def chosen(values: Iterable[Any], path: str, check: str = "", *given: Any) -> Iterator[Any]:
        for value in values:
            found = _at(value, path)
            if CHECKS[check](found, *given) if check else found:
                yield value

    return {
        "abs": abs,
        "first": lambda values: next(iter(values)),
        "format": lambda text, *values: text % values,
        "join": lambda values, between="": _joined(list(values), between),
        "length": len,
        "list": list,
        "map": mapped,
        "max": lambda values, attribute="": max(values, key=lambda v: _at(v, attribute)),
        "min": min,
        "reject": lambda values, check: (v for v in values if not CHECKS[check](v)),
        "replace": lambda text, old, new: text.replace(old, new),
        "selectattr": chosen,
        "tojson": _json,
    }


def _at(value: Any, path: str) -> Any:
    for name in filter(None, path.split(".")):
        value = element(value, name)
    return value


def _joined(values: Sequence[Any], between: str) -> str:
    if any(isinstance(value, Markup) for value in values):
        return escape(between).join(values)
    return between.join(map(str, values))


def _json(data: Any) -> Markup:
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return Markup(text.translate(JSON_IN_HTML))


def _bound(names: Sequence[str], value: Any) -> dict[str, Any]:
    if len(names) == 1:
        return {names[0]: value}
    return dict(zip(names, value, strict=True))


def _write_text(text: str, _scope: Scope, out: list[str]) -> None:
    out.append(text)


def _write_nothing(_scope: Scope, _out: list[str]) -> None:
    """BlockWriter nothing."""


def _pieces(source: str) -> Iterator[TemplatePiece]:
    """Yield the pieces of a template, without the blanks and line breaks that are no text."""
    place = 0
    strips = False
    for tag in TAG.finditer(source):
        sort = source[tag.start() + 1]
        open_dash, inside, close_dash = (part for part in tag.groups() if part is not None)
        text = source[place : tag.start()]
        text = text.lstrip() if strips else text
        line = source.rfind("\n", 0, tag.start()) + 1
        if open_dash:
            text = text.rstrip()
        elif sort != "{" and place <= line and not source[line : tag.start()].strip():
            text = text.removesuffix(source[line : tag.start()])
        if text:
            yield TemplatePiece("text", text)
        if sort == "{":
            yield TemplatePiece("value", inside)
        elif sort == "%":
            word, *rest = inside.split(None, 1)
            yield TemplatePiece(word, rest[0] if rest else "")
        place = tag.end()
        strips = bool(close_dash)
        if sort != "{" and not strips and source[place : place + 1] == "\n":
            place += 1
    text = source[place:]
    text = text.lstrip() if strips else text
    if text:
        yield TemplatePiece("text", text)
