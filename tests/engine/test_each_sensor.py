"""Each sensor alone and failing, found in one pass, is what rigs of their own score."""

from itertools import product

import pytest

import pe_core as pe
from tests.engine import shapes
from tests.thorough import pairs

SPACE = pe.PerceptionSpace((-12.0, 12.0), (-7.0, 7.5), (0.0, 2.5), 0.5)


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
    study = pe.Study(pe.Rig(mounted), shapes.box_car(), SPACE, model=model)
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
    study = pe.Study(pe.Rig(mounted), shapes.box_car(), SPACE)
    evaluator = study.evaluator()
    score = evaluator.score(study.rig)
    assert score.entropy == evaluator.entropy(study.rig)
    for sensor in mounted:
        alone = evaluator.entropy(pe.Rig([sensor]))
        assert score.per_sensor[sensor.name].entropy == pytest.approx(alone, abs=1.01e-9)
