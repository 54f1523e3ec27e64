"""JSON as protobuf writes and reads it: a message's data under the names of its schema.

Protobuf's own printer writes ``sensorId`` for the field ``sensor_id`` (unless told to keep the
names), whole numbers of 64 bits as text, and takes numbers as text wherever one may stand.
"""

from __future__ import annotations

import re
from typing import Any

from ..errors import InputError
from ..text.tables import Table
from ..text.values import Number, Whole
from .figures import figure, whole_figure

CAPITAL = re.compile(r"(?<=[a-z0-9])([A-Z])")


class Message(Table):
    """A message: a table under the schema's names, ``like_this``; null is an absent field.

    Numbers may stand as text. Names are changed level by level, as messages are asked for.

    Raises
    ------
    InputError
        When it is no table, or a field comes under both of its names.
    """

    def __init__(self, data: Any, source: str, path: str = "") -> None:
        super().__init__(_as_in_schema(source, path, data), source, path)

    def figure(self, key: str, rule: Number) -> float | None:
        """Return a number of a rule, None where the field is absent, or raise `InputError`."""
        value = self.raw(key, None)
        return None if value is None else figure(self.source, self.field(key), value, rule)

    def whole_figure(self, key: str, rule: Whole) -> int | None:
        """Return a whole number likewise."""
        value = self.raw(key, None)
        return None if value is None else whole_figure(self.source, self.field(key), value, rule)

    def message(self, key: str) -> Message:
        """Return a message inside this one; an empty one when it is absent."""
        return Message(self.raw(key, {}), self.source, self.field(key))

    def messages(self, key: str) -> list[Message]:
        """Return a repeated message; empty when it is absent."""
        rows = self.raw(key, [])
        if not isinstance(rows, list):
            raise self.error(key, "a list", type(rows).__name__)
        return [Message(row, self.source, f"{self.field(key)}[{k}]") for k, row in enumerate(rows)]


def _as_in_schema(source: str, path: str, data: Any) -> Any:
    """Return a message's fields under their names in the schema, those that are set."""
    if not isinstance(data, dict):
        return data
    found: dict[str, Any] = {}
    for key, value in data.items():
        name = CAPITAL.sub(r"_\1", key).lower()
        if name in found:
            field = f"{path}.{name}" if path else name
            raise InputError(source, field, "a field once", "it twice, in both ways of writing")
        if value is not None:
            found[name] = value
    return found
