"""Scores: grid against definition, sample against grid, and what must hold for any rig."""

import math
from dataclasses import fields
from itertools import pairwise, product
from types import SimpleNamespace

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import average_precision, entropy_of, late_fusion, sigma_of
from pe_core.sensors import Voxels, kind_of
from tests.engine import shapes
from tests.engine.test_preview import CAR, rig_at
from tests.engine.test_preview import SPACE as FINE
from tests.thorough import THOROUGH, pairs

SPACE = shapes.small_space()
ROAD = pe.Prior.road()


def rig_of_all_kinds():
    return pe.Rig(
        [
            shapes.lidar_on_roof(shapes.small_lidar(32, 360), (0.3, 0.1, 1.9), (1, 2, 3), "front"),
            shapes.lidar_on_roof(shapes.small_lidar(32, 360), (-1.0, 0, 1.8), (0, 5, 90), "rear"),
            shapes.camera(60.0, (0.9, 0.0, 1.6), name="ahead"),
            shapes.camera(120.0, (-1.6, 0.0, 1.6), (0, 10, 180), name="behind"),
        ]
    )


@pytest.fixture(scope="module", params=[False, True], ids=["free", "on car"])
def defined(request):
    """A vehicle or none, a space, its voxels, and m of the rig of all kinds by the definition."""
    vehicle = shapes.box_car() if request.param else None
    space = pe.PerceptionSpace((-8, 8), (-6, 6), (0, 4), 0.5 if THOROUGH else 1.0)
    index = np.stack(np.unravel_index(np.arange(space.size), space.shape), axis=1)
    centers, rig = space.center_of(index), rig_of_all_kinds()
    measured = {s.name: pe.measure(s, centers, space.interval, vehicle) for s in rig}
    return SimpleNamespace(
        vehicle=vehicle, space=space, index=index, centers=centers, rig=rig, measured=measured
    )


def score_by_definition(defined, prior, model):
    """Entropy and coverage from `measure`, the equations, and nothing of the evaluator."""
    space, vehicle, index, centers = defined.space, defined.vehicle, defined.index, defined.centers
    weights = sum((d.ground[:, :, None] * d.profile).reshape(-1) for d in prior.densities(space))
    if vehicle is not None:
        top = vehicle.top(space)[index[:, 0], index[:, 1]]
        weights = np.where(centers[:, 2] < top, 0.0, weights)
    measured, precisions = defined.measured, []
    for members in defined.rig.groups.values():
        m = sum(measured[s.name] for s in members)
        ap = average_precision(m, model.curve(members[0].kind))
        precisions.append(sigma_of(ap) ** -2)
    entropy = entropy_of(late_fusion(precisions, model.blind))
    seen = sum(measured.values()) > 0
    return np.average(entropy, weights=weights), np.average(seen, weights=weights)


@pytest.mark.parametrize("blind", ["floor", "literal"])
def test_the_grid_score_is_the_definition_s(defined, blind):
    model = pe.PerceptionModel(blind=blind)
    score = pe.Evaluator(defined.space, ROAD, defined.vehicle, model=model).score(defined.rig)
    entropy, coverage = score_by_definition(defined, ROAD, model)
    assert score.entropy == pytest.approx(entropy, abs=1e-3)
    assert score.coverage == pytest.approx(coverage, abs=1e-9)
    assert score.stderr == 0.0


def test_the_sampled_score_agrees_with_the_grid_within_its_error():
    vehicle, rig = shapes.box_car(), rig_of_all_kinds()
    grid = pe.Evaluator(SPACE, ROAD, vehicle).score(rig)
    sampled = pe.Evaluator(SPACE, ROAD, vehicle, samples=30_000).score(rig)
    assert 0.0 < sampled.stderr < 0.05
    assert abs(sampled.entropy - grid.entropy) < 3 * sampled.stderr
    assert sampled.coverage == pytest.approx(grid.coverage, abs=0.01)
    for name, own in grid.per_sensor.items():
        other = sampled.per_sensor[name]
        assert other.entropy == pytest.approx(own.entropy, abs=0.15)
        assert (other.beams, other.occluded_by) == (own.beams, own.occluded_by)


def test_the_truth_lies_within_two_reported_errors():
    """Over 50 random shifts of the sequence, at least 90 times in 100."""
    rng = np.random.default_rng(11)
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(16, 180))])
    truth = pe.Evaluator(SPACE, ROAD, shapes.box_car()).entropy(rig)
    within = 0
    for shift in rng.random((50, 3)):
        evaluator = pe.Evaluator(SPACE, ROAD, shapes.box_car(), samples=4096, shift=tuple(shift))
        score = evaluator.score(rig)
        within += abs(score.entropy - truth) <= 2 * score.stderr
    assert within >= 45


def test_the_ground_map_averages_to_the_score():
    vehicle, rig = shapes.box_car(), rig_of_all_kinds()
    score = pe.Evaluator(SPACE, pe.Prior.uniform(), vehicle).score(rig)
    tops = vehicle.top(SPACE)
    mass = (SPACE.centers(2) >= tops[..., None]).sum(axis=-1)
    inside = mass == 0
    assert np.isnan(score.ground_map.entropy[inside]).all()
    mean = np.average(score.ground_map.entropy[~inside], weights=mass[~inside])
    assert mean == pytest.approx(score.entropy, abs=1e-4)


