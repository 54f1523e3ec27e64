"""The study files of the experiments are Table II of the paper."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studies.paper.paper import (
    PRIORS,
    ROW,
    ROWS,
    study_of,
    with_pitch_difference,
    with_positions,
    with_prior,
    without_cameras,
)

TABLE_2 = {
    "1_pandar64": [("Pandar64", -0.43, 0.0, 1.80, 0.0)],
    "1_hdl64e": [("HDL-64E", -0.37, 0.0, 2.12, 0.0)],
    "2_60deg": [("Camera 60 deg", 1.00, 0.0, 1.19, 1.0)],
    "2_120deg": [("Camera 120 deg", 0.84, 0.0, 1.27, 6.1)],
    "3_default": [("Pandar40", 3.03, -1.01, 1.16, -0.3), ("Pandar40", -3.03, 1.01, 0.85, 3.2)],
    "3_front": [("Pandar40", 3.03, 1.01, 1.05, 0.3), ("Pandar40", 3.03, -1.01, 1.03, 0.1)],
    "4_cameras": [
        ("Pandar40", 3.03, 1.01, 0.91, 1.2),
        ("Pandar40", 3.03, -1.01, 0.84, 3.0),
        ("Camera 30 deg", 2.90, 0.0, 1.66, 1.4),
        ("Camera 60 deg", -2.90, 0.0, 1.52, 7.2),
    ],
}
DOUBLED = {"2_60deg": "far", "2_120deg": "far", "3_front": "front", "4_cameras": "front"}


@pytest.mark.parametrize("row", TABLE_2)
def test_sensors_are_at_the_printed_placements(row):
    rig = study_of(row).rig
    found = [(s.model.name, *s.pose.position, s.pose.rotation_deg[1]) for s in rig]
    assert found == TABLE_2[row]
    assert all(s.pose.rotation_deg[0] == 0.0 for s in rig)
    yaws = [s.pose.rotation_deg[2] for s in rig]
    assert yaws == ([0.0, 0.0, 0.0, 180.0] if row == "4_cameras" else [0.0] * len(rig))


@pytest.mark.parametrize("row", TABLE_2)
def test_the_vehicle_and_the_search_are_the_papers(row):
    study = study_of(row)
    size = np.ptp(study.vehicle.triangles.reshape(-1, 3), axis=0)
    if row[0] in "34":
        assert size[:2] == pytest.approx([6.06, 2.02], abs=2e-3)
        assert size[2] == pytest.approx(2.6, abs=0.1)
    assert study.search.schedule.candidates == 1000 and len(study.search.schedule.scales) == 7
    assert all(axes == ("x", "y", "z", "pitch") for axes in study.search.free.values())
    assert study.vehicle.glass  # cameras see through the windows


@pytest.mark.parametrize("row", TABLE_2)
def test_weights_are_doubled_where_the_paper_says(row):
    study = study_of(row)
    plain = with_prior(study, "uniform").prior
    space = replace(study.space, interval=1.0)
    ground = plain.densities(space)[0].ground
    x = space.centers(0)
    doubled = {"far": np.abs(x) > 40.0, "front": x > 0.0, None: np.zeros(len(x), bool)}
    expected = np.where(doubled[DOUBLED.get(row)], 2.0, 1.0)
    assert ground / ground.min() == pytest.approx(np.broadcast_to(expected[:, None], ground.shape))


def test_every_row_has_neutral_starts_for_all_its_sensors():
    assert [row.name for row in ROWS] == list(TABLE_2)
    for row in ROWS:
        for places in row.starts.values():
            started = with_positions(study_of(row.name), places)
            assert [s.pose.position for s in started.rig] == list(places.values())
            assert all(s.pose.rotation_deg[1] == 0.0 for s in started.rig)
            started.search_space()  # the start lies within the bounds


def test_priors_keep_the_focus():
    study = study_of("3_front")
    for prior in PRIORS:
        assert with_prior(study, prior).prior.focus == study.prior.focus
        assert with_prior(study, prior).prior.model == prior


def test_variations_of_a_study():
    assert [s.name for s in without_cameras(study_of("4_cameras")).rig] == ["lidar_a", "lidar_b"]
    first, second = with_pitch_difference(study_of("3_front"), 1.2, 0.35).rig
    assert (first.pose.position[2], second.pose.position[2]) == (1.2, 1.2)
    assert (first.pose.rpy[1], second.pose.rpy[1]) == (0.0, math.radians(0.35))
    assert ROW["4_cameras"].experiment == 4
