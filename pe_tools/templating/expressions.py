"""Expressions of templates: parsed into functions of a scope, with Jinja's precedence and its
look-up of attributes. No text is run."""

import ast
import operator
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

from .markup import Markup

TOKEN = re.compile(
    r"""\s*(?:(?P<number>\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)
    |(?P<text>"(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*')
    |(?P<name>[A-Za-z_]\w*)
    |(?P<sign>==|!=|<=|>=|//|[-+*/%~<>()\[\]{},.:|=]))""",
    re.VERBOSE,
)
END = ("end", "")
CONSTANTS = {"none": None, "true": True, "false": False}
COMPARED: Mapping[str, Callable[[Any, Any], Any]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "in": lambda a, b: a in b,
    "not in": lambda a, b: a not in b,
}
SUMS: Mapping[str, Callable[[Any, Any], Any]] = {"+": operator.add, "-": operator.sub}
PRODUCTS: Mapping[str, Callable[[Any, Any], Any]] = {
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
}
CHECKS: Mapping[str, Callable[..., bool]] = {
    "none": lambda value: value is None,
    "string": lambda value: isinstance(value, str),
    "equalto": operator.eq,
    "ne": operator.ne,
}
"""What ``is`` and `selectattr` ask; ``is defined`` is of names."""


class TemplateError(Exception):
    """A template is wrong, or a value that it names is missing."""


class Scope:
    """Names and their values, within other names."""

    def __init__(
        self, values: Mapping[str, Any] | None = None, outer: "Scope | None" = None
    ) -> None:
        self.values = dict(values or {})
        self._outer = outer

    def __contains__(self, name: str) -> bool:
        return name in self.values or (self._outer is not None and name in self._outer)

    def __getitem__(self, name: str) -> Any:
        scope: Scope | None = self
        while scope is not None:
            if name in scope.values:
                return scope.values[name]
            scope = scope._outer
        raise TemplateError(f"{name} is not defined")


Expression = Callable[[Scope], Any]
Arguments = Callable[[Scope], tuple[list[Any], dict[str, Any]]]
ValueFilter = Callable[..., Any]


def attribute(value: Any, name: str) -> Any:
    """Return an attribute of a value, or else the element of that name."""
    try:
        return getattr(value, name)
    except AttributeError:
        try:
            return value[name]
        except (TypeError, LookupError):
            raise TemplateError(f"{type(value).__name__} has no {name}") from None


def element(value: Any, key: Any) -> Any:
    """Return an element of a value, or else the attribute of that name."""
    try:
        return value[key]
    except (TypeError, LookupError):
        if not isinstance(key, str) or not hasattr(value, key):
            raise TemplateError(f"{type(value).__name__} has no {key!r}") from None
        return getattr(value, key)


def concatenated(parts: Sequence[Any]) -> str:
    """Return parts as one text: markup where one of them is."""
    if any(isinstance(part, Markup) for part in parts):
        return Markup("").join(parts)
    return "".join(map(str, parts))


