"""Limits: what is good enough, by figure. The dashboard, `pe check`, searches and fronts read them.

A limit that is kept holds in a search. What can be built, and what a rig sees, is then a
constraint: a placement beyond it is infeasible. A limit on what the search improves ends it when it
is reached.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, make_dataclass, replace
from typing import TYPE_CHECKING, Any, cast

from ..base.errors import InputError, shown
from ..base.setting import FLAG, check_settings, setting
from ..base.values import Number, Whole
from .figures import AP, ENTROPY, FIGURES, REQUIREMENTS

TABLE = "limits"
NUMBERED = frozenset({ENTROPY, AP})
"""Figures that a search does not keep as they are at its start: it improves them."""
LIMITED = tuple(key for key, row in FIGURES.items() if row.rule is not None or key == REQUIREMENTS)
"""Figures that may have a limit."""


@dataclass(frozen=True, slots=True)
class Limit:
    """How bad a figure may be, and whether a search keeps it. Without a value it may be as bad as
    at the start of the search; of requirements, all are to be met."""

    value: float | None = None
    kept: bool = True


@dataclass(frozen=True, slots=True)
class LimitRule:
    """A limit on a figure: its number, true (kept without one), or a table of both. `rule` is that
    of the number; None: there is none."""

    rule: Number | Whole | None
    needs_number: bool = False

    def checked(self, source: object, field: str, value: Any) -> Limit:
        """Return the limit, or raise `InputError`."""
        given = self._table(source, field, value)
        kept = FLAG.checked(source, f"{field}.kept", given.pop("kept", True))
        number = given.pop("value", None)
        for key in given:
            raise InputError(source, f"{field}.{key}", "value, kept", shown(key))
        if number is None:
            if self.needs_number or not kept:
                raise InputError(source, field, "a number", shown(value))
            return Limit()
        if self.rule is None:
            raise InputError(source, field, "true", shown(value))
        return Limit(self.rule.checked(source, field, number), kept)

    @staticmethod
    def _table(source: object, field: str, value: Any) -> dict[str, Any]:
        if isinstance(value, Limit):
            return {"value": value.value, "kept": value.kept}
        if isinstance(value, Mapping):
            return dict(value)
        if value is False:
            raise InputError(source, field, "a number, true, or a table { value, kept }", "false")
        return {} if value is True else {"value": value}

    @staticmethod
    def in_file(limit: Limit) -> Any:
        """Return a limit as a file holds it."""
        if limit.value is None:
            return True
        return limit.value if limit.kept else {"value": limit.value, "kept": False}

    def json_schema(self, schema_of_rule: Callable[[object], dict[str, Any]]) -> dict[str, Any]:
        """Return the schema of a limit: a number, true, or a table of both."""
        if self.rule is None:
            return {"const": True}
        number = schema_of_rule(self.rule)
        alone = [] if self.needs_number else [{"const": True}]
        table = {
            "type": "object",
            "properties": {"value": number, "kept": {"type": "boolean"}},
            "additionalProperties": False,
            "required": ["value"],
        }
        return {"anyOf": [number, *alone, table]}


class FigureLimits:
    """Limits by the names of `FIGURES`; None: no limit."""

    __slots__ = ()

    def __post_init__(self) -> None:
        check_settings(self, TABLE)

    def of(self, key: str) -> Limit | None:
        """Return the limit on a figure; None where there is none, or the figure can have none."""
        limit: Limit | None = getattr(self, key, None)
        return limit

    def value(self, key: str) -> float | None:
        """Return the number of a limit; None where there is none."""
        limit = self.of(key)
        return None if limit is None else limit.value

    def kept(self, key: str) -> Limit | None:
        """Return the limit on a figure if a search keeps it."""
        limit = self.of(key)
        return limit if limit is not None and limit.kept else None

    def kept_value(self, key: str) -> float | None:
        """Return the number of a limit that a search keeps."""
        limit = self.kept(key)
        return None if limit is None else limit.value

    @property
    def keeps_requirements(self) -> bool:
        """Whether placements that meet all requirements are better than all that do not."""
        return self.of(REQUIREMENTS) is not None

    def changed(self, **limits: Any) -> "Limits":
        """Return these limits with others for some figures; None for no limit."""
        found: Any = replace(self, **limits)  # type: ignore[type-var]  # a dataclass, below
        return cast(Limits, found)

    def __iter__(self) -> Iterator[tuple[str, Limit]]:
        """Yield the limits by name, in the order of `FIGURES`."""
        for key in LIMITED:
            if (limit := self.of(key)) is not None:
                yield key, limit


def _field(key: str) -> tuple[str, Any, Any]:
    row = FIGURES[key]
    about = f"{row.about}: at {'least' if row.higher else 'most'}"
    return key, Limit | None, setting(None, LimitRule(row.rule, key in NUMBERED), about)


if TYPE_CHECKING:

    class Limits(FigureLimits):
        """Limits by the names of `FIGURES`."""

        def __init__(self, **limits: Any) -> None: ...

else:
    Limits = make_dataclass(
        "Limits",
        map(_field, LIMITED),
        bases=(FigureLimits,),
        namespace={"__module__": __name__, "__doc__": FigureLimits.__doc__},
        frozen=True,
        slots=True,
    )
