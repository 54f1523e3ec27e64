"""Equations 4 to 9 and fusion, worked by hand; planes against them; own curves."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import (
    POINTPILLARS,
    RTM3D,
    average_precision,
    entropy_of,
    late_fusion,
    perception_entropy,
    precision_of,
    sigma_of,
)
from pe_core.metric.entropy import ap_of_entropy
from pe_core.metric.fusion import DIGITS, Fusion, PlaneFusion, VisibleRows, group_sum
from pe_core.sensors.lidar.kernel_voxels import compact
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused

# Entropies as test_by_hand.py derives them: no, one, two, three beams; 100 pixels; fused late.
H0 = 16.651386624
H1 = 1.520194952
H2 = 0.484427819
H3 = -0.277049759
HC = 3.580001643
H1_1 = 0.827047906
H1_C = 1.400211369
H2_C = 0.440172737
H1_1_C = 0.765257677
SATURATED = -10.975632491
F = 1.0 / 998_001.0
"""1 / 999^2: what a blind sensor is worth."""
BEAMS = ("lidar", np.array([0, 1, 0, 2, 300], np.uint16))
MORE = ("lidar", np.array([0, 1, 1, 0, 0], np.uint8))
PIXELS = ("camera", np.array([0.0, 100.0, 100.0, 100.0, 0.0]))
IMPOSSIBLE_MODELS = [
    ("blind", {"blind": "maybe"}),
    ("kind", {"sonar": POINTPILLARS}),
    ("lidar", {"lidar": (0.2, 0.5)}),
]
SHAPE = (60, 50)
ROUNDING = 2.0**-DIGITS
BETTER = pe.ApCurve(0.2, 0.8)
SPACE = pe.PerceptionSpace((-6, 10), (-5, 5), (0, 2), 0.5)


def fused(groups, **model):
    entropies, seen = Fusion(pe.PerceptionModel(**model)).entropies(groups)
    return entropies.tolist(), seen.tolist()


@pytest.mark.parametrize(
    ("groups", "expected", "seen"),
    [
        ([BEAMS], [H0, H1, H0, H2, SATURATED], [0, 1, 0, 1, 1]),
        ([PIXELS], [H0, HC, HC, HC, H0], [0, 1, 1, 1, 0]),
        ([BEAMS, PIXELS], [H0, H1_C, HC, H2_C, SATURATED], [0, 1, 1, 1, 1]),
        ([PIXELS, BEAMS], [H0, H1_C, HC, H2_C, SATURATED], [0, 1, 1, 1, 1]),
        ([BEAMS, MORE], [H0, H1_1, H1, H2, SATURATED], [0, 1, 1, 1, 1]),
        ([BEAMS, MORE, PIXELS], [H0, H1_1_C, H1_C, H2_C, SATURATED], [0, 1, 1, 1, 1]),
    ],
)
def test_entropies_of_a_sample(groups, expected, seen):
    entropies, found = fused(groups)
    assert entropies == pytest.approx(expected, abs=1e-8)
    assert found == [bool(s) for s in seen]


def test_by_the_letter_every_group_is_worth_something():
    """Two groups: where neither sees anything, 1 / sigma^2 is 2 f, and H is less by ln 2."""
    entropies, seen = fused([BEAMS, PIXELS], blind="literal")
    one = -math.log(3.734754603 + 0.4761013265) + H0 + math.log(F)
    two = -math.log(10.5217995 + 0.4761013265) + H0 + math.log(F)
    only = -math.log(0.4761013265 + F) + H0 + math.log(F)
    assert entropies[:4] == pytest.approx([H0 - math.log(2.0), one, only, two], abs=1e-8)
    assert seen == [False, True, True, True, True]
    assert fused([BEAMS], blind="literal")[0][0] == pytest.approx(H0)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_entropies_of_a_plane(kind):
    """A plane of 3 x 2 voxels and, before it, one that must not be taken for it.

    Single precision is looked at to 11 binary digits: 1.1e-4 in H at 100 pixels.
    """
    beams = np.array([[[9, 9], [9, 9], [9, 9]], [[0, 1], [2, 0], [1, 3]]], np.uint16)
    area = np.array([[[7.0, 7.0]], [[100.0, 0.0]]], kind)
    groups = [("lidar", beams), ("camera", VisibleRows(slice(1, 2), area))]
    fusion = PlaneFusion(Fusion(pe.PerceptionModel()), (3, 2))
    expected = [[H0, H1], [H2_C, H0], [H1, H3]]
    np.testing.assert_allclose(fusion.entropies(groups, 1), expected, atol=2e-4)
    seen = [[False, True], [True, False], [True, True]]
    assert fusion.seen(groups, 1).tolist() == seen
    assert fusion.seen(groups[1:], 1).tolist() == [[False] * 2, [True, False], [False] * 2]
    alone = fusion.entropies(groups[1:], 1)
    np.testing.assert_allclose(alone, [[H0, H0], [HC, H0], [H0, H0]], atol=2e-4)


def test_rows_seen_add_up_where_they_overlap():
    left = VisibleRows(slice(2, 4), np.full((1, 2, 1), 1.0, np.float32))
    right = VisibleRows(slice(3, 6), np.full((1, 3, 1), 10.0, np.float32))
    none = VisibleRows(slice(0, 0), np.zeros((1, 0, 1), np.float32))
    for both in (left + right, right + left):
        assert both.rows == slice(2, 6) and both.m.dtype == np.float32
        assert both.m[0, :, 0].tolist() == [1.0, 11.0, 10.0, 10.0]
    assert left + none is left and none + left is left
    assert (left + VisibleRows(slice(2, 4), np.ones((1, 2, 1)))).m.dtype == np.float64


def test_late_fusion_by_hand():
    """f + (5 f - f) + (1 - f) above the floor; 5 f + 1 by the letter."""
    assert float(late_fusion([5.0 * F, 1.0])) == pytest.approx(1.0 + 4.0 * F, abs=1e-15)
    assert float(late_fusion([5.0 * F, 1.0], "literal")) == pytest.approx(1.0 + 5.0 * F, abs=1e-15)


def test_whole_numbers_are_looked_up_as_far_as_they_matter():
    """AP is clipped from 9.36 beams on: 10 are enough; a flat curve needs all that 16 bits hold."""
    fusion = Fusion(pe.PerceptionModel())
    assert fusion.saturation_count("lidar") == 10
    assert fusion.precision(np.array([0, 10, 65_535]), "lidar").tolist() == pytest.approx(
        [F, 998_001.0, 998_001.0]
    )
    assert fusion.precision(np.array([100.0]), "camera")[0] == pytest.approx(0.4761013265)
    flat = Fusion(pe.PerceptionModel(lidar=pe.ApCurve(1e-4, 0.5)))
    assert flat.saturation_count("lidar") == 65_535


def test_impossible_models_are_refused():
    assert wrongly_refused(lambda v: pe.PerceptionModel(**v), IMPOSSIBLE_MODELS) == []


def test_a_curve_too_flat_to_saturate_says_so():
    """exp(700) is about as far as a number goes: (0.999 - 0.5) / 700 = 0.000713."""
    assert pe.ApCurve(1e-4, 0.5).saturation == math.inf
    assert pe.ApCurve(0.499 / 700.5, 0.5).saturation == math.inf
    assert pe.ApCurve(0.00072, 0.5).saturation == pytest.approx(math.exp(0.499 / 0.00072))
    assert pe.ApCurve(1.0, -1.0).saturation == pytest.approx(math.exp(1.999))


def test_sums_of_a_group_hold_what_their_parts_add_up_to():
    """Bytes add up in 16 bits, longer counts in 32, areas as they are."""
    byte = np.full(2, 250, np.uint8)
    word = np.full(2, 60_000, np.uint16)
    assert group_sum([byte, byte, byte]).tolist() == [750, 750]
    assert group_sum([word, word]).tolist() == [120_000, 120_000]
    assert group_sum([byte, word]).tolist() == [60_250, 60_250]
    assert group_sum([np.array([1.5]), np.array([2])]).tolist() == [3.5]


@pytest.mark.parametrize("blind", ["floor", "literal"])
@pytest.mark.parametrize("shape", [(1000,), (40, 25), (0,)])
def test_voxels_taken_by_index_have_the_bits_of_those_taken_by_flags(blind, shape):
    """The plain way: every group's m, at the voxels that a group beside the counted one sees."""
    rng = np.random.default_rng(3)
    counts = rng.integers(0, 30, shape) * (rng.random(shape) < 0.7)
    areas = [rng.exponential(50.0, shape) * (rng.random(shape) < share) for share in (0.2, 0.4)]
    groups = [("lidar", counts.astype(np.uint32)), *(("camera", m) for m in areas)]
    fusion = Fusion(pe.PerceptionModel(blind))
    entropies, seen = fusion.entropies(groups)
    flags = (areas[0] > 0.0) | (areas[1] > 0.0) if blind == "floor" else np.ones(shape, bool)
    precisions = [fusion.precision(m[flags], kind) for kind, m in groups]
    assert np.array_equal(entropies[flags], entropy_of(late_fusion(precisions, blind)))
    alone = fusion.tables("lidar").entropy[np.minimum(counts, fusion.saturation_count("lidar"))]
    assert np.array_equal(entropies[~flags], alone[~flags])
    assert np.array_equal(seen, (counts > 0) | (areas[0] > 0.0) | (areas[1] > 0.0))


