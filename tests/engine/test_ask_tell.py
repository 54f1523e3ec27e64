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
                schedule,
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


def test_a_search_without_anything_free_asks_for_its_start_alone():
    one = study()
    fixed = replace(one, search=replace(one.search, free={"roof": ()}))
    run = told(fixed.search_run())
    assert run.is_done and run.evaluations == 1 and run.ask() == []