class ExpressionParser:
    """Parses the text of one tag."""

    def __init__(self, text: str, filters: Mapping[str, ValueFilter]) -> None:
        self._tokens = [*_tokens(text), END]
        self._filters = filters

    @property
    def next(self) -> tuple[str, str]:
        """The next token: its sort, its text."""
        return self._tokens[0]

    def skip(self, *texts: str) -> str:
        """Skip the next token if it is one of these signs or words; return it, else ""."""
        return self.skip_any(texts)

    def skip_any(self, texts: Collection[str]) -> str:
        """Skip the next token if it is one of some signs or words; return it, else ""."""
        sort, text = self.next
        if sort not in ("sign", "name") or text not in texts:
            return ""
        return self._tokens.pop(0)[1]

    def expect(self, text: str) -> None:
        """Skip a sign or a word that has to come."""
        if not self.skip(text):
            raise TemplateError(f"expected {text}, found {self.next[1] or 'the end'}")

    def name(self) -> str:
        """Take a name."""
        sort, text = self._tokens.pop(0)
        if sort != "name":
            raise TemplateError(f"expected a name, found {text or 'the end'}")
        return text

    def names(self) -> list[str]:
        """Take names with commas between them."""
        found = [self.name()]
        while self.skip(","):
            found.append(self.name())
        return found

    def end(self) -> None:
        """Check that nothing follows."""
        if self.next != END:
            raise TemplateError(f"expected the end, found {self.next[1]}")

    def values(self) -> Expression:
        """Take an expression, or several with commas between them: a tuple."""
        first = self.expression()
        if not self.skip(","):
            return first
        rest = self._listed("")
        return lambda scope: (first(scope), *rest(scope))

    def expression(self) -> Expression:
        """Take ``a if condition else b``, or what binds closer; without ``else`` it may be ""."""
        value = self._either()
        if not self.skip("if"):
            return value
        condition = self._either()
        other = self.expression() if self.skip("else") else _constant("")
        return lambda scope: value(scope) if condition(scope) else other(scope)

    def condition(self) -> Expression:
        """Take an expression without ``if``."""
        return self._either()

    def arguments(self) -> Arguments:
        """Take the arguments of a call, up to its closing bracket."""
        plain: list[tuple[bool, Expression]] = []
        named: dict[str, Expression] = {}
        while not self.skip(")"):
            if self.skip("*"):
                plain.append((True, self.expression()))
            elif self.next[0] == "name" and self._tokens[1] == ("sign", "="):
                key = self.name()
                self.expect("=")
                named[key] = self.expression()
            else:
                plain.append((False, self.expression()))
            if not self.skip(","):
                self.expect(")")
                break

        def taken(scope: Scope) -> tuple[list[Any], dict[str, Any]]:
            values: list[Any] = []
            for is_several, each in plain:
                values += each(scope) if is_several else [each(scope)]
            return values, {key: each(scope) for key, each in named.items()}

        return taken

    def _either(self) -> Expression:
        left = self._both()
        while self.skip("or"):
            left = _or(left, self._both())
        return left

    def _both(self) -> Expression:
        left = self._negated()
        while self.skip("and"):
            left = _and(left, self._negated())
        return left

    def _negated(self) -> Expression:
        if self.skip("not"):
            value = self._negated()
            return lambda scope: not value(scope)
        return self._compared()

    def _compared(self) -> Expression:
        first = self._operated(SUMS, self._concatenated)
        pairs: list[tuple[Callable[[Any, Any], Any], Expression]] = []
        while sign := self._comparison():
            pairs.append((COMPARED[sign], self._operated(SUMS, self._concatenated)))
        if not pairs:
            return first

        def holds(scope: Scope) -> bool:
            left = first(scope)
            for compare, other in pairs:
                right = other(scope)
                if not compare(left, right):
                    return False
                left = right
            return True

        return holds

    def _comparison(self) -> str:
        if self.next == ("name", "not") and self._tokens[1] == ("name", "in"):
            del self._tokens[:2]
            return "not in"
        return self.skip_any(COMPARED)

    def _operated(
        self, signs: Mapping[str, Callable[[Any, Any], Any]], closer: Callable[[], Expression]
    ) -> Expression:
        left = closer()
        while sign := self.skip_any(signs):
            left = _applied(signs[sign], left, closer())
        return left

    def _concatenated(self) -> Expression:
        parts = [self._operated(PRODUCTS, self._signed)]
        while self.skip("~"):
            parts.append(self._operated(PRODUCTS, self._signed))
        if len(parts) == 1:
            return parts[0]
        return lambda scope: concatenated([part(scope) for part in parts])

    def _signed(self, *, with_filters: bool = True) -> Expression:
        if self.skip("-"):
            value = self._signed(with_filters=False)
            found: Expression = lambda scope: -value(scope)  # noqa: E731
        else:
            found = self._after(self._single())
        return self._filtered(found) if with_filters else found

    def _single(self) -> Expression:
        sort, text = self._tokens.pop(0)
        if sort == "number":
            return _constant(ast.literal_eval(text))
        if sort == "text":
            return _constant(ast.literal_eval(text))
        if sort == "name":
            if text.lower() in CONSTANTS:
                return _constant(CONSTANTS[text.lower()])
            if self.next == ("name", "is") and self._tokens[1] == ("name", "defined"):
                del self._tokens[:2]
                return lambda scope: text in scope
            return lambda scope: scope[text]
        if text == "(":
            return self._bracketed()
        if text == "[":
            return self._listed("]")
        if text == "{":
            return self._table()
        raise TemplateError(f"expected a value, found {text or 'the end'}")

    def _bracketed(self) -> Expression:
        if self.skip(")"):
            return lambda _: ()
        first = self.expression()
        if self.skip(")"):
            return first
        self.expect(",")
        rest = self._listed(")")
        return lambda scope: (first(scope), *rest(scope))

    def _listed(self, closing: str) -> Expression:
        """Take expressions with commas between them, up to a closing bracket, or to the end."""
        parts: list[Expression] = []
        while not (self.skip(closing) if closing else self.next == END):
            parts.append(self.expression())
            if not self.skip(","):
                if closing:
                    self.expect(closing)
                break
        return lambda scope: [part(scope) for part in parts]

    def _table(self) -> Expression:
        pairs: list[tuple[Expression, Expression]] = []
        while not self.skip("}"):
            key = self.expression()
            self.expect(":")
            pairs.append((key, self.expression()))
            if not self.skip(","):
                self.expect("}")
                break
        return lambda scope: {key(scope): value(scope) for key, value in pairs}

    def _after(self, value: Expression) -> Expression:
        """Take attributes, elements and calls behind a value."""
        while sign := self.skip(".", "[", "("):
            if sign == ".":
                value = _attribute_of(value, self.name())
            elif sign == "[":
                value = self._element_of(value)
            else:
                value = _called(value, self.arguments())
        return value

    def _element_of(self, value: Expression) -> Expression:
        start = None if self.next == ("sign", ":") else self.expression()
        if not self.skip(":"):
            self.expect("]")
            key = start or _constant(None)
            return lambda scope: element(value(scope), key(scope))
        stop = None if self.next == ("sign", "]") else self.expression()
        self.expect("]")

        def part(scope: Scope) -> Any:
            first = None if start is None else start(scope)
            return value(scope)[first : None if stop is None else stop(scope)]

        return part

    def _filtered(self, value: Expression) -> Expression:
        """Take filters and questions behind a value."""
        while sign := self.skip("|", "is"):
            if sign == "is":
                is_not = bool(self.skip("not"))
                value = _checked(value, CHECKS[self.name()], is_not=is_not)
                continue
            name = self.name()
            if name not in self._filters:
                raise TemplateError(f"no filter {name}")
            taken = self.arguments() if self.skip("(") else _no_arguments
            value = _through(self._filters[name], value, taken)
        return value