def test_average_precision_is_the_paper_s_line_clipped():
    ap = average_precision([0, 1, math.e, 1000], POINTPILLARS)
    assert ap == pytest.approx([0.001, 0.659, 0.811, 0.999])
    assert average_precision(1e-9, RTM3D) == pytest.approx(0.001)


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


def beams(rng, dtype=np.uint16):
    return rng.integers(0, 13, (2, *SHAPE)).astype(dtype)


def view(rng, rows):
    """Areas from far below the least to more than an image, and a quarter of none."""
    shape = (2, rows.stop - rows.start, SHAPE[1])
    area = np.exp2(rng.uniform(-12.0, 24.0, shape)) * (rng.random(shape) < 0.75)
    return VisibleRows(rows, area.astype(np.float32))


def whole(measured, factor=1.0):
    if not isinstance(measured, VisibleRows):
        return measured.astype(float)
    area = np.zeros((2, *SHAPE))
    area[:, measured.rows] = measured.m * factor
    return area


def by_equations(groups, model, factor=1.0):
    """Entropies with all areas times a factor."""
    precisions = [precision_of(whole(m, factor), model.curve(kind)) for kind, m in groups]
    return entropy_of(late_fusion(precisions, model.blind))


def rigs():
    rng = np.random.default_rng(3)
    ahead, behind, none = (view(rng, slice(*r)) for r in ((5, 40), (30, 60), (0, 0)))
    lidar = ("lidar", beams(rng))
    other = ("lidar", beams(rng, np.uint8))
    return {
        "lidar": [lidar],
        "camera": [("camera", ahead)],
        "nothing in view": [("camera", none)],
        "lidar and camera": [lidar, ("camera", ahead)],
        "camera first": [("camera", none), ("camera", behind), other],
        "views overlap": [lidar, ("camera", ahead), ("camera", behind)],
        "all": [lidar, other, ("camera", ahead), ("camera", behind), ("camera", none)],
    }


