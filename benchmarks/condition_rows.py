"""Conditions: four states and three weathers, against one score of the same samples."""

from __future__ import annotations

from dataclasses import replace

import pe_core as pe
from pe_core.study import condition_table

from .problems import four_on_car
from .timing import Timing, best_of_processor, peak_mb

SAMPLES = 65_536
ROUNDS = 3


def four_states_in_three_weathers() -> Timing:
    """All conditions with each sensor lost, evaluators included, as is the one score's."""
    study = replace(four_on_car(), samples=SAMPLES)
    assert study.vehicle is not None
    part = study.vehicle.part_names[0]
    states = [pe.State("driving")] + [
        pe.State(f"moved {number}", [pe.Motion([part], move=(0.0, 0.0, 0.01 * number))])
        for number in range(1, 4)
    ]
    weathers = [
        pe.Weather("sun"),
        pe.Weather("rain", rain_mm_h=25.0),
        pe.Weather("fog", fog_mor_m=100.0),
    ]
    scored = replace(study, conditions=pe.Conditions(states, weathers))
    study.evaluator().score(study.rig)  # what all of them share: densities of the prior
    mine = best_of_processor(lambda: condition_table(scored), ROUNDS)
    one = best_of_processor(lambda: study.evaluator().score(study.rig), ROUNDS)
    work = f"{len(states)} states in {len(weathers)} weathers, {SAMPLES:,} samples, processor time"
    return Timing(work, mine, peak_mb(), "one score", yardstick_s=one)