def _tokens(text: str) -> Iterator[tuple[str, str]]:
    place = 0
    text = text.rstrip()
    while place < len(text):
        found = TOKEN.match(text, place)
        if found is None:
            raise TemplateError(f"expected an expression, found {text[place:]!r}")
        place = found.end()
        yield str(found.lastgroup), found[str(found.lastgroup)]


def _constant(value: Any) -> Expression:
    return lambda _: value


def _or(left: Expression, right: Expression) -> Expression:
    return lambda scope: left(scope) or right(scope)


def _and(left: Expression, right: Expression) -> Expression:
    return lambda scope: left(scope) and right(scope)


def _applied(do: Callable[[Any, Any], Any], left: Expression, right: Expression) -> Expression:
    return lambda scope: do(left(scope), right(scope))


def _attribute_of(value: Expression, name: str) -> Expression:
    return lambda scope: attribute(value(scope), name)


def _called(function: Expression, taken: Arguments) -> Expression:
    def call(scope: Scope) -> Any:
        values, named = taken(scope)
        return function(scope)(*values, **named)

    return call


def _through(do: Callable[..., Any], value: Expression, taken: Arguments) -> Expression:
    def filtered(scope: Scope) -> Any:
        values, named = taken(scope)
        return do(value(scope), *values, **named)

    return filtered


def _checked(value: Expression, check: Callable[..., bool], *, is_not: bool) -> Expression:
    return lambda scope: check(value(scope)) != is_not


def _no_arguments(_: Scope) -> tuple[list[Any], dict[str, Any]]:
    return [], {}
