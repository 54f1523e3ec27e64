"""The one place where a value from outside is checked: its type, its range, and the line that
refuses it.

A rule (`Number`, `Whole`, `Angle`, `Name`) says what a value may be; ``rule.checked(source, field,
value)`` returns the value as plain Python, or raises `InputError`. NumPy's scalars are numbers,
True and False are none, and NaN never is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from .degrees import as_in_file

LONGEST_NAME = 255
"""Characters in a name: what file systems and Blender allow, too."""
LONGEST_PATH = 4096
"""Characters in the name of a file with its folders; Linux opens none that is longer."""
COUNT_WORDS = {2: "two", 3: "three"}


@dataclass(frozen=True, slots=True)
class Number:
    """A real number in a range.

    Parameters
    ----------
    least, most : float
        The range; both ends belong to it.
    above, below : bool
        Whether `least` (`most`) itself is left out.
    cap : float
        A size beyond which numbers make no sense, to keep arithmetic safe; told only to whom it
        concerns.
    unit : str
        Of the value, for the message.
    noun : str
        What the value is called.
    infinite : bool
        Whether infinity is a number, too, beyond the cap.
    """

    least: float = -math.inf
    most: float = math.inf
    above: bool = False
    below: bool = False
    cap: float = math.inf
    unit: str = ""
    noun: str = "number"
    infinite: bool = False

    def checked(self, source: object, field: str, value: Any) -> float:
        """Return the value as a float, or raise `InputError`."""
        number = value if type(value) is float else real(value)
        if not self.holds(number):
            raise InputError(source, field, self.words(number), shown(value))
        return number

    def holds(self, number: float) -> bool:
        """Whether a float is in the range; NaN never is."""
        low = self.least < number if self.above else self.least <= number
        high = number < self.most if self.below else number <= self.most
        if not (low and high):
            return False
        return self.infinite if math.isinf(number) else abs(number) <= self.cap

    def words(self, number: float = math.nan, count: int = 1) -> str:
        """What is expected, said to one who gave `number`; in the plural for more than one."""
        plain = not self.infinite and (self._is_plain or count > 1)
        noun = f"finite {self.noun}" if plain else self.noun
        if count == 1:
            noun = f"an {noun}" if noun[0] in "aeiou" else f"a {noun}"
        else:
            noun = f"{COUNT_WORDS.get(count, count)} {noun}s"
        if self.cap < abs(number) < math.inf:
            return f"{noun} within +-{self.cap:.12g}{self._unit}"
        return f"{noun}{self._range}"

    @property
    def _is_plain(self) -> bool:
        return not (math.isfinite(self.least) or math.isfinite(self.most))

    @property
    def _unit(self) -> str:
        return f" {self.unit}" if self.unit else ""

    @property
    def _range(self) -> str:
        """The range in words, with a blank in front."""
        low, high = f"{self.least:.12g}", f"{self.most:.12g}"
        if self._is_plain:
            return ""
        if self.least == -self.most:
            return f" within +-{high}{self._unit}"
        start = f"above {low}" if self.above else f">= {low}"
        end = f"below {high}" if self.below else f"<= {high}"
        if math.isinf(self.least) or math.isinf(self.most):
            return f" {end if math.isinf(self.least) else start}{self._unit}"
        both = f"{start} and {end}" if self.above or self.below else f"from {low} to {high}"
        return f" {both}{self._unit}"


@dataclass(frozen=True, slots=True)
class Angle(Number):
    """An angle: its range in degrees, the value in radians, as a file's degrees give it back."""

    unit: str = "degrees"
    noun: str = "angle"

    def checked(self, source: object, field: str, value: Any) -> float:
        """Return the value [rad], or raise `InputError`."""
        number = value if type(value) is float else real(value)
        if not self.holds(math.degrees(number)):
            told = f"{math.degrees(number):g} degrees" if math.isfinite(number) else shown(value)
            raise InputError(source, field, self.words(math.degrees(number)), told)
        return as_in_file(number)


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number in a range; 1800.0 is one, 180.7 and True are none."""

    least: int = 0
    most: int | None = None
    unit: str = ""

    def checked(self, source: object, field: str, value: Any) -> int:
        """Return the value as an int, or raise `InputError`."""
        number = _whole(value)
        if number is None or number < self.least:
            raise InputError(source, field, f"{self._noun} >= {self.least}", shown(value))
        if self.most is not None and number > self.most:
            expected = f"{self._noun} from {self.least} to {self.most}"
            raise InputError(source, field, expected, shown(value))
        return number

    @property
    def _noun(self) -> str:
        return f"a whole number of {self.unit}" if self.unit else "a whole number"


@dataclass(frozen=True, slots=True)
class Name:
    """A text that names something: printable, on one line, not blank and not endless."""

    expected: str = "a name in printable letters"
    longest: int = LONGEST_NAME

    def checked(self, source: object, field: str, value: Any) -> str:
        """Return the value as a plain str, or raise `InputError`."""
        if not isinstance(value, str) or len(value) > self.longest:
            long = f"; {len(value):,} characters" if isinstance(value, str) else ""
            most = f" ({self.longest} at most)" if long else ""
            raise InputError(source, field, f"{self.expected}{most}", f"{_start(value)}{long}")
        if not value.strip() or not value.isprintable():
            raise InputError(source, field, self.expected, shown(value))
        return str(value)


FINITE = Number()
ANY = Number(infinite=True)
LENGTH = Number(0.0, above=True, cap=1e9, unit="m", noun="length")
"""A size of something."""
SHARE = Number(0.0, 1.0)
WEIGHT = Number(0.0, cap=1e9)
A_NAME = Name()
A_TEXT = Name("a text", LONGEST_PATH)
A_PATH = Name("the name of a file", LONGEST_PATH)


def real(value: Any) -> float:
    """Return a value as a float; NaN for what is no number, or a whole one beyond a float."""
    number: Any = plain(value)
    if isinstance(number, bool) or not isinstance(number, Real):
        return math.nan
    try:
        return float(number)
    except OverflowError:
        return math.nan


def plain(value: Any) -> Any:
    """Return a NumPy scalar as Python's own; anything else as it is."""
    return value.item() if getattr(value, "ndim", None) == 0 and hasattr(value, "item") else value


