"""The score on objects: by hand, against the equations, with and without traffic."""

import math
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring import sight
from pe_core.scoring.targets.object_metric import RINGS, SECTORS, ObjectSums, RingObjects
from pe_core.scoring.targets.object_metric import reach as reach_by_direction
from pe_core.scoring.targets.object_sampling import SampledObjects
from pe_core.sensors import KINDS, measure_objects
from pe_core.sensors.kind import SIZES, derived_object_curve
from pe_core.study import study_from_dict
from pe_tools.formats import fit_ap_curve, read_ap_table
from tests.engine import shapes

TABLES = Path(__file__).parents[2] / "docs" / "objects"
SPACE = pe.PerceptionSpace()
FEW = pe.TargetRule("objects", scenes=16)
ROAD = pe.Prior.road()
SENSOR = {"name": "roof", "model": "Pandar64", "position": [0, 0, 2]}
GOLDEN = (9.218613081, 0.205050669)
TRAM = pe.ObjectClass(
    "tram",
    (15.0, 2.5, 3.6),
    height_spread=0.3,
    decay_x=50.0,
    laplace_y=5.0,
    gauss_y=2.0,
    laplace_share=0.5,
)


def rig(*more):
    return pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(32, 360)), *more])


def scorer(prior=ROAD, targets=FEW, **more):
    return pe.ObjectEvaluator(SPACE, prior, None, targets=targets, **more)


@pytest.fixture(scope="module")
def whole():
    """An evaluator, and the score of a LiDAR and a camera on it."""
    evaluator = scorer()
    return evaluator, evaluator.score(rig(shapes.camera()))


def entropy_by_hand(a, b, m):
    """Equations 4, 5 and 8 of one group."""
    ap = min(max(a * math.log(m) + b, 0.001), 0.999)
    return 2.0 * math.log(1.0 / ap - 1.0) + 1.0 + math.log(2.0 * math.pi)


def test_two_boxes_by_hand():
    """A wall of 2 by 2 m that ends 10 m ahead meets beams at +-5.7 deg; one behind meets none."""
    elevations = np.radians([-4.0, -2.0, 0.0, 2.0, 4.0])
    ahead = pe.Lidar(
        "ahead",
        elevations,
        azimuth_count=360,
        max_range=50.0,
        azimuth_offsets=None,
        horizontal_fov=(-math.pi / 2, math.pi / 2),
    )
    boxes = [("car", 11.0, 0.0, 1.0, 2.0, 2.0, 2.0, 0.0), ("car", -9.0, 0.0, 1.0, 2.0, 2.0, 2.0, 0)]
    one = pe.Rig([pe.Sensor("eye", ahead, pe.Pose((0.0, 0.0, 1.0)))])
    score = scorer(pe.Prior.from_boxes(boxes)).score(one)
    m = 5 * 11  # channels times azimuths from -5 to 5 deg
    seen = entropy_by_hand(0.237, -0.516, m)
    assert score.entropy == pytest.approx((seen + 16.651) / 2, abs=1e-3)
    assert score.coverage == 0.5 and score.voxels == 0
    car = score.objects.per_class["car"]
    assert car.ap == pytest.approx((0.237 * math.log(m) - 0.516 + 0.001) / 2, abs=1e-6)
    assert car.points == {1: 0.5, 5: 0.5, 20: 0.5} and car.objects == 2
    assert score.per_zone["front"].entropy == pytest.approx(seen, abs=1e-6)
    assert 8.0 < car.reach["front"] < 10.0 and car.reach["rear"] == 0.0


def test_a_score_is_the_equations_on_every_object(whole):
    """Against eqs. 4 to 9 written out, from m by its definition."""
    evaluator, score = whole
    objects = evaluator.drawn.objects
    weights = evaluator.drawn.weights
    both = rig(shapes.camera())
    m = {s.kind: measure_objects(s, objects) for s in both}
    floor = 999.0**-2
    total = 0.0
    for k, label in enumerate(objects.labels.tolist()):
        precision = floor
        for kind, counted in m.items():
            curve = KINDS[kind].object_curves[objects.class_names[label]]
            value = counted[k]
            ap = min(max(curve.a * math.log(value) + curve.b, 1e-3), 0.999) if value else 1e-3
            precision += (1.0 / ap - 1.0) ** -2 - floor
        total += weights[k] * (1.0 + math.log(2.0 * math.pi) - math.log(precision))
    assert score.entropy == pytest.approx(total, abs=1e-8)
    assert score.coverage == pytest.approx(weights[(m["lidar"] > 0) | (m["camera"] > 0)].sum())


