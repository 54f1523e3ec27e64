"""Plain data of dataclasses and back: one walk reads, writes and lists settings.

`json_schema` makes the schema from the same declarations. A class needs no code for it. Each field
is a key of the table, with the field's name (angles in degrees: ``reach_rad`` is the key
``reach_deg``); what differs is declared with `Part`. Values are checked by the rule of a setting or
a part, or by the type. What has its default is left out. An error names the key by its path:
``requirement[2].zone.step``.

A type whose data no walk can know, such as a model that is a name of the catalogue, has a `Hook`.

Results are not read by users' hands: `record` writes all of their fields, `read_record` reads them.
"""

import functools
import math
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import MISSING, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self, TypeVar

from .errors import InputError, naming_table, one_of, shown
from .setting import (
    FLAG,
    NAMES,
    REQUIRED,
    Each,
    Pair,
    Part,
    Setting,
    Triple,
    ValueRule,
    is_angle,
    key_of,
    settings_of,
    value_in_file,
)
from .values import A_NAME, A_TEXT, ANY, Whole, choice, listed

T = TypeVar("T")
Schema = dict[str, Any]
ROOM = Path()
"""Folder of a document that is in no file."""
BY_TYPE: Mapping[Any, ValueRule] = {bool: FLAG, int: Whole(), float: ANY, str: A_TEXT}
"""Rules of values without a declared one."""


@dataclass(frozen=True, slots=True)
class Node:
    """A value of a document, and where it is.

    `source`: Name of the document, for messages.
    `path`: Key of the value in the document; empty for all of it.
    `folder`: Folder to which names of files are relative.
    `owner`: Name of the table, or of the table round it, that has one.
    """

    value: Any
    source: str
    path: str = ""
    folder: Path = ROOM
    owner: str = ""

    def error(self, expected: str, found: object, key: str = "") -> InputError:
        """Return an `InputError` about the value, or about a key of it."""
        return InputError(self.source, ".".join(filter(None, (self.path, key))), expected, found)

    def at(self, key: str, default: Any = None) -> Self:
        """Return the value of a key of this table."""
        return self.with_value(self.table.get(key, default), self.field(key))

    def field(self, key: str) -> str:
        """Return the path of a key of this table."""
        return f"{self.path}.{key}" if self.path else key

    def with_value(self, value: Any, path: str) -> Self:
        """Return a value below this one."""
        name = self.value.get("name") if isinstance(self.value, Mapping) else None
        owner = name if isinstance(name, str) else self.owner
        return type(self)(value, self.source, path, self.folder, owner=owner)

    @property
    def table(self) -> Mapping[str, Any]:
        """The value as a table; `InputError` where it is none."""
        if not isinstance(self.value, Mapping):
            path = self.path or "document"
            raise InputError(self.source, path, "a table", type(self.value).__name__)
        return self.value

    @property
    def items(self) -> list[Self]:
        """The elements of a list; `InputError` where it is none."""
        if not isinstance(self.value, list | tuple):
            raise self.error(f"an array [[{self.path}]]", shown(self.value))
        return [self.with_value(each, f"{self.path}[{k}]") for k, each in enumerate(self.value)]

    def naming(self) -> AbstractContextManager[None]:
        """Name this table in errors about what is made of it; errors about the document stay."""
        tables = self.value if isinstance(self.value, Mapping) else ()
        return naming_table(self.source, self.path, tables, key_of)


@dataclass(frozen=True, slots=True)
class Hook:
    """How values of a type are read and written, which no walk can know.

    `read`: The value of a node; `InputError` where it is none.
    `write`: Its plain data.
    `form`: The dataclass of its table, or the JSON schema of its data.
    """

    read: Callable[[Node], Any]
    write: Callable[[Any], Any]
    form: type | Schema


class Declared(NamedTuple):
    """A setting in a tree of dataclasses.

    `key` is its path, `cls` the class that declares it, `held_as` the field that holds an instance
    of the class. It is of `rows` if a document may have several of it.
    """

    key: str
    setting: Setting
    cls: type
    held_as: str
    rows: bool


class DocumentField(NamedTuple):
    """A field of a dataclass as a document has it."""

    name: str
    key: str
    hint: Any
    default: Any
    part: Part
    setting: Setting | None

    @property
    def rule(self) -> ValueRule | None:
        """The declared rule of its value."""
        return self.part.rule if self.setting is None else self.setting.rule

    @property
    def is_optional(self) -> bool:
        """Whether the field may be None."""
        return type(None) in typing.get_args(self.hint)

    @property
    def is_table(self) -> bool:
        """Whether its value is a table with the keys of a class."""
        return self.rule is None and is_dataclass(self.hint) and hook_of(self.hint) is None


