"""The rules for values from outside, and the messages that quote them."""

import math
import struct
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from pe_core.base import values
from pe_core.base.errors import InputError

ENDLESS = 10**5000
TURNED = "a\u202eb"
SURROGATE = "a\ud800b"
DEEP: list = []
for _ in range(1000):
    DEEP = [DEEP]


def bits(number):
    return struct.pack("<d", number)


def refused(rule, value, found=""):
    with pytest.raises(InputError) as caught:
        rule.checked("file.toml", "field", value)
    line = str(caught.value)
    assert line.startswith("file.toml: field: expected ") and found in line
    assert len(line) < 300 and line.isprintable()
    return line


@pytest.mark.parametrize(
    "number", [2, 2.0, np.float64(2), np.float32(2), np.int8(2), np.array(2.0), Fraction(2)]
)
def test_numbers_of_python_and_numpy_become_floats(number):
    value = values.Number(0.0, 2.0).checked("a", "b", number)
    assert type(value) is float and value == 2.0


@pytest.mark.parametrize(
    "value",
    [True, np.True_, "2", b"2", None, [], [2], {}, 1j, math.nan, np.nan, Decimal(2), object()],
)
def test_what_is_no_number_is_none(value):
    refused(values.ANY, value)
    refused(values.Whole(), value)


def test_infinity_is_a_number_where_the_rule_says_so():
    assert values.ANY.checked("a", "b", -math.inf) == -math.inf
    assert "expected a finite number, found inf" in refused(values.FINITE, math.inf)


@pytest.mark.parametrize(
    ("rule", "good", "bad", "words"),
    [
        (values.Number(0.0, 1.0), [0, 1], [-1e-9, 1.001], "a number from 0 to 1"),
        (values.Number(0.0, above=True, unit="m"), [5e-324], [0, -1], "a number above 0 m"),
        (values.Number(0.0, unit="m"), [0], [-1], "a number >= 0 m"),
        (values.Number(-5.0, 5.0, unit="m"), [-5, 5], [6], "a number within +-5 m"),
        (values.Number(0.0, 1.0, below=True), [0], [1], "a number >= 0 and below 1"),
        (values.Whole(1), [1, 10**30], [0, -1, 1.5], "a whole number >= 1"),
        (values.Whole(), [0], [-1], "a whole number >= 0"),
        (values.Whole(1, 9000, "pixels"), [1, 9e3], [9001], "number of pixels from 1 to 9000"),
        (values.Whole(1, 9000, "pixels"), [1], [0, 1.5], "a whole number of pixels >= 1"),
        (values.LENGTH, [1e9], [0.0, -1.0, math.inf], "a length above 0 m"),
        (values.LENGTH, [1e-9], [2e9, 1e308], "a length within +-1000000000 m"),
        (values.Angle(-90.0, 90.0), [math.pi / 2, 0], [2.0], "an angle within +-90 degrees"),
    ],
)
def test_a_range_holds_its_ends_and_is_reported_in_words(rule, good, bad, words):
    for value in good:
        assert rule.checked("a", "b", value) == value
    for value in bad:
        assert words in refused(rule, value)


@pytest.mark.parametrize(
    "name",
    ["", "  ", "a\nb", "a\x1b[31m", TURNED, SURROGATE, "a\x00", "a\u2028b", "x" * 256, 3, None],
)
def test_names_that_a_line_cannot_hold_are_refused(name):
    refused(values.A_NAME, name)
    with pytest.raises(InputError):
        values.choice("file", "field", name, ("roof", "bumper"))


def test_vectors_have_their_count_and_are_reported_whole():
    assert values.vector("a", "b", np.array([1, 2, 3]), 3) == (1.0, 2.0, 3.0)
    for bad in ([1, 2], [1, 2, 3, 4], "123", {1: 1, 2: 2, 3: 3}, [1, 2, math.nan], None, 3, DEEP):
        with pytest.raises(InputError, match="expected three finite numbers, found"):
            values.vector("a", "b", bad, 3)
    with pytest.raises(
        InputError, match=r"two finite numbers within \+-9 m, low before high, found \[1"
    ):
        values.pair("a", "b", [1, 10], values.Number(-9.0, 9.0, unit="m"))


class Rude:
    def __repr__(self):
        raise RuntimeError("no")


@pytest.mark.parametrize("part", range(4))
@pytest.mark.parametrize("text", [TURNED, SURROGATE, "a\nb\x1b[2J\x07", "x" * 10**6])
def test_a_message_never_holds_what_a_terminal_acts_on(part, text):
    words = ["source", "field", "expected", "found"]
    words[part] = text
    line = str(InputError(*words))
    assert line.isprintable() and len(line) < 300
    assert line.encode("ascii")


def test_a_message_can_be_made_of_anything_that_was_found():
    for found in (Rude(), DEEP, ENDLESS, ["a\nb"], None, True, np.ones(3), {"a": SURROGATE}):
        line = str(InputError("source", "field", "sense", found))
        assert line.isprintable() and len(line) < 150
    assert str(InputError("a", "b", "c", 3)).endswith("found 3")
    assert str(InputError("a", "b", "c", "3")).endswith("found 3")


def test_degrees_in_a_file_give_back_every_bit():
    rng = np.random.default_rng(0)
    scales = 10.0 ** rng.integers(-9, 2, 20_000)
    angles = rng.uniform(-1, 1, 20_000) * scales
    held = values.all_as_in_file(angles)
    assert (np.abs(held - angles) <= np.spacing(np.abs(angles))).all()
    for angle, own in zip(held.tolist(), angles.tolist(), strict=True):
        assert bits(math.radians(values.degrees_in_file(angle))) == bits(angle)
        assert bits(values.as_in_file(own)) == bits(angle)


def test_angles_that_come_from_degrees_are_never_changed():
    for tenths in range(-3600, 3601):
        angle = math.radians(tenths / 10)
        assert bits(values.as_in_file(angle)) == bits(angle + 0.0)
        assert values.degrees_in_file(angle) == tenths / 10
    assert bits(values.as_in_file(-0.0)) == bits(0.0)
