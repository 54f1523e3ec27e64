"""Which designs there are, the front among them, and the local search: against brute force."""

import itertools
import random

import pytest

import pe_core as pe
from pe_core.search import DesignSearch, DesignSpace, Value, above_front, pareto_front, selection

MODELS = ("Pandar64", "Pandar40", "HDL-64E")
EYES = ("Camera 30 deg", "Camera 60 deg")


def options(names, prices):
    return [pe.Option(pe.catalog.load(n), p) for n, p in zip(names, prices, strict=True)]


def sensor(name, model="Pandar64", position=(0.0, 0.0, 2.0)):
    return pe.Sensor(name, pe.catalog.load(model), pe.Pose(position))


def designs(rig, choices, mounting=None, price=None, **limits):
    selection = pe.Selection(choices, **limits)
    return DesignSpace.of(selection, rig, mounting or pe.Mounting(), pe.Limits(price=price))


RIG = pe.Rig([sensor("a"), sensor("b"), sensor("eye", EYES[0]), sensor("held")])
CHOICES = (
    pe.Choice(options(MODELS, (9, 7, 4)), ["a"], optional=True),
    pe.Choice(options(MODELS[:2], (9, 7)), ["b"]),
    pe.Choice(options(EYES, (2, 1)), ["eye"], optional=True),
)


def by_hand(price=99, max_sensors=9, lidars=9):
    """Model names of every design, from nested loops and sums alone."""
    found = set()
    prices = dict(zip((*MODELS, *EYES, None), (9, 7, 4, 2, 1, 0), strict=True))
    for a, b, eye in itertools.product((*MODELS, None), MODELS[:2], (*EYES, None)):
        cost = prices[a] + prices[b] + prices[eye]
        count = (a is not None) + 1 + (eye is not None) + 1
        if cost <= price and count <= max_sensors and (a is not None) + 2 <= lidars:
            found.add((a, b, eye, cost))
    return found


@pytest.mark.parametrize(
    ("limits", "same"),
    [
        ({}, {}),
        ({"price": 12}, {"price": 12}),
        ({"max_sensors": 3}, {"max_sensors": 3}),
        ({"max_of_kind": {"lidar": 2}}, {"lidars": 2}),
        ({"price": 10, "max_sensors": 3}, {"price": 10, "max_sensors": 3}),
    ],
)
def test_designs_are_those_of_nested_loops(limits, same):
    """Sensors that nobody chooses count for the numbers and cost nothing."""
    all_of_them = designs(RIG, CHOICES, **limits)
    found = set()
    for picks in all_of_them:
        models = all_of_them.models(picks)
        names = (models[name] and models[name].name for name in ("a", "b", "eye"))
        found.add((*names, all_of_them.price(picks)))
    assert found == by_hand(**same)
    assert 0 < len(found) == len(list(all_of_them))


def test_sensors_of_a_mount_are_interchangeable_and_one_sensor_has_to_be_there():
    slots = pe.SlotMount([pe.Slot(str(y), pe.Pose((0.0, y, 2.0))) for y in (-1.0, 0.0, 1.0)])
    rig = pe.Rig([sensor(n, position=(0.0, y, 2.0)) for n, y in (("a", -1.0), ("b", 1.0))])
    mounting = pe.Mounting({"rack": slots}, dict.fromkeys("ab", "rack"))
    choice = pe.Choice(options(MODELS, (9, 7, 4)), mount="rack", optional=True)
    found = designs(rig, [choice], mounting=mounting)
    named = {
        tuple(sorted(m.name for m in found.models(picks).values() if m is not None))
        for picks in found
    }
    expected = itertools.combinations_with_replacement((*MODELS, None), 2)
    assert named == {tuple(sorted(filter(None, two))) for two in expected if any(two)}
    assert len(list(found)) == len(named) == 9


def test_a_pair_takes_one_model_and_costs_twice():
    left = sensor("l", position=(1.0, 0.5, 1.0))
    right = sensor("r", position=(1.0, -0.5, 1.0))
    mounting = pe.Mounting(pairs=[("l", "r")])
    choice = pe.Choice(options(MODELS[:1], (9,)), ["l"], optional=True)
    found = designs(pe.Rig([left, right, sensor("held")]), [choice], mounting=mounting)
    assert [found.price(picks) for picks in found] == [18, 0]
    assert set(found.models((0,))) == {"l", "r"}


def test_the_front_is_what_no_other_beats():
    draw = random.Random(3)
    for _ in range(200):
        worths = [(draw.randrange(6), draw.randrange(6)) for _ in range(draw.randrange(1, 9))]
        beaten = {
            k
            for k, (p, e) in enumerate(worths)
            for j, (q, f) in enumerate(worths)
            if q <= p and f <= e and ((q, f) != (p, e) or j < k)
        }
        assert sorted(pareto_front(worths)) == sorted(set(range(len(worths))) - beaten)
        above = above_front([(price, Value(0.0, worth)) for price, worth in worths])
        assert all(above[k] == 0 for k in pareto_front(worths))
        assert min(above) >= 0


def test_the_local_search_finds_the_front_of_more_designs_than_it_looks_at(monkeypatch):
    """Entropies fall with what each site has, as a true rig's: the front is that of brute force."""
    monkeypatch.setattr(selection, "ALL_UP_TO", 10)
    rig = pe.Rig([sensor(name) for name in "abcd"])
    choices = [pe.Choice(options(MODELS, (9, 7, 4)), [name], optional=True) for name in "abcd"]
    every = designs(rig, choices)
    gain = {k: dict(zip((0, 1, 2, 3), (3 + k, 5 + k / 2, 6 + k, 0), strict=True)) for k in range(4)}

    def entropy(picks):
        return Value(0.0, 40.0 - sum(gain[k][pick] for k, pick in enumerate(picks)))

    search = DesignSearch(every)
    looked = {}
    while asked := search.ask():
        assert not set(asked) & set(looked)
        looked |= {picks: entropy(picks) for picks in asked}
        search.tell(looked)
    some = list(looked)
    total = list(every)
    best, true = (
        {(every.price(p), entropy(p)) for p in (those[k] for k in pareto_front(w))}
        for those, w in (
            (those, [(every.price(p), entropy(p)) for p in those]) for those in (some, total)
        )
    )
    assert not search.is_complete
    assert len(some) < len(total)
    assert best == true


def test_limits_that_would_be_checked_for_ever_are_refused(monkeypatch):
    """Each of 40 sites is a cheap LiDAR, of which 20 may be, or a dear camera: none is affordable,
    which only begins to show behind billions of begun designs."""
    monkeypatch.setattr("pe_core.search.selection.MAX_STEPS", 500)
    names = [f"s{number}" for number in range(40)]
    rig = pe.Rig([sensor(name) for name in names])
    models = [pe.Option(pe.catalog.load(n), p) for n, p in ((MODELS[0], 1), (EYES[0], 2))]
    each = [pe.Choice(models, [name]) for name in names]
    with pytest.raises(pe.InputError, match="fewer choices, or limits that are checked on 500"):
        designs(rig, each, price=59, max_of_kind={"lidar": 20})
    assert designs(rig, each, price=60, max_of_kind={"lidar": 20}).first(1)