@pytest.mark.parametrize("blind", ["floor", "literal"])
@pytest.mark.parametrize("rig", rigs())
def test_planes_equal_the_equations_within_the_rounding_of_areas(rig, blind):
    groups = rigs()[rig]
    model = pe.PerceptionModel(blind=blind)
    fusion = PlaneFusion(Fusion(model), SHAPE)
    found = np.stack([fusion.entropies(groups, plane) for plane in range(2)])
    most, least = (by_equations(groups, model, 1.0 + k * ROUNDING) for k in (-1.0, 1.0))
    assert (found <= most + 1e-9).all() and (found >= least - 1e-9).all()
    seen = np.stack([fusion.seen(groups, plane) for plane in range(2)])
    assert (seen == (sum(whole(m) for _, m in groups) > 0)).all()


def test_the_rounding_of_areas_averages_out():
    """A plane of areas from 0.1 to 1000 px, as cameras have: the mean is off by less than 1e-5."""
    area = np.exp2(np.random.default_rng(5).uniform(-3.3, 10.0, (1, 300, 500))).astype(np.float32)
    fusion = PlaneFusion(Fusion(pe.PerceptionModel()), (300, 500))
    found = fusion.entropies([("camera", VisibleRows(slice(0, 300), area))], 0)
    plain = entropy_of(precision_of(area[0], RTM3D))
    assert np.abs(found - plain).max() < 3e-3
    assert abs(found.mean() - plain.mean()) < 1e-5


def rig(curve, kind_wide=False):
    """Two LiDARs that fuse early and a camera, the LiDARs with a curve of their own."""
    own = None if kind_wide else curve
    lidar = shapes.small_lidar()
    return pe.Rig(
        [
            pe.Sensor("a", lidar, pe.Pose((0.0, 0.0, 1.9)), fusion=None, curve=own),
            pe.Sensor("b", lidar, pe.Pose((1.0, 0.5, 1.9)), fusion=None, curve=own),
            shapes.camera(),
        ]
    )


@pytest.mark.parametrize("samples", [0, 1024])
def test_sensors_of_one_kind_with_two_curves_are_fused_late(samples):
    """Of two LiDARs in one place each counts by its own curve: alone as that curve scores it."""
    lidar = shapes.small_lidar()
    pose = pe.Pose((0.0, 0.0, 1.9))
    two = pe.Rig([pe.Sensor("a", lidar, pose, "a", curve=BETTER), pe.Sensor("b", lidar, pose, "b")])
    evaluator = pe.Evaluator(SPACE, pe.Prior.uniform(), None, samples=samples)
    own = evaluator.score(two).per_sensor
    plain = evaluator.entropy(pe.Rig([two["b"]]))
    assert own["b"].entropy == plain
    assert own["a"].entropy == evaluator.entropy(pe.Rig([two["a"]])) < plain


def test_a_group_has_one_curve():
    lidar = shapes.small_lidar()
    with pytest.raises(pe.InputError, match="'lidar': expected one AP curve, found two"):
        pe.Rig([pe.Sensor("a", lidar, curve=BETTER), pe.Sensor("b", lidar)])


def test_curves_of_objects_are_by_kind_and_class():
    model = pe.PerceptionModel(objects={"lidar": {"tram": BETTER}})
    assert model.object_curve("lidar", "tram") == BETTER
    with pytest.raises(pe.InputError, match=r"\[ap.objects.lidar.bus\]: expected a and b of 'bus'"):
        model.object_curve("lidar", "bus")
    with pytest.raises(pe.InputError, match=r"objects.lidar.tram: expected an ApCurve, found 5"):
        pe.PerceptionModel(objects={"lidar": {"tram": 5}})
