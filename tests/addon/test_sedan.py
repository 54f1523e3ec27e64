"""The example vehicle, as it is shipped."""

from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from tests.addon import scenes

ROOF_M = 1.45


@pytest.fixture
def study(addon):
    """The sedan with its roof LiDAR, judged on few voxels."""
    return replace(scenes.shipped_study("sedan"), samples=16_384)


def test_its_size_and_parts(study):
    low, high = study.vehicle.bounds
    assert low[[0, 2]] == pytest.approx([-2.35, 0.0], abs=2e-3)
    assert high[[0, 2]] == pytest.approx([2.35, ROOF_M], abs=2e-3)
    body = study.vehicle.parts == study.vehicle.part_names.index("body")
    assert np.ptp(study.vehicle.triangles[body][..., 1]) == pytest.approx(1.85, abs=2e-3)
    assert {"hood", "roof", "windshield", "wheel_front_left"} <= set(study.vehicle.part_names)
    assert "windshield" in study.vehicle.glass


def test_pandar64_scores_better_than_hdl64e_in_its_place(study):
    (sensor,) = study.rig
    assert sensor.model.name == "Pandar64"
    other = pe.Rig([replace(sensor, model=pe.catalog.load("HDL-64E"))])
    evaluator = study.evaluator()
    assert evaluator.entropy(study.rig) < evaluator.entropy(other) - 1.0


def test_the_best_height_lies_above_the_roof_unprompted(study):
    schedule = pe.Schedule(candidates=12)
    search = replace(study.search, samples=4096, schedule=schedule, method="random")
    job = pe.OptimizeJob(replace(study, search=search, samples=4096), 1)
    for _ in job:
        pass
    outcome = job.outcome
    assert outcome.after.entropy < outcome.before.entropy
    assert outcome.study.rig.sensors[0].pose.position[2] >= ROOF_M