@pytest.mark.parametrize("samples", [0, 20_000], ids=["grid", "sampled"])
def test_a_further_sensor_never_makes_it_worse(samples):
    evaluator = pe.Evaluator(SPACE, ROAD, shapes.box_car(), samples=samples)
    sensors = rig_of_all_kinds().sensors
    entropies = [evaluator.entropy(pe.Rig(sensors[:n])) for n in range(1, 5)]
    assert all(b <= a for a, b in pairwise(entropies))


def test_workers_do_not_change_a_bit():
    rig = rig_of_all_kinds()
    scores = [
        pe.Evaluator(SPACE, ROAD, shapes.box_car(), workers=n).score(rig).to_dict() for n in (1, 3)
    ]
    assert scores[0] == scores[1]


def test_turning_rig_and_scene_together_changes_nothing():
    """Half a turn about z maps the symmetric space and prior onto themselves."""
    space = pe.PerceptionSpace((-10, 10), (-10, 10), (0, 4), 0.5)
    vehicle = shapes.box_car()
    turned = pe.Vehicle(vehicle.triangles * [-1, -1, 1], vehicle.parts, vehicle.part_names)
    position, pitch, yaw = (0.61, 0.27, 1.83), 4.0, 12.0
    there = shapes.lidar_on_roof(position=position, rotation=(0, pitch, yaw))
    back = shapes.lidar_on_roof(
        position=(-position[0], -position[1], position[2]), rotation=(0, pitch, yaw + 180)
    )
    a = pe.Evaluator(space, ROAD, vehicle).score(pe.Rig([there]))
    b = pe.Evaluator(space, ROAD, turned).score(pe.Rig([back]))
    assert a.entropy == pytest.approx(b.entropy, abs=2e-3)  # beams at 0 and 180 deg swap owners
    assert a.per_sensor["roof"].occluded == pytest.approx(b.per_sensor["roof"].occluded, abs=2)


def test_a_sensor_that_moved_and_came_back_scores_the_same():
    evaluator = pe.Evaluator(SPACE, ROAD, shapes.box_car(), samples=10_000)
    rig = rig_of_all_kinds()
    first = evaluator.entropy(rig)
    moved = rig.with_poses([pe.Pose((0.5, 0.2, 2.0)), *(s.pose for s in rig.sensors[1:])])
    assert evaluator.entropy(moved) != first
    assert evaluator.entropy(rig) == first
    assert pe.Evaluator(SPACE, ROAD, shapes.box_car(), samples=10_000).entropy(rig) == first


def test_no_warning_reaches_the_user(recwarn):
    blind = shapes.lidar_on_roof(shapes.small_lidar(), (-0.4, 0.0, 1.0))
    for samples in (0, 5000):
        score = pe.Evaluator(SPACE, ROAD, shapes.box_car(), samples=samples).score(pe.Rig([blind]))
        assert score.coverage < 0.01
    assert not recwarn.list


def test_a_vehicle_that_fills_the_space_is_refused():
    space = pe.PerceptionSpace((-1, 1), (-0.5, 0.5), (0, 1), 0.5)
    everything = pe.Vehicle(shapes.box((-3, -3, 0), (3, 3, 3)))
    with pytest.raises(pe.InputError, match="outside the vehicle"):
        pe.Evaluator(space, ROAD, everything)


def test_rigs_together_are_their_mean_unless_the_worst_is_asked_for():
    evaluator = pe.Evaluator(SPACE, ROAD, samples=1024)
    rigs = [pe.Rig([sensor]) for sensor in rig_of_all_kinds()]
    entropies = evaluator.entropies(rigs)
    assert len(set(entropies)) == 4
    mean = evaluator.evaluate_together(rigs, math.inf).entropy
    worst = evaluator.evaluate_together(rigs, math.inf, worst=True).entropy
    assert (mean, worst) == (pytest.approx(sum(entropies) / 4, abs=1e-8), max(entropies))


@pytest.mark.parametrize("at", [(0.0, 0.0, 1.75), (0.0, 0.0, 1.85), (-0.35, 0.0, 1.6)])
def test_beams_down_from_the_middle_are_stopped(at):
    space = pe.PerceptionSpace((-3, 3), (-3, 3), (0, 2), 0.5)
    index = np.stack(np.unravel_index(np.arange(space.size), space.shape), axis=1)
    sensor = shapes.lidar_on_roof(shapes.small_lidar(), at, (0, 0, 20))
    vehicle, centers = shapes.box_car(), space.center_of(index)
    exact = pe.measure(sensor, centers, space.interval, vehicle)
    assert exact.sum() < pe.measure(sensor, centers, space.interval).sum()
    sample = kind_of(sensor).on_sample(Voxels(space, index, centers), vehicle, 60000)
    assert (sample.measure(sensor, False).m == exact).all()


