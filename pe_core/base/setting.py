"""Settings of a study: each is declared once, at its field in a dataclass.

The declaration has the allowed values (`rule`), the meaning (`text`) and the field in Blender's
panel (`panel`). Name, type and default are those of the dataclass field. Five things follow from
the declaration: the check when the dataclass is made (`check_settings`), the key of the study file
(`codec`), the property and its tooltip in Blender, loading a study into a scene, and the
table of keys in docs/settings.md.
"""

import functools
from collections.abc import Collection, Iterable
from dataclasses import MISSING, dataclass, field, fields
from typing import Annotated, Any, Protocol, TypeVar

from .errors import InputError, one_of, shown
from .values import A_NAME, Angle, Name, Number, choice, degrees_in_file, listed, pair, vector

T = TypeVar("T")
_KEY = "setting"
REQUIRED = MISSING


class ValueRule(Protocol):
    """A rule for values."""

    def checked(self, source: object, field: str, value: Any) -> Any:
        """Return the value as plain Python, or raise `InputError`."""


@dataclass(frozen=True, slots=True)
class Toggle:
    """True or False; numbers are not allowed."""

    def checked(self, source: object, field: str, value: Any) -> bool:
        """Return the value, or raise `InputError`."""
        if not isinstance(value, bool):
            raise InputError(source, field, "true or false", shown(value))
        return value


@dataclass(frozen=True, slots=True)
class OneOf:
    """One of several texts."""

    among: tuple[str, ...]

    def checked(self, source: object, field: str, value: Any) -> str:
        """Return the value, or raise `InputError`."""
        return choice(source, field, value, self.among)


@dataclass(frozen=True, slots=True)
class Pair:
    """Two numbers that meet one rule, the lower one first; `same`: they may be equal."""

    rule: Number
    same: bool = False

    def checked(self, source: object, field: str, value: Any) -> tuple[float, float]:
        """Return the value, or raise `InputError`."""
        return pair(source, field, value, self.rule, same=self.same)


@dataclass(frozen=True, slots=True)
class Triple:
    """Three numbers that meet one rule."""

    rule: Number

    def checked(self, source: object, field: str, value: Any) -> tuple[float, float, float]:
        """Return the value, or raise `InputError`."""
        first, second, third = vector(source, field, value, count=3, rule=self.rule)
        return first, second, third


@dataclass(frozen=True, slots=True)
class Each:
    """A list of numbers that meet one rule."""

    rule: Number
    most: int

    def checked(self, source: object, field: str, value: Any) -> tuple[float, ...]:
        """Return the value, or raise `InputError`."""
        items = listed(value, self.most)
        if not items or len(items) > self.most:
            raise InputError(source, field, f"1 to {self.most} {self.rule.noun}s", shown(value))
        return tuple(self.rule.checked(source, field, item) for item in items)


@dataclass(frozen=True, slots=True)
class Texts:
    """A list of texts that meet one rule."""

    rule: Name = A_NAME

    def checked(self, source: object, field: str, value: Any) -> tuple[str, ...]:
        """Return the value, or raise `InputError`."""
        if (items := listed(value)) is None:
            raise InputError(source, field, "a list of texts", shown(value))
        return tuple(self.rule.checked(source, field, item) for item in items)


@dataclass(frozen=True, slots=True)
class Several:
    """A list of some of several texts, each once."""

    among: Collection[str]

    def checked(self, source: object, field: str, value: Any) -> tuple[str, ...]:
        """Return the value, or raise `InputError`."""
        expected = f"some of {', '.join(self.among)}, each once"
        if (items := listed(value)) is None or any(items.count(item) > 1 for item in items):
            raise InputError(source, field, expected, shown(value))
        for item in items:
            if item not in self.among:
                raise InputError(source, field, one_of(self.among, item), shown(item))
        return tuple(items)


FLAG = Toggle()
NAMES = Texts()


@dataclass(frozen=True, slots=True)
class Panel:
    """A setting in Blender's panel.

    `property`: Name of the property in .blend files, which never changes; empty: that of the field.
    `default`: The panel's initial value, if it differs from that of a study file.
    `min, max, soft_max`: Limits of the field, if they differ from those of the rule.
    `zero`: Text of the field at 0, for a setting that may be absent (None) in a file.
    `none`: Value of the field for an absent number, as all below its least, if 0 is a value.
    `precision, step`: As in `bpy.props`.
    `menu`: Of a rule `OneOf`: how a menu shows each of its texts, in their order. The order never
        changes, and new ones go last: .blend files store numbers.
    `absent`: The menu's first entry, for an optional setting that is absent. Without it an optional
        setting with one possible text is a switch.
    `beside`: Word beside the field while it is 0.
    `when`: The field is drawn while this property is not 0 (``night``), or has this value
        (``targets=objects``) or another (``targets!=objects``).
    """

    property: str
    label: str
    default: Any = None
    min: float | None = None
    max: float | None = None
    soft_max: float | None = None
    zero: str = ""
    none: int = 0
    precision: int | None = None
    step: float | None = None
    menu: tuple[tuple[str, str], ...] = ()
    absent: tuple[str, str, str] | None = None
    beside: str = ""
    when: str = ""