def test_what_is_reported_of_sensors_is_that_of_rigs_with_and_without_them(whole):
    evaluator, score = whole
    lidar, camera = rig(shapes.camera())
    alone = evaluator.score(pe.Rig([lidar]))
    assert score.per_sensor["roof"].entropy == alone.entropy
    assert score.per_sensor["camera"].lost == pytest.approx(alone.entropy - score.entropy)
    assert alone.per_sensor["roof"].lost == pytest.approx(16.6508 - alone.entropy, abs=1e-3)
    blind = evaluator.score(pe.Rig([camera])).objects.per_class["car"]
    assert blind.points == {} and blind.ap < score.objects.per_class["car"].ap


def test_parts_add_up(whole):
    _, score = whole
    parts = score.per_class.values()
    assert sum(p.share for p in parts) == pytest.approx(1.0)
    assert sum(p.share * p.entropy for p in parts) == pytest.approx(score.entropy, abs=1e-6)
    halves = [score.per_zone[z] for z in ("front", "rear")]
    assert sum(p.share * p.entropy for p in halves) == pytest.approx(score.entropy, abs=1e-6)
    found = score.objects
    assert sum(c.share * c.ap for c in found.per_class.values()) == pytest.approx(found.ap)
    assert found.objects == sum(c.objects for c in found.per_class.values())
    for one in found.per_class.values():
        assert list(one.reach) == list(SECTORS)
        assert 1.0 >= one.points[1] >= one.points[5] >= one.points[20] >= 0.0


def test_every_way_of_asking_gives_the_same_bits(whole):
    evaluator, score = whole
    both = rig(shapes.camera())
    moved = both.with_poses([pe.Pose((0.5, 0.0, 1.8)), both["camera"].pose])
    assert evaluator.entropy(both) == evaluator.summary(both).entropy == score.entropy
    together = evaluator.entropies([both, moved, pe.Rig([both["roof"]])])
    assert together == [scorer().entropy(r) for r in (both, moved, pe.Rig([both["roof"]]))]
    again = pickle.loads(pickle.dumps(evaluator))
    assert again.score(both).to_dict() == score.to_dict()


def test_traffic_hides_and_a_lone_object_is_hidden_by_none():
    """One object a scene: with traffic as without. Many: what traffic takes is never given."""
    alone = pe.Prior("road", ROAD.classes[:1], density={"car": 1.0})
    scores = [scorer(alone, replace(FEW, traffic=t)).score(rig()).to_dict() for t in (False, True)]
    assert [s["objects"].pop("traffic") for s in scores] == [False, True]
    assert scores[0] == scores[1]
    free, hidden = (scorer(targets=replace(FEW, traffic=t)).score(rig()) for t in (False, True))
    assert hidden.entropy > free.entropy and hidden.objects.ap < free.objects.ap
    for name, own in hidden.objects.per_class.items():
        assert own.ap <= free.objects.per_class[name].ap
        assert own.reach == free.objects.per_class[name].reach


@pytest.mark.parametrize("traffic", [False, True])
def test_sight_tells_the_same_reach_as_the_score(traffic):
    """Maps, views and tables of a study on objects have one reach; of one on voxels another."""
    targets = replace(FEW, traffic=traffic)
    both = rig(shapes.camera())
    score = scorer(targets=targets).score(both)
    view = pe.Sight(SPACE, ROAD, None, targets=targets)
    for name, own in score.objects.per_class.items():
        reach = view.reach(both, name)
        assert reach.distance.tolist() == list(own.reach.values())
        assert np.degrees(reach.bearings).tolist() == pytest.approx(np.arange(0.0, 360.0, 45.0))
        assert set(reach.per_sensor) == {"roof", "camera"}
        line = sight.reach_line(reach, reach.distance)
        away = np.hypot(*line.points.T)
        assert away == pytest.approx(np.repeat(reach.distance, 12))
    alone = view.reach(pe.Rig([both["roof"]]), "car").distance
    assert view.reach(both, "car").per_sensor["roof"].tolist() == alone.tolist()
    assert (view.reach(both, "car", ap=0.7).distance <= view.reach(both, "car").distance).all()
    assert pe.Sight(SPACE, ROAD, None).reach(both, "car").sector == 0.0


def test_the_standard_error_is_honest():
    """It is not below the scatter of other scrambles, and not three times as large."""
    evaluators = [scorer(shift=k / 12 + 0.02) for k in range(12)]
    found = [e.summary(rig()) for e in evaluators]
    scatter = np.std([each.entropy for each in found], ddof=1)
    told = np.mean([each.stderr for each in found])
    assert scatter / 1.5 < told < 3.0 * scatter


