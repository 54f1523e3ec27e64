"""Our own study: what was fixed beforehand, and that the placements are those of its rule."""

import json
from collections import Counter

from studies.detectors.placements import listing, placements
from studies.detectors.plan import ACROSS, FIXED, MIXED, full_plan, quick_plan
from tests.studies.conftest import ROOT

FOLDER = ROOT / "docs" / "validity" / "own"
DIGEST = "33306cc19714a1fa"
"""Of the plan that the study began with. A changed plan is another study, with its own results."""


def test_the_plan_is_the_one_that_the_study_began_with():
    assert full_plan().digest == DIGEST


def test_the_listed_placements_are_those_that_the_rule_draws():
    assert json.loads((FOLDER / "placements.json").read_text("utf-8")) == listing(full_plan())


def test_the_designs_have_the_placements_that_the_plan_promises():
    drawn = placements(full_plan())
    assert len({p.name for p in drawn}) == len(drawn)
    assert len({p.poses for p in drawn}) == len(drawn)
    fixed = Counter((p.vehicle, p.all_round) for p in drawn if p.design == FIXED)
    assert fixed == {(v, r): 12 if r else 4 for v in ("sedan", "bus") for r in (True, False)}
    across = [p for p in drawn if p.design == ACROSS]
    assert {(p.lidars, p.channels) for p in across} == {(n, c) for n in (1, 2, 4) for c in (16, 32)}
    assert all(p.all_round for p in across) and len(across) == 18
    assert sum(p.design == MIXED for p in drawn) == 68


def test_a_quick_run_has_three_placements_and_another_digest():
    plan = quick_plan()
    assert sum(p.design != MIXED for p in placements(plan)) == 3
    assert plan.digest != full_plan().digest