@dataclass(frozen=True, slots=True)
class Setting:
    """The declaration of a setting.

    `name`: Name of the field.
    `default`: Default of the field; `REQUIRED` if a study must have the setting.
    `text`: Meaning of the setting, in one or two sentences without the last full stop.
    `panel`: None if the panel does not have the setting.
    `scored`: Whether a score depends on the setting. If so, a change makes the stored score out of
        date.
    """

    name: str
    default: Any
    rule: ValueRule
    text: str
    panel: Panel | None
    scored: bool

    @property
    def is_optional(self) -> bool:
        """Whether the setting may be absent (None)."""
        return self.default is None

    @property
    def tooltip(self) -> str:
        """The tooltip in Blender's panel."""
        zero = self.panel.zero if self.panel is not None else ""
        return f"{self.text}; 0: {zero}" if zero else self.text


def setting(
    default: T, rule: ValueRule, text: str, panel: Panel | None = None, *, scored: bool = False
) -> T:
    """Return the field of a dataclass that is a setting."""
    declared = {_KEY: (rule, text, panel, scored)}
    made: T = field(default=default, metadata=declared)
    return made


def required_setting(
    rule: ValueRule, text: str, panel: Panel | None = None, *, scored: bool = False
) -> Any:
    """Return the field of a dataclass that is a setting without a default."""
    return field(metadata={_KEY: (rule, text, panel, scored)})


def same_setting(cls: Any, name: str) -> Any:
    """Return a field that is the setting of another dataclass."""
    each = next(each for each in fields(cls) if each.name == name)
    return field(default=each.default, metadata=each.metadata)


def settings_of(cls: Any) -> dict[str, Setting]:
    """Return the settings that a dataclass declares, by name, in their order."""
    return _declared(cls)


@functools.cache
def _declared(cls: Any) -> dict[str, Setting]:
    return {
        each.name: Setting(each.name, each.default, *each.metadata[_KEY])
        for each in fields(cls)
        if _KEY in each.metadata
    }


def check_settings(instance: Any, source: str, prefix: str = "", names: Iterable[str] = ()) -> None:
    """Replace each setting of a frozen dataclass, or those of `names`, by its checked value. It is
    called from ``__post_init__``. `source`, and a `prefix` of the field's name, are for the message
    of the `InputError` when a value breaks its rule."""
    settings = settings_of(type(instance))
    for name in names or settings:
        value = getattr(instance, name)
        if value is not None or not settings[name].is_optional:
            checked = settings[name].rule.checked(source, prefix + name, value)
            object.__setattr__(instance, name, checked)


def key_of(name: str) -> str:
    """Return the key of a setting in its table: angles are in degrees there."""
    return name.replace("_rad", "_deg")


def value_in_file(rule: object, value: Any) -> Any:
    """Return a value of a rule as a file holds it: angles in degrees, lists for tuples."""
    if value is not None and (in_file := getattr(rule, "in_file", None)) is not None:
        return in_file(value)
    if isinstance(value, list | tuple):
        return [value_in_file(rule, each) for each in value]
    return degrees_in_file(value) if value is not None and is_angle(rule) else value


def is_angle(rule: object) -> bool:
    """Whether values of a rule are angles, which are in degrees in files."""
    return isinstance(rule.rule if isinstance(rule, Triple | Pair | Each) else rule, Angle)


@dataclass(frozen=True, slots=True)
class Part:
    """How a field stands in a document, where its name and type do not say it: metadata of its
    annotation, ``Annotated[str, Part(key="class")]``.

    `key`: Its key; empty: the field's name.
    `rule`: The rule of its value.
    `inline`: Whether its keys stand in the table of its class, without a table of its own.
    `by_name`: Whether a mapping of names is an array of tables, each with its `name`.
    `stored`: Whether a document has it.
    `at_times`: Whether the data of a result leave it out while it is None.
    `about`: Its meaning, in the schema of a result.
    `shape`: Fields with one text here stand for each other: where a table has one of them, it has
        none of a table that it changes.
    `changes`: Whether a table may have only what differs from another one.
    """

    key: str = ""
    rule: ValueRule | None = None
    inline: bool = False
    by_name: bool = False
    stored: bool = True
    at_times: bool = False
    about: str = ""
    shape: str = ""
    changes: bool = False


NotStored = Part(stored=False)
"""Of what a document, or the data of a result, does not have."""
AtTimes = Part(at_times=True)
"""Of what the data of a result have only at times."""
Named = Annotated[str, Part(rule=A_NAME)]
"""The name of what a table describes."""