HOOKS: dict[type, Hook] = {}
"""By type, for its subclasses, too."""


def hook(
    cls: type, read: Callable[[Node], Any], write: Callable[[Any], Any], form: type | Schema
) -> None:
    """Register how values of a type are read and written."""
    HOOKS[cls] = Hook(read, write, form)


def read(cls: type[T], node: Node) -> T:
    """Return an instance of a class from plain data. `InputError` with the path of the key."""
    made: T = read_value(cls, node)
    return made


def read_fields(cls: type[T], node: Node, base: Any = None) -> T:
    """Return an instance from its table without the hook of its class; keys that are absent are
    those of `base`."""
    known = _keys(cls)  # type: ignore[arg-type]  # a class can be hashed
    for key in node.table:
        if known is not None and key not in known:
            raise node.error(one_of(sorted(known), key), "an unknown key", key)
    return _made(cls, node, base)


def write(value: Any) -> Any:
    """Return the plain data from which `read` makes an equal value."""
    own = hook_of(type(value))
    if own is not None:
        return own.write(value)
    if is_dataclass(value):
        return write_fields(value)
    if isinstance(value, Mapping):
        return {key: write(each) for key, each in value.items()}
    return [write(each) for each in value] if isinstance(value, list | tuple) else value


def write_fields(instance: Any, base: Any = None) -> dict[str, Any]:
    """Return the table of an instance without the hook of its class; without defaults, or without
    what it shares with `base`, down to the tables in it."""
    data: dict[str, Any] = {}
    own = fields_of(type(instance))  # type: ignore[arg-type]
    changed = [e for e in own if base and getattr(instance, e.name) != getattr(base, e.name)]
    shapes = _shapes(changed)
    for each in own:
        value = getattr(instance, each.name)
        shared = base and each.part.shape not in shapes
        default = getattr(base, each.name) if shared else each.default
        if each.part.inline:
            data |= write(value)
        elif value is not None and (default is REQUIRED or value != default):
            merged = shared and each.is_table
            data[each.key] = write_fields(value, default) if merged else _written(each, value)
    return data


def read_changed(cls: type[T], node: Node, presets: Mapping[str, T]) -> T:
    """Return an instance from its table, where `preset` may name a shipped one that the other keys
    change."""
    preset = node.at("preset")
    if preset.value is None:
        return read_fields(cls, node)
    name = choice(preset.source, preset.path, preset.value, presets)
    return read_fields(cls, node, presets[name])