def vector(
    source: object,
    field: str,
    values: Any,
    count: int,
    rule: Number = FINITE,
    more: str = "",
) -> tuple[float, ...]:
    """Return `count` numbers of one rule, or raise `InputError` about all of them.

    `more` is added to the words for what is expected.
    """
    found, worst = listed(values, count), math.nan
    if found is not None and len(found) == count:
        try:
            return tuple(rule.checked(source, field, v) for v in found)
        except InputError:  # one bad number is told with the others
            worst = max((abs(real(v)) for v in found), key=lambda v: v if v == v else math.inf)
    raise InputError(source, field, rule.words(worst, count) + more, shown(values))


def pair(
    source: object,
    field: str,
    values: Any,
    rule: Number = FINITE,
    *,
    same: bool = False,
) -> tuple[float, float]:
    """Return two numbers, low before high (with `same`: or alike), or raise `InputError`."""
    more = ", low before high"
    low, high = vector(source, field, values, 2, rule, more)
    if low < high or (same and low == high):
        return low, high
    raise InputError(source, field, rule.words(count=2) + more, shown([low, high]))


def listed(values: Any, most: int | None = None) -> list[Any] | None:
    """Return the elements of a list, a tuple, an array; None for what has none, as a text.

    With `most` no more than one beyond it are taken: enough to tell that they are too many.
    """
    if type(values) in (tuple, list):  # the usual case, and the search's: it makes many poses
        return list(values)
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        return None
    try:
        return list(islice(values, None if most is None else most + 1))
    except TypeError:  # an array of no dimension says that it can be iterated
        return None


def numbers(values: Any) -> NDArray[np.float64] | None:
    """Return an array of one's own of floats, NaN where there is no number; None for what is none.

    True, False and texts are no numbers here either.
    """
    try:
        array = np.asarray(values)
    except ValueError:  # rows of different lengths
        return None
    if array.dtype.kind in "iuf":
        return np.array(array, dtype=np.float64)
    if array.dtype.kind != "O":
        return None
    return np.array([real(v) for v in array.flat], dtype=np.float64).reshape(array.shape)


def choice(source: object, field: str, value: Any, among: Iterable[str]) -> str:
    """Return a text that is one of several, or raise `InputError`."""
    known = tuple(among)
    if isinstance(value, str) and value in known:
        return value
    raise InputError(source, field, f"one of {', '.join(known)}", shown(value))


def _whole(value: Any) -> int | None:
    value = plain(value)
    if isinstance(value, bool) or not isinstance(value, Real):
        return None
    if isinstance(value, Integral):
        return int(value)
    number = real(value)
    return int(number) if number.is_integer() else None


def _start(value: Any) -> str:
    """Return the beginning of a text, and other values as they are shown."""
    return f"{shown(value[:20])[:-1]}...'" if isinstance(value, str) else shown(value)
