"""What a search tells of its start and end: mounted off, and with a sensor lost."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import mounted_off, robustness
from pe_core.search.tolerance import FRESH
from pe_tools import advice
from tests.engine import shapes

OFF = pe.Tolerance(0.02, math.radians(0.5), 4)


def study(tolerance=OFF, samples=1024, failures=False):
    model = shapes.small_lidar(4, 90)
    rig = pe.Rig(
        [shapes.lidar_on_roof(model), shapes.lidar_on_roof(model, (1.0, 0.4, 1.6), name="front")]
    )
    search = pe.Search(
        free={"roof": ("z",), "front": ("z",)},
        samples=samples,
        schedule=pe.Schedule(1),
        method="random",
        tolerance=tolerance,
    )
    return shapes.car_study(rig, search=search, samples=1024)


@pytest.fixture(scope="module")
def outcome():
    job = pt.OptimizeJob(study())
    assert list(job)[-1].stage == "done"
    return job.outcome


def test_it_tells_the_mean_and_the_worst_of_errors_that_the_search_has_not_seen(outcome):
    evaluator = study().evaluator(1024)
    found = outcome.robustness
    for rig, stands in ((study().rig, found.before), (outcome.study.rig, found.after)):
        off = [evaluator.entropy(each) for each in mounted_off(rig, OFF, 0, FRESH)]
        assert stands.mounted_off == pytest.approx(np.mean(off), abs=1e-9)
        assert stands.mounted_worst == pytest.approx(max(off), abs=1e-9)
        assert stands.entropy == evaluator.entropy(rig)
        assert stands.rise == pytest.approx(np.mean(off) - stands.entropy, abs=2e-9)
        searched = [evaluator.entropy(each) for each in mounted_off(rig, OFF, 0)]
        assert set(searched).isdisjoint(off)
    assert found.samples == 1024 and found.errors == OFF


def test_it_tells_the_loss_of_each_sensor(outcome):
    lost = outcome.robustness.before
    rig = outcome.start.rig
    evaluator = study().evaluator(1024)
    each = {s.name: evaluator.entropy(pe.Rig([o for o in rig if o is not s])) for s in rig}
    assert lost.failed == pytest.approx(sum(each.values()) / 2, abs=1e-9)
    assert lost.missed == max(each, key=each.get) and lost.failed_worst == each[lost.missed]
    assert lost.loss == pytest.approx(lost.failed - lost.entropy, abs=2e-9)
    alone = pe.Rig([rig["roof"]])
    told = robustness(evaluator, alone, alone, OFF)
    assert told.before is told.after and told.before.failed is told.before.loss is None


def test_the_standard_error_covers_what_other_seeds_tell():
    evaluator = study().evaluator(1024)
    rig = study().rig
    off = replace(OFF, draws=6)
    told = [robustness(evaluator, rig, rig, off, seed=seed).after for seed in range(5)]
    scatter = np.std([each.mounted_off for each in told], ddof=1)
    errors = np.sqrt(np.mean([each.stderr**2 for each in told]))
    assert 0.5 * scatter < errors < 4.0 * scatter


def test_a_search_under_errors_keeps_what_it_found_though_it_scores_worse_as_it_stands(outcome):
    assert len(outcome.history) > 1
    again = pt.OptimizeJob(study(), before=replace(outcome.before, entropy=0.0))
    list(again)
    assert again.outcome.study.rig is again.history[-1].rig is not again.outcome.start.rig


@pytest.mark.parametrize(
    ("rise", "stderr", "told"),
    [(0.051, 0.01, True), (0.05, 0.0, False), (0.2, 0.11, False), (0.2, 0.09, True)],
)
def test_a_fragile_placement_is_reported(rise, stderr, told):
    found = advice.fragile(rise, stderr, 0.01, math.radians(0.3), tolerant=False)
    assert bool(found) is told
