"""A search that is asked and told: the same as `pe.optimize`, in any order, from a journal."""

import json
import random
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

import pe_core as pe
from tests.engine.test_notebook import study


def value(rig):
    """A function with its lowest value inside of the bounds."""
    x, y, z = rig["roof"].pose.position
    return (x - 0.3) ** 2 + (y + 0.2) ** 2 + abs(z - 1.8) + abs(rig["roof"].pose.rpy[1])


def problem(method="portfolio", evaluations=90, seed=3):
    one = study()
    search = replace(one.search, method=method, evaluations=evaluations, seed=seed)
    return replace(one, search=search)


def told(run, count=5, shuffled=None, until=10**9):
    """Run a search by asking and telling."""
    while not run.is_done and run.evaluations < until:
        rigs = run.ask(count)
        assert rigs, "a search that is told everything asks on"
        if shuffled is not None:
            shuffled.shuffle(rigs)
        run.tell(rigs, [value(rig) for rig in rigs])
    return run


@pytest.mark.parametrize("method", pe.METHODS)
def test_a_run_is_the_search_of_optimize(method):
    one = problem(method, 60 if method == "random" else 90)
    schedule = one.search.schedule if method == "random" else None
    with ThreadPoolExecutor(1) as pool:
        steps = list(
            pe.optimize(
                value,
                one.rig,
                one.search_space(),
                one.search.seed,
                schedule=schedule,
                method=method,
                evaluations=one.search.evaluations,
                executor=pool,
            )
        )
    run = told(one.search_run())
    assert run.evaluations == steps[-1].evaluations == one.search.evaluations
    assert run.value == steps[-1].entropy
    assert run.best["roof"].pose == steps[-1].best["roof"].pose


def test_order_and_number_of_what_is_asked_change_nothing():
    plain = told(problem().search_run(), 1)
    for count in (3, 100):
        other = told(problem().search_run(), count, random.Random(count))
        assert other.journal == plain.journal and other.value == plain.value


def test_a_run_resumes_from_its_journal_wherever_it_was_left():
    whole = told(problem().search_run())
    for until in (0, 1, 17, 40):
        run = problem().search_run()
        told(run, 4, until=until)
        waiting = run.ask(3)
        if len(waiting) > 1:  # the last of them alone: nothing that follows it is known
            run.tell(waiting[-1:], [value(waiting[-1])])
        kept = json.loads(json.dumps(run.journal))
        again = problem().search_run(journal=kept)
        assert again.evaluations == len(kept) == run.evaluations
        assert told(again).journal == whole.journal


def test_a_run_waits_for_what_it_asked_for():
    run = problem().search_run()
    [start] = run.ask(10)
    assert run.best is None and not run.ask()
    run.tell([start], [value(start)])
    assert run.best is start and run.evaluations == 1 and run.ask(2)


def test_what_a_run_cannot_take_is_told():
    run = problem().search_run()
    [start] = run.ask()
    for rigs, values in (([problem().rig], [1.0]), ([start], [float("nan")]), ([start], ["low"])):
        with pytest.raises(pe.InputError):
            run.tell(rigs, values)
    run.tell([start], [1.0])
    with pytest.raises(pe.InputError):
        run.tell([start], [1.0])
    with pytest.raises(pe.InputError):  # another search's
        problem().search_run(journal=told(problem(seed=4).search_run()).journal)


@pytest.mark.parametrize("wrong", [float("nan"), "low", None, float("-inf")])
def test_of_wrong_values_none_is_taken(wrong):
    """Also those before the wrong one: what was refused can be told again, and as it was."""
    run = problem().search_run()
    run.tell(run.ask(), [1.0])
    first, second, third = run.ask(3)
    before = run.journal, run.evaluations
    for rigs, values in (
        ([first, second, third], [0.5, wrong, 0.7]),
        ([first, second, first], [0.5, 0.6, 0.7]),
        ([first, second], [0.5]),
    ):
        with pytest.raises(pe.InputError):
            run.tell(rigs, values)
        assert (run.journal, run.evaluations) == before
    run.tell([first, second, third], iter([0.1, 0.2, 0.3]))
    assert run.evaluations == before[1] + 3 and run.value == 0.1


@pytest.mark.parametrize(
    ("journal", "field", "found"),
    [
        (3, "", "3"),
        (None, "", "None"),
        ("ab", "", "ab"),
        ({"a": 1}, "", "a"),
        ([1.0], "[0]", "1.0"),
        ([None], "[0]", "None"),
        ([[[0.0, 1.0]]], "[0]", "[[0.0, 1.0]]"),
        ([[[0.0, 1.0], "a", 2]], "[0]", "2"),
        ([["a", 1.0]], "[0][0]", "a"),
        ([[1.0, "a"]], "[0][0]", "1.0"),
        ([[[0.0, True], "a"]], "[0][0][1]", "True"),
        ([[[0.0, float("nan")], "a"]], "[0][0][1]", "nan"),
        ([[[0.0, float("-inf")], "a"]], "[0][0][1]", "-inf"),
        ([[[-1.0, 0.0], "a"]], "[0][0][0]", "-1.0"),
        ([[[0.0, 1.0], 2]], "[0][1]", "2"),
    ],
)
def test_a_journal_of_a_wrong_shape_is_one_line(journal, field, found):
    with pytest.raises(pe.InputError) as error:
        problem().search_run(journal=journal)
    assert f"journal{field}: expected" in str(error.value)
    assert found in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("more", [1, 40, None], ids=["one more", "40 more", "doubled"])
def test_a_journal_that_is_longer_than_its_search_is_refused(more):
    """It is another search's, or damaged: it would be written back as it is."""
    whole = told(problem().search_run()).journal
    with pytest.raises(pe.InputError, match=r"evaluated\[90\]: expected no more entries"):
        problem().search_run(journal=[*whole, *whole[:more]])
    assert problem().search_run(journal=whole).is_done


def test_a_search_without_anything_free_asks_for_its_start_alone():
    one = study()
    fixed = replace(one, search=replace(one.search, free={"roof": ()}))
    run = told(fixed.search_run())
    assert run.is_done and run.evaluations == 1 and run.ask() == []
