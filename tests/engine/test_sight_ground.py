"""The ground map: held to the definition of m, to the grid's own map, and to scenes by hand."""

import numpy as np
import pytest

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.metric.entropy import entropy_of, precision_of
from pe_core.metric.fusion import late_fusion
from pe_core.scoring.sight import Sight
from pe_core.scoring.sight.ground_cells import gauss
from pe_core.scoring.sight.visibility import SPREAD_M
from tests.engine import shapes

SPACE = shapes.small_space(0.5)
CAR = shapes.box_car()


def lidar(position=(-0.43, 0.11, 1.83), rotation=(0.0, 0.0, 0.0), name="roof", **options):
    return shapes.lidar_on_roof(shapes.small_lidar(**options), position, rotation, name)


def sight(vehicle=CAR, space=SPACE, prior=None):
    return Sight(space, prior or pe.Prior.road(), vehicle)


@pytest.mark.parametrize("height", [0.0, 0.7, 1.5, 4.9])
def test_places_as_wide_as_a_column_are_as_defined(height):
    """A place of one voxel has the entropy of that voxel's m, fused by the equations."""
    rig = pe.Rig([lidar(), lidar((1.9, 0.0, 1.2), (0, 5, 0), "bonnet"), shapes.camera()])
    ground = sight().ground(rig, height, step=0.5)
    z = 0.25 + 0.5 * int(height / 0.5)
    rng = np.random.default_rng(1)
    i = rng.integers(0, 80, 150)
    j = rng.integers(0, 40, 150)
    kept = ~np.isnan(ground.entropy[i, j])
    i = i[kept]
    j = j[kept]
    centers = np.stack([ground.x[i], ground.y[j], np.full(len(i), z)], axis=1)
    m = {s.name: kinds.measure(s, centers, 0.5, CAR) for s in rig}
    lidars = precision_of(m["roof"] + m["bonnet"], kinds.PerceptionModel().lidar)
    camera = precision_of(m["camera"], kinds.PerceptionModel().camera)
    assert ground.entropy[i, j] == pytest.approx(entropy_of(late_fusion([lidars, camera])), abs=0.1)
    seen = np.stack([m[s.name] > 0 for s in rig])
    assert np.array_equal(ground.coverage[i, j], seen.any(axis=0))
    assert np.array_equal(ground.sensors[i, j], seen.sum(axis=0))
    by_kind = (seen[0] | seen[1]).astype(int) + seen[2]
    assert np.array_equal(ground.kinds[i, j], by_kind)
    assert len(set(ground.sensors[i, j])) > 1


def test_a_place_under_the_vehicle_s_skin_is_the_vehicle_s():
    ground = sight().ground(pe.Rig([lidar()]), 0.0, step=0.5)
    inside = (np.abs(ground.x) < 2.3)[:, None] & (np.abs(ground.y) < 0.9)
    assert np.array_equal(np.isnan(ground.entropy), inside)
    assert np.array_equal(np.isnan(ground.coverage), inside)
    assert np.array_equal(ground.sensors == -1, inside)
    assert np.array_equal(ground.kinds == -1, inside)
    above = sight().ground(pe.Rig([lidar()]), 2.0, step=0.5)
    assert not np.isnan(above.entropy).any()


def test_averaged_over_height_it_is_the_grid_s_own_map():
    """Mass-weighted, the means of many small places are the exact score's; each is spread alike."""
    rig = pe.Rig([lidar(), shapes.camera()])
    prior = pe.Prior.road()
    score = pe.Evaluator(SPACE, prior, CAR).score(rig)
    ground = sight(prior=prior).ground(rig, step=0.125)
    exact = score.ground_map

    def squares(values):
        return values.reshape(80, 4, 40, 4).mean(axis=(1, 3))

    mass = exact.mass / exact.mass.sum()
    for name in ("entropy", "coverage"):
        found = squares(getattr(ground, name))
        whole = getattr(exact, name)
        scale = 1.0 if name == "entropy" else 0.04  # 27 nats from nothing to all
        assert (found * mass).sum() == pytest.approx((whole * mass).sum(), abs=0.05 * scale)
        spread = gauss(whole * mass, SPREAD_M / 0.5) / gauss(mass, SPREAD_M / 0.5)
        assert found == pytest.approx(spread, abs=2.0 * scale)
        assert np.mean(np.abs(found - spread)) < 0.25 * scale


def test_a_wide_place_is_the_mean_of_what_is_in_it():
    rig = pe.Rig([lidar(channels=64, azimuths=720)])
    own = sight(space=shapes.small_space(0.25))
    fine = own.ground(rig, 0.5, step=0.25)
    coarse = own.ground(rig, 0.5, step=2.0)
    means = fine.entropy.reshape(20, 8, 10, 8).mean(axis=(1, 3))
    outside = ~np.isnan(means)
    assert outside.sum() > 180
    assert coarse.entropy.shape == (20, 10)
    assert np.mean(np.abs(coarse.entropy - means)[outside]) < 1.5
    assert coarse.x[:2] == pytest.approx([-19.0, -17.0])


def test_where_no_object_is_ever_met_there_is_a_map_all_the_same():
    """Labelled boxes leave most of the ground without mass: it is looked at as elsewhere."""
    row = {"x": 8.0, "y": 3.0, "z": 0.75, "length": 4.0, "width": 2.0, "height": 1.5, "yaw": 0.0}
    boxes = pe.Boxes.of({"class": ["car"], **{name: [value] for name, value in row.items()}})
    ground = sight(prior=pe.Prior.from_boxes(boxes)).ground(pe.Rig([lidar()]))
    assert np.isfinite(ground.entropy).sum() > 760
    assert 0.0 < np.nanmean(ground.coverage) < 1.0


def test_where_objects_are_met_places_without_any_do_not_count():
    """Means are spread over the prior's mass: in a row of one box, by the heights of that box."""
    low = {"x": 8.25, "y": 3.25, "z": 0.25, "length": 0.5, "width": 0.5, "height": 0.5, "yaw": 0.0}
    boxes = pe.Boxes.of({"class": ["car"], **{name: [value] for name, value in low.items()}})
    ring = shapes.lidar_on_roof(shapes.small_lidar(40, 720), (8.25, 3.25, 4.75))
    own = sight(None, prior=pe.Prior.from_boxes(boxes))
    ground = own.ground(pe.Rig([ring]), step=0.5)
    at = np.argmin(np.abs(ground.x - 8.25)), np.argmin(np.abs(ground.y - 3.25))
    layer = own.ground(pe.Rig([ring]), 0.0, step=0.5)
    assert ground.coverage[at] == pytest.approx(layer.coverage[at], abs=1e-6)


def test_within_looks_at_a_square_alone():
    own = sight()
    rig = pe.Rig([lidar()])
    part = own.ground(rig, 0.5, step=0.5, within=5.0)
    whole = own.ground(rig, 0.5, step=0.5)
    assert part.entropy.shape == (20, 20) and (part.x[0], part.x[-1]) == (-4.75, 4.75)
    assert np.array_equal(part.entropy, whole.entropy[30:50, 10:30], equal_nan=True)
    wide = own.ground(rig, 0.5, step=0.5, within=500.0)
    assert np.array_equal(wide.x, whole.x) and np.array_equal(wide.y, whole.y)
    assert np.array_equal(wide.entropy, whole.entropy, equal_nan=True)
