"""Parts of block descent, asked by hand: races, repeats, starts, levels."""

from typing import ClassVar

import pytest

from pe_core.search import Evaluation, Parametrization
from pe_core.search.design_variable import RADIAN
from pe_core.search.methods import block_descent
from pe_core.search.methods.block_descent import Descent, corner_start, random_start
from pe_core.search.methods.method import Given, Phase
from tests.engine import mounting
from tests.engine.mounting import can

PHASE = Phase(0, 1000)


@pytest.fixture(scope="module")
def coding():
    return Parametrization(*mounting.space(can(), can((0.2, 0.1, 1.6), "b")))


def answered(asking, value):
    """Drive a part of a method: each candidate is worth `value` of it; return what it returns."""
    try:
        question = next(asking)
        while True:
            answers = [c and Evaluation(value(c), False) for c in question.candidates]
            question = asking.send(answers)
    except StopIteration as stop:
        return stop.value


class Racer:
    """A descent whose entropy is its start's, less what it gains each time it goes down."""

    log: ClassVar[list] = []
    gain: ClassVar[dict] = {}

    def __init__(self, given, start, entropy, seed, step=None):
        self.best, self.entropy, self.count, self.spread = start, entropy, 0, 1.0
        self.log.append(("new", start, seed, step))

    def descend(self, phase, count, finest=0.0):
        yield from ()
        self.log.append(("descend", self.best))
        self.count, self.entropy = self.count + 10, self.entropy - self.gain.get(self.best, 0.0)


@pytest.fixture
def racers(monkeypatch):
    """Descents are racers, and starts are four: worth 3, 1, 2, and 4."""

    def start(name, entropy):
        def begin(given, phase):
            yield from ()
            return name, entropy

        return begin

    starts = [start(name, entropy) for name, entropy in (("a", 3), ("b", 1), ("c", 2), ("d", 4))]
    monkeypatch.setattr(block_descent, "STARTS", tuple(starts))
    monkeypatch.setattr(block_descent, "Descent", Racer)
    monkeypatch.setattr(Racer, "log", [])
    monkeypatch.setattr(Racer, "gain", {"c": 0.6})
    return Racer


def test_after_each_race_the_better_half_goes_on(racers, coding):
    """The third start gains 0.6 in each race: 3, 1, 1.4, 4 after the first, then 1 against 0.8."""
    given = Given(coding, coding.start, 5.0, seed=7)
    best, count = answered(block_descent._raced(given, 1000), None)
    assert [e[1] for e in racers.log if e[0] == "descend"] == ["a", "b", "c", "d", "b", "c"]
    assert (best.best, count) == ("c", 60.0)
    assert [e[2] for e in racers.log if e[0] == "new"] == [[7, n] for n in range(4)]


def test_repeats_begin_where_the_last_one_ended_wide_and_by_other_numbers_of_the_seed(
    racers, coding
):
    given = Given(coding, coding.start, 5.0, seed=7)
    answered(block_descent._repeated(given, Racer(given, "c", 1.0, [7, 2]), 1000, 25.0), None)
    wide = block_descent.RESTART_STEP
    assert wide == 0.25
    assert [e for e in racers.log if e[0] == "new"][1:] == [
        ("new", "c", [7, number], wide) for number in (4, 5, 6)
    ]


def test_a_corner_that_is_worse_than_the_start_is_left(coding):
    given = Given(coding, coding.start, 3.0)
    assert answered(corner_start(given, PHASE), lambda c: 4.0) == (given.start, 3.0)
    found, entropy = answered(corner_start(given, PHASE), lambda c: 2.0 + c.vector[0] / 10.0)
    assert entropy < 2.0 and found.vector[0] == given.parametrization.variables[0].low


def test_anywhere_is_another_place_with_the_angles_of_the_start(coding):
    given = Given(coding, coding.start, 3.0, seed=2)
    found, entropy = answered(random_start(given, PHASE), lambda c: 8.5)
    units = [unknown.unit for unknown in coding.variables]
    for unit, value, before in zip(units, found.vector, coding.start.vector, strict=True):
        assert (value == before) == (unit == RADIAN)
    assert entropy == 8.5


def test_on_another_level_the_best_is_worth_what_that_level_says(coding):
    descent = Descent(Given(coding, coding.start, 3.0, levels=2), coding.start, 3.0, [1, 0])
    answered(descent.reevaluate(Phase(1, 1000, 1)), lambda c: 6.0)
    assert (descent.entropy, descent.best) == (6.0, coding.start)
