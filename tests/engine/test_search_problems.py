"""The problems of the search benchmark begin where they may; rivals are asked as they should be."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.search_problems import PROBLEMS
from benchmarks.searches_told import table
from benchmarks.yardstick_searches import Landscape, Spent
from pe_core.search import Parametrization


@pytest.mark.parametrize("name", PROBLEMS)
def test_each_problem_begins_with_a_placement_that_breaks_no_rule(name):
    study = PROBLEMS[name].make()
    coding = Parametrization(study.rig, study.search_space())
    assert coding.variables and coding.allowed(study.rig)


def test_a_landscape_counts_what_is_evaluated_and_penalises_what_breaks_a_rule():
    """Six sensors in sixteen slots: a variable is the number of a slot; two in one break a rule."""
    study = PROBLEMS["six in slots"].make()
    told = []
    flat = SimpleNamespace(entropy=lambda rig: 2.0)
    landscape = Landscape(study, flat, 3, lambda rig, value: told.append(rig))
    assert landscape.start.tolist() == [0, 1, 2, 3, 4, 5] and landscape.slots.tolist() == [16] * 6
    assert [s.pose for s in told[0]] == [s.pose for s in study.rig]
    both = np.array([0, 0, 2, 3, 4, 5])
    assert math.isnan(landscape(both)) and landscape.penalised(both) == 3.0
    assert landscape.broken == 2 and len(told) == 1
    moved = np.array([0.2, 1.4, 2.0, 3.0, 4.0, 14.6])
    assert landscape(moved) == 2.0
    slots = study.search.mounting.mounts["rack"].slots
    expected = [slots[k].pose.position for k in (0, 1, 2, 3, 4, 15)]
    assert np.allclose([s.pose.position for s in told[1]], expected, atol=1e-5)
    landscape(moved)
    with pytest.raises(Spent):
        landscape(moved)


def test_ranges_are_scaled_to_their_bounds():
    study = PROBLEMS["two free"].make()
    landscape = Landscape(study, SimpleNamespace(entropy=lambda rig: 0.0), 9, lambda *_: None)
    assert landscape.low.tolist() == [0.0] * 8 and landscape.high.tolist() == [1.0] * 8
    # a: x 1.0 of -2.5 to 2.5, y 0.5 of -1 to 1, z 1.5 of 0.8 to 2.6, pitch 0 of -15 to 15 deg
    assert landscape.start[:4] == pytest.approx([0.7, 0.75, 7 / 18, 0.5])


def test_the_page_says_where_another_method_wins_and_ranks_whole_cells_alone():
    """Three seeds of two methods on two problems; the last cell lacks a seed."""
    ends = {
        ("two free", "portfolio"): (2.2, 2.3, 2.4),
        ("two free", "cma"): (2.1, 2.2, 2.9),
        ("traffic", "portfolio"): (1.0, 1.1, 1.2),
        ("traffic", "cma"): (1.3, 1.4),
    }
    runs = [
        {
            "problem": problem,
            "method": method,
            "budget": "small",
            "seed": seed,
            "samples": 2048,
            "load": 1.0,
            "entropy": entropy,
            "own_sample": entropy - 0.5,
            "seconds": 2.0,
            "evaluations": 250,
            "asked": 250,
            "broken": 25,
            "chosen": "",
            "path": f"{problem} {method} {entropy}",
        }
        for (problem, method), entropies in ends.items()
        for seed, entropy in enumerate(entropies)
    ]
    page = "\n".join(table(runs))
    assert "*two free*, small budget: CMA-ES 2.200; portfolio 2.300" in page
    assert "On the voxels that were searched: CMA-ES 1.700, portfolio 1.800." in page
    assert "*traffic*, small" not in page
    assert (
        "| two free | 250 | 2,048 | 2.300 (2.400, 3 seeds) | **2.200** (2.900, 3 seeds) |" in page
    )
    assert "1.350 (1.400, 2 seeds)" in page
    assert "| mean rank (problems) | | | 2.0 (1) | 1.0 (1) |" in page
    assert "one after the other): none" in page
    runs[1]["path"] = runs[0]["path"]
    assert "two free by portfolio" in "\n".join(table(runs))
