"""A limit on a figure, and the limits on several."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Self

from ..base.errors import InputError, shown
from ..base.setting import FLAG, check_settings
from ..base.values import Number, Whole
from .figure import REQUIREMENTS

TABLE = "limits"


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


@dataclass(frozen=True, slots=True)
class FigureLimits:
    """Limits by the names of `FIGURES`; None: no limit. `Limits` has the fields."""

    def __post_init__(self) -> None:
        check_settings(self, TABLE)

    def limit_on(self, key: str) -> Limit | None:
        """Return the limit on a figure; None where there is none, or the figure can have none."""
        limit: Limit | None = getattr(self, key, None)
        return limit

    def value(self, key: str) -> float | None:
        """Return the number of a limit; None where there is none."""
        limit = self.limit_on(key)
        return None if limit is None else limit.value

    def kept(self, key: str) -> Limit | None:
        """Return the limit on a figure if a search keeps it."""
        limit = self.limit_on(key)
        return limit if limit is not None and limit.kept else None

    def kept_value(self, key: str) -> float | None:
        """Return the number of a limit that a search keeps."""
        limit = self.kept(key)
        return None if limit is None else limit.value

    @property
    def with_number(self) -> tuple[str, ...]:
        """The figures whose limit has a number, in the order of `FIGURES`."""
        return tuple(key for key, limit in self if limit.value is not None)

    @property
    def keeps_requirements(self) -> bool:
        """Whether placements that meet all requirements are better than all that do not."""
        return self.limit_on(REQUIREMENTS) is not None

    def changed(self, **limits: Any) -> Self:
        """Return these limits with others for some figures; None for no limit."""
        return replace(self, **limits)

    def __iter__(self) -> Iterator[tuple[str, Limit]]:
        """Yield the limits by name, in the order of `FIGURES`."""
        for each in fields(self):
            if (limit := self.limit_on(each.name)) is not None:
                yield each.name, limit
