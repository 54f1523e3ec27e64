"""What consoles and notebooks show of a value: one short line, a table, a pandas data frame."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from html import escape
from typing import Any

import numpy as np

from .plugins import required_package

MAX_LINE = 160  # Characters of a value in a console
LONG = 60  # Characters of a value inside another
FEW = 4  # Names or items that are shown of many


def _line(instance: Any) -> str:
    """Return a dataclass in one line: its type, and what differs from nothing, each cut short."""
    parts = (
        f"{each.name}={_short(value)}"
        for each in fields(instance)
        if each.repr
        and each.name[0] != "_"
        and not _is_empty(value := getattr(instance, each.name))
    )
    text = ", ".join(parts)
    text = text if len(text) <= MAX_LINE else f"{text[: MAX_LINE - 3]}..."
    return f"{type(instance).__name__}({text})"


def _is_empty(value: Any) -> bool:
    return value is None or (isinstance(value, (str, Sequence, Mapping)) and not len(value))


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"<{' x '.join(map(str, value.shape))} {value.dtype}>"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return f"{{{_some(map(str, value), len(value))}}}"
    if isinstance(value, (list, tuple)):
        return f"({_some(map(_short, value), len(value))})"
    if is_dataclass(value) and (isinstance(value, ShortRepr) or len(repr(value)) > LONG):
        name = getattr(value, "name", None) or getattr(value, "model", None)
        return f"<{name if isinstance(name, str) else type(value).__name__}>"
    text = repr(value)
    return text if len(text) <= LONG else f"<{type(value).__name__}>"


def _some(texts: Any, count: int) -> str:
    few = [text for text, _ in zip(texts, range(FEW), strict=False)]
    return ", ".join(few) + (f", {count - FEW} more" if count > FEW else "")


class ShortRepr:
    """Base of dataclasses whose `repr` is one short line, whatever they hold."""

    __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__repr__" not in vars(cls):
            cls.__repr__ = _line  # type: ignore[method-assign]  # or `dataclass` makes a long one


class Tabular(ShortRepr):
    """Base of what is also a table: rows of plain values by column, and what they are of."""

    __slots__ = ()

    def _caption(self) -> str:
        """Return what the table is of, in one line."""
        return type(self).__name__

    def _rows(self) -> list[dict[str, Any]]:
        """Return the rows, which may leave columns out."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        """Return the table as HTML: notebooks call this."""
        rows = self._rows()
        heads = list(dict.fromkeys(key for row in rows for key in row))
        lines = ["".join(f"<th>{escape(head)}</th>" for head in heads)]
        lines += ["".join(f"<td>{_cell(row.get(key))}</td>" for key in heads) for row in rows]
        body = "".join(f"<tr>{line}</tr>" for line in lines)
        return f"<p>{escape(self._caption())}</p><table>{body}</table>"

    def to_pandas(self) -> Any:
        """Return the table as a `pandas.DataFrame`, a row a part, units in the names of columns.
        `InputError` when pandas is not installed: the extra ``notebook`` brings it."""
        return required_package("pandas").DataFrame(self._rows())


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.4f}"
    return escape(f"{value:,}" if type(value) is int else "" if value is None else str(value))