def write_changed(instance: Any, presets: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table that `read_changed` reads: of a shipped one, what was changed."""
    base = presets.get(instance.preset)
    if base is None:
        return write_fields(instance)
    changed = write_fields(instance, base)
    named = {"name": changed["name"]} if "name" in changed else {}
    return named | {"preset": instance.preset} | changed


class Recorded:
    """Base of results: their plain data, and back. `derived` names properties that the data have
    beside the fields."""

    __slots__ = ()
    derived: ClassVar[tuple[str, ...]] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        data: dict[str, Any] = record(self)
        return data

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Return it from the data of `to_dict`."""
        found: Self = read_record(cls, data)
        return found


def record(result: Any) -> Any:
    """Return a result as plain data: all fields of dataclasses and named tuples, also None; without
    those that are `AtTimes`, while they are None."""
    if hasattr(result, "_asdict"):
        return {key: record(value) for key, value in result._asdict().items()}
    if is_dataclass(result):
        data: dict[str, Any] = {}
        for each in fields_of(type(result)):  # type: ignore[arg-type]
            value = getattr(result, each.name)
            if each.part.inline:
                data |= record(value)
            elif value is not None or not each.part.at_times:
                data[each.key] = record(value)
        derived: tuple[str, ...] = result.derived if isinstance(result, Recorded) else ()
        return data | {name: record(getattr(result, name)) for name in derived}
    if isinstance(result, Mapping):
        return {str(key): record(value) for key, value in result.items()}
    return [record(each) for each in result] if isinstance(result, list | tuple) else result


def read_record(hint: Any, data: Any) -> Any:
    """Return the result of a type from the plain data of `record`."""
    if data is None or hint is Any:
        return data
    if is_dataclass(hint):
        cls = typing.cast(Any, hint)
        known = [each for each in fields_of(cls) if each.key in data]
        return cls(**{each.name: read_record(each.hint, data[each.key]) for each in known})
    origin = typing.get_origin(hint)
    inner = typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        (hint,) = (each for each in inner if each is not type(None))
        return read_record(hint, data)
    if origin is None:
        return data
    if issubclass(origin, Mapping):
        return {inner[0](key): read_record(inner[1], each) for key, each in data.items()}
    hints = [inner[0]] * len(data) if len(inner) == 1 or inner[-1] is Ellipsis else inner
    rows = (read_record(each, value) for each, value in zip(hints, data, strict=True))
    return list(rows) if issubclass(origin, list) else tuple(rows)


def declared(
    cls: type, path: str = "", held_as: str = "", *, rows: bool = False
) -> Iterator[Declared]:
    """Yield the settings of a tree of dataclasses, in the order of a document."""
    for each in fields_of(cls):
        names = () if each.part.by_name else ("NAME",) * str(each.hint).count("Mapping[")
        own = () if each.part.inline else (each.key,)
        key = ".".join(filter(None, (path, *own, *names)))
        if each.setting is not None:
            yield Declared(key, each.setting, cls, held_as, rows=rows)
        for inner, is_several in () if each.rule is not None else classes_in(each.hint):
            several = rows or is_several
            yield from declared(inner, key, each.name, rows=several)


@functools.cache
def fields_of(cls: Any) -> tuple[DocumentField, ...]:
    hints = typing.get_type_hints(cls, include_extras=True)
    settings = settings_of(cls)
    found = []
    for each in fields(cls):
        hint = hints[each.name]
        own = Part()
        if typing.get_origin(hint) is typing.Annotated:
            hint, own = typing.get_args(hint)
        made = each.default_factory is not MISSING
        default: Any = each.default_factory() if made else each.default  # type: ignore[operator]
        key = own.key or key_of(each.name)
        if own.stored:
            found.append(
                DocumentField(
                    name=each.name,
                    key=key,
                    hint=hint,
                    default=default,
                    part=own,
                    setting=settings.get(each.name),
                )
            )
    return tuple(found)


@functools.cache
def _keys(cls: Any) -> frozenset[str] | None:
    """Return the keys of a class's table; None where a mapping takes all others."""
    known = set[str]()
    for each in fields_of(cls):
        if not each.part.inline:
            known.add(each.key)
            continue
        inner = _keys(each.hint) if is_dataclass(each.hint) else None  # type: ignore[arg-type]
        if inner is None:
            return None
        known |= inner
    return frozenset(known)


def _made(cls: Any, node: Node, base: Any = None) -> Any:
    values: dict[str, Any] = {}
    own_keys = {each.key for each in fields_of(cls)}
    shapes = _shapes(each for each in fields_of(cls) if each.key in node.table)
    for each in fields_of(cls):
        shared = base is not None and each.part.shape not in shapes
        given = getattr(base, each.name) if shared else MISSING
        if each.part.inline and is_dataclass(each.hint):
            values[each.name] = _made(each.hint, node, None if given is MISSING else given)
        elif each.part.inline:
            rest = {key: value for key, value in node.table.items() if key not in own_keys}
            values[each.name] = read_value(each.hint, node.with_value(rest, node.path))
        elif each.key in node.table and given is not MISSING and each.is_table:
            values[each.name] = read_fields(each.hint, node.at(each.key), given)
        elif each.key in node.table:
            values[each.name] = _value(each, node.at(each.key))
        elif given is not MISSING:
            values[each.name] = given
        elif each.default is REQUIRED and each.is_table:
            values[each.name] = read_value(each.hint, node.at(each.key, {}))
        elif each.default is REQUIRED:
            raise node.error("a value", "nothing", each.key)
    with node.naming():
        return cls(**values)


def _shapes(some: Iterable[DocumentField]) -> set[str]:
    """Return the shapes that some fields are of."""
    return {each.part.shape for each in some if each.part.shape}


def _value(each: DocumentField, node: Node) -> Any:
    if each.is_optional and node.value is None:
        return None
    if each.rule is not None:
        return _by_rule(each.rule, node)
    if not each.part.by_name:
        return read_value(each.hint, node)
    inner = typing.get_args(each.hint)[1]
    found = dict[str, Any]()
    for row in node.items:
        name = A_NAME.checked(row.source, f"{row.path}.name", row.table.get("name"))
        if name in found:
            raise row.error("each name once", f"{name!r} twice", "name")
        rest = {key: value for key, value in row.table.items() if key != "name"}
        found[name] = read_value(inner, Node(rest, row.source, row.path, row.folder, owner=name))
    return found


def read_value(hint: Any, node: Node) -> Any:
    """Return the value of an annotation."""
    own = hook_of(hint)
    if own is not None:
        return own.read(node)
    if hint in BY_TYPE:
        return BY_TYPE[hint].checked(node.source, node.path, node.value)
    if is_dataclass(hint):
        return read_fields(typing.cast(type, hint), node)
    if hasattr(hint, "_fields"):
        return _named_tuple(hint, node)
    origin = typing.get_origin(hint)
    inner = typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        return read_value(_nearest(inner, node), node)
    if issubclass(origin, Mapping):
        names = [A_NAME.checked(node.source, node.path, name) for name in node.table]
        return {name: read_value(inner[1], node.at(name)) for name in names}
    if len(inner) == 1 or inner[-1] is Ellipsis:
        if inner[0] is str:
            return NAMES.checked(node.source, node.path, node.value)
        return tuple(read_value(inner[0], each) for each in node.items)
    values = listed(node.value, len(inner))
    if values is None or len(values) != len(inner):
        raise node.error(f"a list of {len(inner)} values", shown(node.value))
    rows = node.with_value(values, node.path).items
    return tuple(read_value(each, row) for each, row in zip(inner, rows, strict=True))


def _named_tuple(hint: Any, node: Node) -> Any:
    """Return a named tuple from a list of its values, which have their rules or types."""
    hints = _hints(hint)
    values = listed(node.value, len(hints))
    if values is None or len(values) != len(hints):
        raise node.error(f"a list of {', '.join(hint._fields)}", shown(node.value))
    rows = node.with_value(values, node.path).items
    fields_read = [
        read_value(of_field, row) if rule is None else _by_rule(rule, row)
        for (of_field, rule), row in zip(hints, rows, strict=True)
    ]
    return hint(*fields_read)


@functools.cache
def _hints(named_tuple: Any) -> tuple[tuple[Any, ValueRule | None], ...]:
    """Return the type of each field of a named tuple, and its rule, if it has one."""
    found = []
    for hint in typing.get_type_hints(named_tuple, include_extras=True).values():
        part = typing.get_args(hint)[1] if typing.get_origin(hint) is typing.Annotated else Part()
        found.append((hint, part.rule))
    return tuple(found)


def _nearest(hints: Sequence[Any], node: Node) -> Any:
    """Return which of several classes has the most keys of a table, the first of equal ones."""
    some = [each for each in hints if each is not type(None)]
    if len(some) == 1:
        return some[0]
    given = set(node.table)
    return max(some, key=lambda cls: len(given & (_keys(cls) or given)))


def _by_rule(rule: ValueRule, node: Node) -> Any:
    """Return a value that meets a rule; degrees become radians."""
    source = node.source
    path = node.path
    value = node.value
    several = isinstance(rule, Triple | Pair | Each)
    items = listed(value) if several else None
    if not is_angle(rule) or (items is None and several):
        return rule.checked(source, path, value)
    if items is None:
        return rule.checked(source, path, math.radians(ANY.checked(source, path, value)))
    radians = [math.radians(ANY.checked(source, path, item)) for item in items]
    return rule.checked(source, path, radians)


def _written(each: DocumentField, value: Any) -> Any:
    if each.rule is not None:
        return value_in_file(each.rule, value)
    if each.part.by_name:
        return [{"name": name, **write(own)} for name, own in value.items()]
    return write(value)


def hook_of(cls: Any) -> Hook | None:
    bases = cls.__mro__ if isinstance(cls, type) else ()
    return next((HOOKS[base] for base in bases if base in HOOKS), None)


def classes_in(hint: Any) -> Iterator[tuple[type, bool]]:
    """Yield the dataclasses in an annotation, and whether there may be several of each."""
    own = hook_of(hint)
    if own is not None or is_dataclass(hint):
        form = hint if own is None else own.form
        yield from ((form, False),) if isinstance(form, type) else ()
        return
    several = typing.get_origin(hint) not in (types.UnionType, typing.Union)
    for inner in typing.get_args(hint):
        yield from ((cls, several or more) for cls, more in classes_in(inner))