def test_the_standard_error_by_hand():
    """Scenes of two boxes and of one: 1, 3 and 8 nats by weights 1/4, 1/4, 1/2 are 5 in the mean.

    Off that by weight: -1 - 0.5 and 1.5; the root of 2 / (2 - 1) times the squares' sum 4.5 is 3.
    """
    ones = np.ones((3, 3))
    objects = pe.Objects(ones, ones, np.zeros(3), [0, 0, 0], class_names=["car"], scenes=[0, 0, 1])
    sums = ObjectSums(SampledObjects(objects, np.array([0.25, 0.25, 0.5]), 2))
    assert sums.standard_error(np.array([1.0, 3.0, 8.0]), 1) == pytest.approx(3.0)


def test_a_golden_case():
    """Figures of November 2026; they move only where a definition does."""
    score = scorer(targets=replace(FEW, traffic=True)).score(rig())
    assert (score.entropy, score.objects.ap) == pytest.approx(GOLDEN, abs=1e-8)


# --- curves -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["car", "pedestrian", "cyclist"])
def test_shipped_curves_are_those_that_fit_finds(name):
    curve = fit_ap_curve(read_ap_table(TABLES / f"{name}.csv")).curve
    shipped = KINDS["lidar"].object_curves[name]
    assert (shipped.a, shipped.b) == pytest.approx((curve.a, curve.b), abs=6e-4)


def test_a_curve_carried_over_is_the_voxel_s_where_the_object_has_its_share():
    """A car's silhouette is 552.5 times a voxel's, so m = 552.5 k has the AP of k on a voxel."""
    voxel = pe.ApCurve(0.055, 0.155)
    car = KINDS["camera"].object_curves["car"]
    for k in (2.0, 30.0):
        ap = car.a * math.log(552.5 * k) + car.b
        assert ap == pytest.approx(voxel.a * math.log(k) + voxel.b)
    assert derived_object_curve(voxel, (0.1, 0.1, 0.1)) == voxel
    assert {c.name: c.size for c in ROAD.classes} == SIZES


def test_a_class_without_a_curve_is_reported_unless_it_weighs_nothing():
    with_tram = pe.Prior("road", (*ROAD.classes, TRAM), density={"tram": 1})
    told = r"\[ap\.objects\.lidar\.tram\]: expected a and b of 'tram' as an object"
    with pytest.raises(pe.InputError, match=told):
        scorer(with_tram).score(rig())
    unweighed = replace(with_tram, focus=(pe.Focus(0.0, classes=["tram"]),))
    assert "tram" not in scorer(unweighed).score(rig()).objects.per_class
    own = pe.PerceptionModel(objects={"lidar": {"tram": pe.ApCurve(0.2, -0.4)}})
    assert scorer(with_tram, model=own).score(rig()).objects.per_class["tram"].ap > 0.0


def test_a_sensor_s_own_curve_is_of_voxels():
    own = replace(shapes.lidar_on_roof(), curve=pe.ApCurve(0.2, 0.5))
    with pytest.raises(pe.InputError, match=r"sensor 'roof': ap: expected none: objects have"):
        scorer().entropy(pe.Rig([own]))


# --- studies --------------------------------------------------------------------------------------


def test_a_study_s_keys_make_its_evaluator():
    metric = {"targets": "objects", "traffic": True, "scenes": 8}
    curves = {"objects": {"lidar": {"car": {"a": 0.3, "b": -0.5}}}}
    density = {"density": {"car": 2}, "classes": ["car"]}
    data = {"sensor": [SENSOR], "metric": metric, "ap": curves, "prior": density}
    study = study_from_dict(data)
    assert study.targets == pe.TargetRule("objects", True, 8)
    assert study.model.object_curve("lidar", "car") == pe.ApCurve(0.3, -0.5)
    evaluator = study.evaluator()
    assert len(evaluator.drawn.objects) == 16 and evaluator.targets.traffic
    assert study.scene_count(0) == study.scene_count(65_536) == 8


def test_reach_by_hand():
    """One object of each of two classes; the second in the third ring ahead, found by 0.8.

    Its ring is 10 to 15 m away; the next has no object, and 0: 0.5 is 3/8 of the way there.
    """
    ones = np.ones((2, 3))
    objects = pe.Objects(
        ones, ones, np.zeros(2), [0, 1], class_names=["car", "cone"], scenes=[0, 0]
    )
    rings = RingObjects(objects, np.array([0, (8 + 0) * RINGS + 2]))
    found = reach_by_direction(rings, 1, np.array([0.9, 0.8]))
    assert found == {name: 0.0 for name in SECTORS} | {"front": 5.0 * (2.5 + 0.3 / 0.8)}
