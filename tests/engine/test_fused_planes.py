"""Fusing whole planes by look-up against the equations."""

from types import SimpleNamespace

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import RTM3D, entropy_of, late_fusion, precision_of
from pe_core.metric.fusion import DIGITS, Fusion, PlaneFusion, VisibleRows
from tests.engine import shapes

SHAPE = (60, 50)
ROUNDING = 2.0**-DIGITS


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
    lidar, other = ("lidar", beams(rng)), ("lidar", beams(rng, np.uint8))
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
    groups, model = rigs()[rig], pe.PerceptionModel(blind=blind)
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


@pytest.fixture(scope="module")
def two_cameras():
    """A LiDAR and two cameras with a common view, and m of each by the definition."""
    cameras = [
        shapes.camera(80.0, (0.9, side, 1.6), (0, 5, 20 * side), name)
        for name, side in (("left", 0.5), ("right", -0.5))
    ]
    sensors = [shapes.lidar_on_roof(shapes.small_lidar(32, 360)), *cameras]
    space, vehicle = pe.PerceptionSpace((-12, 12), (-8, 8), (0, 4), 0.5), shapes.box_car()
    index = np.stack(np.unravel_index(np.arange(space.size), space.shape), axis=1)
    centers = space.center_of(index)
    weights = sum(
        (d.ground[:, :, None] * d.profile).reshape(-1) for d in pe.Prior.road().densities(space)
    )
    weights = weights * (centers[:, 2] >= vehicle.top(space)[index[:, 0], index[:, 1]])
    measured = {s.name: pe.measure(s, centers, space.interval, vehicle) for s in sensors}
    return SimpleNamespace(
        sensors=sensors, space=space, vehicle=vehicle, weights=weights, measured=measured
    )


@pytest.mark.parametrize("groups", [("", ""), ("one", "one")], ids=["late", "early"])
def test_cameras_with_a_common_view_fuse_as_their_group_says(groups, two_cameras):
    lidar, *cameras = two_cameras.sensors
    cameras = [pe.Sensor(c.name, c.model, c.pose, g) for c, g in zip(cameras, groups, strict=True)]
    rig = pe.Rig([lidar, *cameras])
    grid = pe.Evaluator(two_cameras.space, pe.Prior.road(), two_cameras.vehicle).score(rig)
    model = pe.PerceptionModel()
    precisions = [
        precision_of(sum(two_cameras.measured[s.name] for s in own), model.curve(own[0].kind))
        for own in rig.groups.values()
    ]
    assert len(precisions) == (3 if groups[0] == "" else 2)
    entropy = np.average(entropy_of(late_fusion(precisions)), weights=two_cameras.weights)
    assert grid.entropy == pytest.approx(entropy, abs=1e-3)
