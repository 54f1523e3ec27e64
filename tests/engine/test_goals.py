"""What is asked of a search: when it stops, which sensors stay, from where it starts; the file."""

import math
from dataclasses import replace
from itertools import pairwise
from statistics import stdev

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring.sampling import HELD_OUT
from pe_core.search import Goals, Start
from pe_tools.cli.terminal import summary
from pe_tools.cli.verbs import parser
from pe_tools.jobs import HistoryRow, best_so_far, result_dict, stopping
from tests.engine import shapes
from tests.engine.processes import finished as driven

pytestmark = pytest.mark.usefixtures("few_errors", "no_key_figures")


def study(goals=None, names=("roof",), **search):
    model = shapes.small_lidar(4, 90)
    rig = pe.Rig(
        [shapes.lidar_on_roof(model, (0.0, 0.5 * k, 1.6), name=n) for k, n in enumerate(names)]
    )
    goals = goals or Goals()
    given = {"free": dict.fromkeys(names, ("z", "pitch")), "evaluations": 60} | search
    settings = pe.Search(samples=1024, goals=goals, **given)
    return shapes.car_study(rig, search=settings, samples=1024)


def finished(given, **more):
    return driven(pt.OptimizeJob(given, 1, **more))


@pytest.fixture(scope="module")
def plain():
    return finished(study())


def test_a_search_stops_at_its_target_with_the_steps_of_the_whole_one(plain):
    target = plain.history[2].value.objective
    outcome = finished(replace(study(), limits=pe.Limits(entropy=target)))
    assert outcome.stop_reason == "target" and not outcome.stopped
    assert outcome.history == plain.history[:3] or [r.value for r in outcome.history] == [
        r.value for r in plain.history[:3]
    ]
    assert outcome.evaluations < plain.evaluations
    assert outcome.evaluated == plain.evaluated[: len(outcome.evaluated)]
    assert f"ended at its target of {target:g} nats" in summary(outcome)
    assert result_dict(outcome)["stop_reason"] == "target"


def test_limits_are_set_by_key_or_option(tmp_path):
    path = tmp_path / "study.toml"
    limits = pe.Limits(blind_ground=True, blind_sector=20, ap_far={"value": 0.3, "kept": False})
    pt.export_study(replace(study(), limits=limits), path)
    assert pe.load_study(path).limits == limits
    for options, change in (
        (["limits.ap_far=0.4", "limits.reach=true"], {"ap_far": 0.4, "reach": True}),
        (["limits.ap_far.kept=true"], {"ap_far": 0.3}),
        ([], {}),
    ):
        assert typed_study(path, options).limits == replace(limits, **change)
    for option in ("limits.ap_far=2", "limits.margin=1", "limits.reach=far"):
        with pytest.raises(pe.InputError, match=option.partition("=")[0]):
            typed_study(path, [option])
    path.write_text(path.read_text().replace("blind_ground =", "blind_grund ="))
    with pytest.raises(pe.InputError, match=r"limits.*blind_ground.*blind_grund|blind_grund"):
        pe.load_study(path)


def test_a_search_that_races_tells_within_what_another_seed_would_end(plain):
    """Its descents share nothing but their start; a short search has no race."""
    assert plain.seed_scatter is None and result_dict(plain)["seed_scatter"] is None
    job = pt.OptimizeJob(study(evaluations=320), 1)
    driven(job)
    assert len(job.descents) == 4 and min(job.descents) >= job.history[-1].value
    scatter = stopping.APART * stdev(each.objective for each in job.descents)
    assert job.outcome.seed_scatter == pytest.approx(scatter, abs=1e-9) and scatter > 0.0
    assert result_dict(job.outcome)["seed_scatter"] == job.outcome.seed_scatter
    assert f"another seed would probably end within {scatter:.3f} nats" in summary(job.outcome)
    assert stopping.seed_scatter((pe.Value(0.0, 1.0),)) is None
    ends = pe.Value(0.0, 1.0), pe.Value(0.5, math.inf)
    assert stopping.seed_scatter(ends) is None


def test_fixed_sensors_stay_and_the_others_move():
    outcome = finished(study(Goals(fixed=("roof",)), ("roof", "front")))
    start = outcome.start.rig
    best = outcome.study.rig
    assert best["roof"].pose == start["roof"].pose and best["front"].pose != start["front"].pose
    with pytest.raises(pe.InputError, match="optimize: fixed: expected sensors that follow no"):
        study(Goals(fixed=("bogus",)))


def test_a_fixed_sensor_keeps_its_slot():
    """Another sensor may not take it."""
    slots = [pe.Slot(n, pe.Pose((0.0, y, 1.6))) for n, y in (("a", 0.0), ("b", 0.5), ("c", 1.0))]
    mounting = pe.Mounting({"rack": pe.SlotMount(slots)}, dict.fromkeys(("roof", "front"), "rack"))
    given = study(Goals(fixed=("roof",)), ("roof", "front"), mounting=mounting)
    coding = given.coding()
    assert len(coding.variables) == 1
    taken = [coding.candidate([share]).rig for share in (0.1, 0.5, 0.9)]
    assert [coding.allowed(rig) for rig in taken] == [False, True, True]


