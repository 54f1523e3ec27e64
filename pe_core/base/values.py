"""Rules for input values: type, range, and the message that refuses a value.

A rule (`Number`, `Whole`, `Angle`, `Name`) says what is allowed; ``rule.checked(source, field,
value)`` returns the value as a plain Python type, or raises `InputError`. NumPy scalars count as
numbers; True, False and NaN do not.

Angles are in radians in memory and in degrees in files, exact to the last bit.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from numbers import Integral, Real
from typing import Any

import numpy as np

from .arrays import Floats
from .errors import InputError, one_of, shown

DEGREE_DECIMALS = 9  # Decimals of degrees in a file, where these give the angle exactly
MAX_DECIMALS = 17
NEAR_ULPS = 2
"""Search range round the converted degrees, in units of the last place."""
TO_RADIANS = math.pi / 180.0
TO_DEGREES = 180.0 / math.pi

MAX_NAME = 255  # Maximum characters of a name, as in file systems and in Blender
MAX_PATH = 4096  # Maximum characters of a path, as in Linux
NUMBER_NAMES = {2: "two", 3: "three"}
DECIMALS = 9
"""Entropies and shares are rounded to this: below it, builds of NumPy differ in the last bit."""


@dataclass(frozen=True, slots=True)
class Number:
    """A real number in a range.

    `minimum, maximum`: The range; both ends belong to it.
    `above, below`: Whether `minimum` (`maximum`) itself is excluded.
    `cap`: Largest magnitude with which arithmetic is safe. A message mentions it only for a value
        beyond it.
    `unit`: Unit of the value, for messages.
    `noun`: What messages call the value.
    `infinite`: Whether infinity is allowed, although beyond the cap.
    """

    minimum: float = -math.inf
    maximum: float = math.inf
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
            raise InputError(source, field, self.expected_text(number), shown(value))
        return number

    def holds(self, number: float) -> bool:
        """Whether a float is in the range; NaN never is."""
        low = self.minimum < number if self.above else self.minimum <= number
        high = number < self.maximum if self.below else number <= self.maximum
        if not (low and high):
            return False
        return self.infinite if math.isinf(number) else abs(number) <= self.cap

    def expected_text(self, number: float = math.nan, count: int = 1) -> str:
        """Say what is expected, for the message about a wrong `number`, or `count` of them."""
        plain = not self.infinite and (self._is_plain or count > 1)
        noun = f"finite {self.noun}" if plain else self.noun
        if count == 1:
            noun = f"an {noun}" if noun[0] in "aeiou" else f"a {noun}"
        else:
            noun = f"{NUMBER_NAMES.get(count, count)} {noun}s"
        if self.cap < abs(number) < math.inf:
            return f"{noun} within +-{self.cap:.12g}{self._unit}"
        return f"{noun}{self._range}"

    @property
    def _is_plain(self) -> bool:
        return not (math.isfinite(self.minimum) or math.isfinite(self.maximum))

    @property
    def _unit(self) -> str:
        return f" {self.unit}" if self.unit else ""

    @property
    def _range(self) -> str:
        """The range as text, after a blank."""
        low = f"{self.minimum:.12g}"
        high = f"{self.maximum:.12g}"
        if self._is_plain:
            return ""
        if self.minimum == -self.maximum:
            return f" within +-{high}{self._unit}"
        start = f"above {low}" if self.above else f">= {low}"
        end = f"below {high}" if self.below else f"<= {high}"
        if math.isinf(self.minimum) or math.isinf(self.maximum):
            return f" {end if math.isinf(self.minimum) else start}{self._unit}"
        both = f"{start} and {end}" if self.above or self.below else f"from {low} to {high}"
        return f" {both}{self._unit}"


@dataclass(frozen=True, slots=True)
class Angle(Number):
    """An angle: the range in degrees, the value in radians, rounded by `as_in_file`."""

    unit: str = "degrees"
    noun: str = "angle"

    def checked(self, source: object, field: str, value: Any) -> float:
        """Return the value [rad], or raise `InputError`."""
        number = value if type(value) is float else real(value)
        if not self.holds(math.degrees(number)):
            found = f"{math.degrees(number):g} degrees" if math.isfinite(number) else shown(value)
            raise InputError(source, field, self.expected_text(math.degrees(number)), found)
        return as_in_file(number)


@dataclass(frozen=True, slots=True)
class Whole:
    """An integer in a range; 1800.0 is accepted, 180.7 and True are not."""

    minimum: int = 0
    maximum: int | None = None
    unit: str = ""

    def checked(self, source: object, field: str, value: Any) -> int:
        """Return the value as an int, or raise `InputError`."""
        number = _whole(value)
        if number is None or number < self.minimum:
            raise InputError(source, field, f"{self._noun} >= {self.minimum}", shown(value))
        if self.maximum is not None and number > self.maximum:
            expected = f"{self._noun} from {self.minimum} to {self.maximum}"
            raise InputError(source, field, expected, shown(value))
        return number

    @property
    def _noun(self) -> str:
        return f"a whole number of {self.unit}" if self.unit else "a whole number"


@dataclass(frozen=True, slots=True)
class Name:
    """A text on one line: printable, of limited length, and not blank unless it may be empty."""

    expected: str = "a name in printable letters"
    max_length: int = MAX_NAME
    empty: bool = False

    def checked(self, source: object, field: str, value: Any) -> str:
        """Return the value as a plain str, or raise `InputError`."""
        if self.empty and value == "":
            return ""
        if not isinstance(value, str) or len(value) > self.max_length:
            long = f"; {len(value):,} characters" if isinstance(value, str) else ""
            most = f" ({self.max_length} at most)" if long else ""
            raise InputError(source, field, f"{self.expected}{most}", f"{_start(value)}{long}")
        if not value.strip() or not value.isprintable():
            raise InputError(source, field, self.expected, shown(value))
        return str(value)


FINITE = Number()
ANY = Number(infinite=True)
LENGTH = Number(0.0, above=True, cap=1e9, unit="m", noun="length")
SHARE = Number(0.0, 1.0)
WEIGHT = Number(0.0, cap=1e9)
A_NAME = Name()
A_TEXT = Name("a text", MAX_PATH)
A_PATH = Name("the name of a file", MAX_PATH)


def real(value: Any) -> float:
    """Return a value as a float; NaN if it is not a number, or an integer too large for a float."""
    number: Any = plain(value)
    if isinstance(number, bool) or not isinstance(number, Real):
        return math.nan
    try:
        return float(number)
    except OverflowError:
        return math.nan


def plain(value: Any) -> Any:
    """Return a NumPy scalar as a plain Python type; any other value unchanged."""
    return value.item() if getattr(value, "ndim", None) == 0 and hasattr(value, "item") else value


def vector(
    source: object, field: str, values: Any, count: int, rule: Number = FINITE, more: str = ""
) -> tuple[float, ...]:
    """Return `count` numbers that meet one rule, or raise one `InputError` for all of them. `more`
    is appended to what the message expects."""
    items = listed(values, count)
    worst = math.nan
    if items is not None and len(items) == count:
        try:
            return tuple(rule.checked(source, field, v) for v in items)
        except InputError:  # the message shows all numbers, not only the wrong one
            worst = max((abs(real(v)) for v in items), key=lambda v: v if v == v else math.inf)
    raise InputError(source, field, rule.expected_text(worst, count) + more, shown(values))


def pair(
    source: object, field: str, values: Any, rule: Number = FINITE, *, same: bool = False
) -> tuple[float, float]:
    """Return two numbers, low < high (with `same`: low <= high), or raise `InputError`."""
    more = ", low before high"
    low, high = vector(source, field, values, count=2, rule=rule, more=more)
    if low < high or (same and low == high):
        return low, high
    raise InputError(source, field, rule.expected_text(count=2) + more, shown([low, high]))


def listed(values: Any, max_count: int | None = None) -> list[Any] | None:
    """Return the elements of a list, tuple or array; None for anything else, a text included. At
    most ``max_count + 1`` elements are taken: enough to see that there are too many."""
    if type(values) in (tuple, list):  # the usual case, and fast: a search makes many poses
        return list(values)
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        return None
    try:
        return list(islice(values, None if max_count is None else max_count + 1))
    except TypeError:  # an array without dimensions is an Iterable, but cannot be iterated
        return None


def numbers(values: Any) -> Floats | None:
    """Return a new array of floats, NaN for an element that is not a number; None if not an array.
    As everywhere, True, False and texts are not numbers."""
    try:
        array = np.asarray(values)
    except ValueError:  # rows of different lengths
        return None
    if array.dtype.kind in "iuf":
        return np.array(array, dtype=np.float64)
    if array.dtype.kind != "O":
        return None
    return np.array([real(v) for v in array.flat], dtype=np.float64).reshape(array.shape)


def choice(source: object, field: str, value: Any, choices: Iterable[str]) -> str:
    """Return a text that is one of the choices, or raise `InputError`."""
    choices = tuple(choices)
    if isinstance(value, str) and value in choices:
        return value
    raise InputError(source, field, one_of(choices, value), shown(value))


def _whole(value: Any) -> int | None:
    value = plain(value)
    if isinstance(value, bool) or not isinstance(value, Real):
        return None
    if isinstance(value, Integral):
        return int(value)
    number = real(value)
    return int(number) if number.is_integer() else None


def _start(value: Any) -> str:
    """Return the beginning of a text in quotes; other values as `shown`."""
    return f"{shown(value[:20])[:-1]}...'" if isinstance(value, str) else shown(value)


def rounded(value: float) -> float:
    """Round to DECIMALS, without a negative zero."""
    return round(float(value), DECIMALS) + 0.0


def degrees_in_file(angle: float) -> float:
    """Return the shortest degrees that `math.radians` turns into this angle [rad]. About a tenth of
    all floats is not the `math.radians` of any float: then the degrees that come nearest.
    `as_in_file` rounds an angle to one that a file can hold."""
    degrees = math.degrees(angle)
    for decimals in range(DEGREE_DECIMALS, MAX_DECIMALS + 1):
        rounded = round(degrees, decimals) + 0.0
        if math.radians(rounded) == angle:
            return rounded
    neighbours = [degrees]
    low = degrees
    high = degrees
    for _ in range(NEAR_ULPS):
        low = math.nextafter(low, -math.inf)
        high = math.nextafter(high, math.inf)
        neighbours += [low, high]
    return min(neighbours, key=lambda near: abs(math.radians(near) - angle))


def as_in_file(angle: float) -> float:
    """Return an angle [rad] as it comes back from a file, at most one unit in the last place off.
    An angle that was converted from degrees is returned unchanged."""
    if math.radians(round(math.degrees(angle), DEGREE_DECIMALS)) == angle:
        return angle + 0.0  # no negative zero, which would be written out
    return math.radians(degrees_in_file(angle))


def all_as_in_file(angles: Floats) -> Floats:
    """Return an array of angles [rad] as they come back from a file; see `as_in_file`."""
    exact = np.round(angles * TO_DEGREES, DEGREE_DECIMALS) * TO_RADIANS == angles
    rounded = angles + 0.0
    rounded[~exact] = [as_in_file(a) for a in angles[~exact].tolist()]
    return rounded


def shown_share(share: float, decimals: int = 1) -> float:
    """Return a share, 0 to 1, for percent with so many decimals: less than all is not 100 %."""
    return share if share >= 1.0 else min(share, 1.0 - 10.0 ** (-decimals - 2))


def error_text(stderr: float) -> str:
    """Return a standard error with three decimals, for a sample: never 0."""
    return f"{max(stderr, 0.001):.3f}"