SAMPLES = 4096


def evaluator(samples=SAMPLES):
    return pe.Evaluator(FINE, pe.Prior.road(), CAR, samples=samples)


@pytest.mark.parametrize("preview", [False, True])
def test_a_summary_and_a_score_agree(preview):
    rig = rig_at((0.0, 0.0, 1.9))
    summary, score = (
        evaluator().summary(rig, preview=preview),
        evaluator().score(rig, preview=preview),
    )
    names = {field.name for field in fields(summary)} - {"ap"}
    assert names == {field.name for field in fields(score)} - {
        "per_sensor",
        "ground_map",
        "objects",
        "scatter",
    }
    assert {name: getattr(summary, name) for name in names} == {
        name: getattr(score, name) for name in names
    }
    assert summary.preview == preview and summary.ap is None


def test_a_summary_at_objects_has_the_ap_of_the_score():
    rule = pe.TargetRule("objects", traffic=True, scenes=8)
    evaluator = pe.ObjectEvaluator(FINE, pe.Prior.road(), CAR, targets=rule)
    rig = rig_at((0.0, 0.0, 1.9))
    assert evaluator.summary(rig).ap == evaluator.score(rig).objects.ap


def test_an_exact_summary_after_previews_is_that_of_a_new_evaluator():
    kept = evaluator()
    for x in (0.0, 0.1, 0.2):
        kept.summary(rig_at((x, 0.0, 1.9)), preview=True)
    rig = rig_at((0.2, 0.0, 1.9))
    assert kept.summary(rig) == evaluator().summary(rig)


def test_the_grid_has_one_as_well():
    on_grid, rig = evaluator(samples=0), rig_at((0.0, 0.0, 1.9))
    summary, score = on_grid.summary(rig), on_grid.score(rig, preview=True)
    assert summary.preview == score.preview is False
    assert (summary.entropy, summary.per_zone) == (score.entropy, score.per_zone)


EACH_SENSOR_SPACE = pe.PerceptionSpace((-12.0, 12.0), (-7.0, 7.5), (0.0, 2.5), 0.5)


def sensors(groups):
    """Two LiDARs and three cameras all round a car, in these fusion groups."""
    lidar, camera = shapes.small_lidar(16, 180), pe.Camera("eye", 640, 480, 1.2)
    placed = [
        ("roof", lidar, (-0.4, 0.0, 1.7), 0.0),
        ("nose", lidar, (2.0, 0.1, 0.9), 0.2),
        ("ahead", camera, (0.9, 0.0, 1.5), 0.0),
        ("left", camera, (0.0, 0.8, 1.4), 1.6),
        ("back", camera, (-1.9, 0.0, 1.4), 3.1),
    ]
    rows = zip(placed, groups, strict=True)
    return [pe.Sensor(n, m, pe.Pose(at, (0.0, 0.0, yaw)), g) for (n, m, at, yaw), g in rows]


RIGS = {
    "as usual": (None,) * 5,
    "all late": ("a", "b", None, None, None),
    "cameras early, too": (None, None, "eyes", "eyes", "eyes"),
    "some of them": ("a", "b", "eyes", "eyes", None),
}


@pytest.mark.parametrize(("name", "how"), pairs(RIGS, product(["floor", "literal"], [5, 2])))
def test_alone_and_failing_are_scores_of_other_rigs(name, how):
    """To the last digit that is kept: sums of the same values in another order are rounded away."""
    blind, count = how
    model = pe.PerceptionModel(blind)
    mounted = sensors(RIGS[name])[:count]
    study = pe.Study(pe.Rig(mounted), shapes.box_car(), EACH_SENSOR_SPACE, model=model)
    evaluator = study.evaluator(workers=2)
    score = evaluator.score(study.rig)
    assert score.entropy == evaluator.entropy(study.rig)
    for sensor in mounted:
        own = score.per_sensor[sensor.name]
        alone = evaluator.score(pe.Rig([sensor]))
        others = evaluator.entropy(pe.Rig([s for s in mounted if s is not sensor]))
        assert own.coverage == pytest.approx(alone.coverage, abs=1.01e-9)
        assert own.entropy == pytest.approx(alone.entropy, abs=1.01e-9)
        assert own.lost == pytest.approx(others - score.entropy, abs=1.01e-9)
        assert own.lost > 0.0 or blind == "literal"


def test_many_lidars_score_as_few_do():
    """More groups than are kept in bytes: each is still what it is alone."""
    lidar = shapes.small_lidar(16, 180)
    mounted = [pe.Sensor(f"{k}", lidar, pe.Pose((k - 2.0, 0.0, 1.8))) for k in range(5)]
    study = pe.Study(pe.Rig(mounted), shapes.box_car(), EACH_SENSOR_SPACE)
    evaluator = study.evaluator()
    score = evaluator.score(study.rig)
    assert score.entropy == evaluator.entropy(study.rig)
    for sensor in mounted:
        alone = evaluator.entropy(pe.Rig([sensor]))
        assert score.per_sensor[sensor.name].entropy == pytest.approx(alone, abs=1.01e-9)