def test_several_starts_share_the_budget_and_the_best_end_is_the_result(plain):
    poses = {"roof": pe.Pose((0.0, 0.0, 2.2))}
    given = study(Goals(starts=[Start("high", poses)]))
    outcome = finished(replace(given, limits=pe.Limits(entropy=pe.Limit(-9.0))))
    assert [end.name for end in outcome.starts] == ["", "high"]
    assert outcome.evaluations == 60 and outcome.starts[0].evaluations == 30
    halves = [study().evaluator(1024, shift=shift) for shift in HELD_OUT]
    reported = np.mean([each.entropy(outcome.study.rig) for each in halves])
    assert any(end.value.objective == pytest.approx(reported, abs=2e-9) for end in outcome.starts)
    assert "the start high ended at" in summary(outcome)
    assert f"\nentropy {outcome.before.entropy:.3f} nats -> " in summary(outcome)
    broken = replace(
        outcome, starts=[replace(end, value=pe.Value(0.5, math.inf)) for end in outcome.starts]
    )
    assert "the start high ended with constraints broken by 0.500" in summary(broken)
    again = finished(study(Goals(starts=[Start("high", poses)])), journal=journal_of(outcome, 40))
    assert result_dict(again)["placements"] == result_dict(outcome)["placements"]
    job = pt.OptimizeJob(study(Goals(starts=[Start("high", poses)])), 1)
    for _ in job:
        if job.evaluations == 40 and not job.stopped:
            job.stop()
    assert len(job.outcome.starts) == 2 and job.outcome.stopped
    goes_on = finished(job.study, journal=journal_of(job.outcome, None))
    assert goes_on.evaluated == outcome.evaluated


def test_the_curve_of_a_search_never_rises_and_ends_at_its_last_value(plain):
    """Neither with a further start, nor where the best is evaluated again with more samples."""
    poses = {"roof": pe.Pose((0.0, 0.0, 2.2))}
    several = pt.OptimizeJob(study(Goals(starts=[Start("high", poses)])), 1)
    last = []
    for _ in several:
        values = [value for _, value in several.curve]
        assert all(after < before for before, after in pairwise(values))
        last += values[-1:]
    assert all(after <= before for before, after in pairwise(last))
    assert last[-1] == several.history[-1].value


def test_values_of_fewer_samples_are_shifted_to_those_of_more():
    rigs = [pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(4, 90), (x, 0, 2))]) for x in range(4)]
    given = [(2, 4.0, 1), (5, 3.0, 2), (6, 3.4, 2), (9, 2.9, 3)]
    broken = HistoryRow(1, 0, pe.Value(0.5, math.inf), rigs[0])
    rows = [broken, *(HistoryRow(n, 0, pe.Value(0.0, value), rigs[k]) for n, value, k in given)]
    curve = [(number, value.objective) for number, value in best_so_far(rows)]
    assert curve == [(2, 4.4), (5, 3.4), (9, 2.9)]
    later = HistoryRow(11, 0, pe.Value(0.0, 3.2), rigs[0])
    assert best_so_far(rows, [later]) == best_so_far(rows)
    broken_alone = best_so_far(rows[:1])
    assert broken_alone == ((1, (0.5, math.inf)),), "as long as nothing keeps the requirements"


def journal_of(outcome, count):
    return pe.search.Journal(outcome.evaluated[:count])


def typed_study(path, changes):
    """The study that `pe optimize` searches with changes by ``--set``."""
    line = ["optimize", str(path), *(word for each in changes for word in ("--set", each))]
    args = parser().parse_args(line)
    return args.source.study(args)


def test_options_of_the_command_line_are_the_goals_of_the_study(tmp_path):
    given = replace(study(names=("roof", "front")), vehicle=None)
    path = tmp_path / "other.toml"
    pe.save_study(given, path)
    changed = typed_study(
        path,
        [
            "limits.entropy=-1.5",
            "optimize.stop.gain=0.01",
            'optimize.fixed=["roof"]',
            'optimize.front.objectives=["entropy", "height"]',
        ],
    )
    goals = changed.search.goals
    assert changed.limits == pe.Limits(entropy=-1.5)
    assert (goals.stop.gain, goals.stop.seconds) == (0.01, None)
    assert goals.fixed == ("roof",) and goals.front.objectives == ("entropy", "height")
    assert typed_study(path, []).search.goals == given.search.goals
    args = parser().parse_args(["optimize", str(path), "--start", str(path)])
    assert [start.name for start in args.source.study(args).search.goals.starts] == ["other"]
