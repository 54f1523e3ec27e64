"""A sensor's element of Gazebo's (SDF), asked for its numbers by where they stand in it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from ..text.values import Number, Whole
from .figures import figure, figures, whole_figure


@dataclass(frozen=True, slots=True)
class SensorElement:
    """A <sensor>, or that there is none.

    What does not stand in it is None. What stands there and is no number of its rule is refused:
    the file meant something else than that it were not there.
    """

    path: Path
    name: str
    element: Element | None

    def number(self, key: str, rule: Number) -> float | None:
        """Return the number of an element, None where that is missing, or raise `InputError`."""
        text = self._text(key)
        return None if text is None else figure(self.path, self._field(key), text, rule)

    def whole(self, key: str, rule: Whole) -> int | None:
        """Return a whole number likewise."""
        text = self._text(key)
        return None if text is None else whole_figure(self.path, self._field(key), text, rule)

    def pair(self, key: str, rule: Number) -> list[float] | None:
        """Return two numbers in one element likewise."""
        text = self._text(key)
        return None if text is None else figures(self.path, self._field(key), text, (2,), rule)

    def numbers(self, keys: tuple[str, ...], rule: Number) -> list[float] | None:
        """Return numbers of one rule; None unless all are there."""
        found = [self.number(key, rule) for key in keys]
        return None if None in found else [value for value in found if value is not None]

    def _text(self, key: str) -> str | None:
        return None if self.element is None else self.element.findtext(f".//{key}")

    def _field(self, key: str) -> str:
        return f"sensor of {self.name}, {key}"
