"""Equations 4 to 9 at round numbers that a hand can check."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import (
    BLIND_PRECISION,
    H_BLIND,
    POINTPILLARS,
    RTM3D,
    average_precision,
    early_fusion,
    entropy_of,
    late_fusion,
    perception_entropy,
    precision_of,
    sigma_of,
)
from pe_core.metric.entropy import ap_of_entropy
from pe_core.metric.fusion import Fusion
from pe_core.sensors.lidar.kernel_voxels import compact


def test_average_precision_is_the_paper_s_line_clipped():
    ap = average_precision([0, 1, math.e, 1000], POINTPILLARS)
    assert ap == pytest.approx([0.001, 0.659, 0.811, 0.999])
    assert average_precision(1e-9, RTM3D) == pytest.approx(0.001)


def test_sigma_of_ap():
    assert sigma_of([0.5, 0.8, 0.001]) == pytest.approx([1.0, 0.25, 999.0])


def test_entropy_of_a_blind_and_of_a_saturated_voxel():
    assert pytest.approx(16.651386623858684) == H_BLIND
    assert entropy_of(precision_of(1000, POINTPILLARS)) == pytest.approx(-10.976, abs=1e-3)
    assert entropy_of(1.0) == pytest.approx(1.0 + math.log(2.0 * math.pi))


def test_early_fusion_sums():
    assert early_fusion([[1, 2], [3, 4], [0, 1]]).tolist() == [4.0, 7.0]


def test_late_fusion_of_two_equal_sensors_halves_the_variance():
    fused = late_fusion([4.0, 4.0], "literal")
    assert fused == pytest.approx(8.0)
    assert entropy_of(fused) == pytest.approx(entropy_of(4.0) - math.log(2.0))


def test_blind_sensors_change_nothing_unless_the_letter_is_asked_for():
    blind = [BLIND_PRECISION] * 10
    assert late_fusion(blind) == pytest.approx(BLIND_PRECISION, rel=1e-12)
    literal = entropy_of(late_fusion(blind, "literal"))
    assert literal == pytest.approx(H_BLIND - math.log(10.0))
    seen = precision_of(2, POINTPILLARS)
    assert late_fusion([seen, *blind]) == pytest.approx(float(seen), rel=1e-12)


def test_one_sensor_is_the_paper_s_formula():
    m = np.array([0, 1, 3, 50])
    ap = np.clip(0.152 * np.log(np.maximum(m, 1)) + 0.659, 0.001, 0.999)
    ap[0] = 0.001
    expected = 2 * np.log(1 / ap - 1) + 1 + math.log(2 * math.pi)
    for blind in ("floor", "literal"):
        fused = late_fusion([precision_of(m, POINTPILLARS)], blind)
        assert entropy_of(fused) == pytest.approx(expected, abs=1e-6)


def test_perception_entropy_is_the_weighted_mean():
    assert perception_entropy([1.0, 4.0], [3.0, 1.0]) == pytest.approx(1.75)


@pytest.mark.parametrize("curve", [POINTPILLARS, pe.ApCurve(0.05, 0.1), pe.ApCurve(1e-4, 0.5)])
def test_look_up_tables_equal_the_equations(curve):
    fusion = Fusion(pe.PerceptionModel(lidar=curve))
    m = np.array([0, 1, 2, 5, 9, 10, 11, 200, 40_000, 65_535], np.uint16)
    plain = entropy_of(late_fusion([precision_of(m, curve)]))
    entropies, seen = fusion.entropies([("lidar", m)])
    np.testing.assert_allclose(entropies, plain, rtol=1e-12)
    assert seen.tolist() == [False] + [True] * 9


@pytest.mark.parametrize(
    ("curve", "kind"), [(POINTPILLARS, np.uint8), (pe.ApCurve(1e-4, 0.5), np.uint16)]
)
def test_compact_counts_give_the_same_entropies(curve, kind):
    fusion = Fusion(pe.PerceptionModel(lidar=curve))
    m = np.array([[0, 1, 9, 10, 255, 256, 40_000, 65_535]], np.uint16)
    small = compact(m, fusion.saturation_count("lidar"))
    assert small.dtype == kind and not np.shares_memory(small, m)
    plain, compacted = (fusion.entropies([("lidar", counts)])[0] for counts in (m, small))
    assert plain.tolist() == compacted.tolist()


def test_the_ap_of_an_entropy_is_the_one_it_comes_from():
    ap = np.array([0.001, 0.5, 0.8, 0.999])
    assert ap_of_entropy(entropy_of(sigma_of(ap) ** -2)) == pytest.approx(ap, rel=1e-9)
