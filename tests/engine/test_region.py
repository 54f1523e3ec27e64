"""The free region of a sensor: its patch, held to scores at points inside and outside of it."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import search
from pe_core.geometry.surfaces import area_of, cut_below, divided
from pe_core.scene.vehicle import closest_points
from pe_core.study import load_study
from pe_tools import advice
from pe_tools.cli.verbs import main
from pe_tools.jobs import RegionJob, study_on_region
from tests.engine import shapes

ROOF = "roof"
OTHER_SHIFT = (0.21, 0.83, 0.47)


@pytest.fixture(scope="module")
def study():
    """A LiDAR on the roof of a box and a camera at its front."""
    car = shapes.box_car()
    lidar = pe.Sensor("roof", shapes.small_lidar(8, 90), pe.Pose((0.4, 0.0, 1.6), (0, 0, 0)))
    rig = pe.Rig([lidar, shapes.camera(position=(2.2, 0.0, 1.2), name="front")])
    mount = search.SurfaceMount(car.part_names, standoff=0.1)
    mounting = search.Mounting({"top": mount}, {"roof": "top"})
    base = pe.Study(rig, car, shapes.small_space(), samples=65_536)
    return replace(base, search=replace(base.search, mounting=mounting)).on_mounts()


@pytest.fixture(scope="module")
def found(study):
    job = RegionJob(study, ROOF, allowed=0.1, count=60, workers=1)
    for _ in job:
        pass
    return job.result


def points_in(triangles, count, seed=0):
    """Random points (count, 3) of triangles, by area."""
    rng = np.random.default_rng(seed)
    sides = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    chosen = triangles[rng.choice(len(triangles), count, p=sides / sides.sum())]
    a, b = np.sort(rng.random((2, count)), axis=0)
    shares = np.stack([a, b - a, 1.0 - b], axis=1)
    return (shares[:, :, None] * chosen).sum(axis=1)


def losses_at(study, name, points, samples=131_072):
    """What the rig loses at points of the sensor's mount, on voxels that no region was made of."""
    places = search.OwnPlaces(
        study.rig, name, study.vehicle, study.search.mounting, limits=study.limits
    )
    evaluator = study.evaluator(samples, shift=OTHER_SHIFT)
    base, *values = evaluator.entropies([study.rig, *(places.at(point) for point in points)])
    return np.array(values) - base


def test_a_cut_triangle_keeps_what_is_below_the_level():
    triangle = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    for values, share in (((0, 1, 1), 0.25), ((0, 0, 1), 0.75), ((0, 0, 0), 1.0), ((1, 1, 1), 0)):
        cut = cut_below(triangle, np.array([values], float), 0.5)
        assert area_of(cut) == pytest.approx(0.5 * share)
    barred = cut_below(triangle, np.array([[0.0, np.inf, np.inf]]), 0.5)
    assert area_of(barred) == pytest.approx(0.125)


def test_a_divided_surface_has_its_area_and_short_edges():
    triangles = shapes.box_car().triangles
    fine = divided(triangles, 0.3)
    assert area_of(fine) == pytest.approx(area_of(triangles))
    assert np.linalg.norm(np.roll(fine, 1, axis=1) - fine, axis=2).max() <= 0.3


def test_kriging_follows_values_and_knows_where_it_knows_nothing():
    at = np.linspace(0.0, 1.0, 15)[:, None]
    rng = np.random.default_rng(1)
    noisy = np.sin(4.0 * at[:, 0]) + rng.normal(0.0, 0.05, 15)
    model = advice.Kriging.fit(at, noisy, np.full(15, 0.05**2), (0.1, 0.3, 1.0))
    points = np.linspace(0.0, 1.0, 60)[:, None]
    values, errors = model.at(points)
    off = np.abs(values - np.sin(4.0 * points[:, 0]))
    assert np.sqrt(np.mean(off**2)) < 0.05  # better than a single value
    assert np.mean(off <= 2.0 * errors) >= 0.9
    _, far = model.at(np.array([[4.0]]))
    assert far[0] > 3.0 * errors.max()


def test_points_of_the_region_lose_at_most_what_is_allowed(study, found):
    assert 0.0 < found.area < found.mount_area
    inside = losses_at(study, ROOF, points_in(found.patch, 60))
    assert np.mean(inside <= found.allowed) >= 0.95


def test_a_cover_has_places_that_are_free_where_bounds_forbid_most(study):
    """Of a robotaxi's body 23 of 24 places were forbidden by the LiDAR's bounds."""
    places = partial(
        search.OwnPlaces, study.rig, ROOF, study.vehicle, study.search.mounting, limits=study.limits
    )
    all_over = places().covered(24)
    bounds = {"x": (0.2, 1.0), "y": (-0.4, 0.4)}
    bounded = places(bounds=bounds).covered(24)
    free = [each for each in bounded if not each.place.reason]
    assert len(all_over) <= 24 and 12 <= len(free) <= 24 < len(bounded)
    for each in free:
        x, y, _ = each.rig[ROOF].pose.position
        assert 0.2 <= x <= 1.0 and -0.4 <= y <= 0.4


def test_a_sensor_over_a_part_that_is_inside_out_moves_over_the_body_below():
    """The roof's pod of a shipped shuttle looks down: no place was on it, nor a start."""
    car = shapes.box_car(times=3)
    pod = shapes.box((-0.8, -0.4, 1.3), (0.2, 0.4, 1.5))[:, ::-1]
    first = 5  # between the faces whose side is probed
    triangles = np.insert(car.triangles, first, pod, axis=0)
    parts = np.insert(car.parts, first, np.full(len(pod), 2))
    turned = pe.Vehicle(triangles, parts, (*car.part_names, "pod"))
    lidar = pe.Sensor("roof", shapes.small_lidar(8, 90), pe.Pose((-0.3, 0.0, 1.9)))
    places = search.OwnPlaces(
        pe.Rig([lidar]), "roof", turned, search.Mounting(), limits=pe.Limits()
    )
    assert places.at(places.foot.point)["roof"].pose.position == lidar.pose.position
    assert places.foot.normal == (0.0, 0.0, 1.0)


def test_the_closest_point_of_a_surface_is_that_of_all_its_faces(study):
    """On it, a little beside it, and metres away."""
    car = shapes.box_car(times=2)
    surface = search.MountSurface("test", search.SurfaceMount(car.part_names, max_slope=np.pi), car)
    rng = np.random.default_rng(3)
    for reach in (0.0, 0.005, 0.019, 0.021, 0.3, 4.0):
        for corner in car.triangles[rng.integers(len(car.triangles), size=12), 0]:
            point = corner + rng.uniform(-reach, reach, 3)
            foot, face = surface.closest(point)
            feet = closest_points(point, surface.triangles)
            square = ((feet - point) ** 2).sum(axis=1)
            assert ((foot - point) ** 2).sum() == pytest.approx(square.min(), abs=1e-15)
            assert (feet[face] == foot).all()


def test_the_sensor_is_in_its_own_region(study, found):
    place = search.OwnPlaces(
        study.rig, ROOF, study.vehicle, study.search.mounting, limits=study.limits
    ).foot
    middles = found.patch.mean(axis=1)
    assert np.linalg.norm(middles - place.point, axis=1).min() < 0.1


def test_another_allowed_loss_cuts_the_same_losses(found):
    areas = [found.allowing(loss).area for loss in (0.03, 0.1, 0.3, 99.0)]
    assert areas == sorted(areas) and areas[0] < areas[-1]
    assert areas[-1] <= found.mount_area  # the cabin stands on a part of it
    wider = found.allowing(0.3)
    for one, other in zip(found.limitations, wider.limitations, strict=True):
        assert other.distance >= one.distance
    assert found.tightest.distance == min(
        each.distance for each in found.limitations if each.way.unit == "m"
    )


def test_what_a_rule_forbids_is_not_in_the_region(study):
    box = search.NoGo("hatch", x=(0.6, 3.0))
    mounting = replace(study.search.mounting, constraints=search.Constraints(no_go=(box,)))
    held = replace(study, search=replace(study.search, mounting=mounting))
    job = RegionJob(held, ROOF, allowed=99.0, count=60, workers=1)
    for _ in job:
        pass
    assert len(job.found.patch)
    forbidden = [each for each in job.found.places if each.reason]
    assert any("hatch" in each.reason for each in forbidden)
    assert job.found.patch[:, :, 0].max() < 0.9
    forward = next(each for each in job.found.limitations if each.way.name == "forward")
    assert "hatch" in forward.why and forward.distance < 0.3


def test_the_patch_is_a_mount_of_the_next_study(study, found, tmp_path):
    path = tmp_path / "next.toml"
    pt.export_study(study_on_region(study, found), path)
    after = load_study(path)
    mount = after.search.mounting.mount_of(ROOF)
    assert mount.standoff == 0.1 and mount.orientation == "upright"
    assert area_of(mount.area.triangles) == pytest.approx(found.area, rel=1e-6)
    step = search.Parametrization(after.rig, after.search_space())
    assert step.allowed(after.rig)


def test_the_verb_writes_patch_and_data(study, tmp_path, capsys):
    file = tmp_path / "study.toml"
    pt.export_study(study, file)
    given = ["region", str(file), ROOF, "--loss", "400", "--figure", "blind_sector"]
    for name in ("patch.stl", "data.json"):
        options = ["--places", "8", "--workers", "1", "-o", str(tmp_path / name)]
        assert main([*given, *options]) == 0
    assert "m2" in capsys.readouterr().out
    data = json.loads((tmp_path / "data.json").read_text())
    assert data["sensor"] == ROOF and data["allowed_loss"] == 400.0
    patch = pt.read_mesh(tmp_path / "patch.stl", pe.MeshAxes(up="+z", forward="+x"))
    assert area_of(patch.triangles) == pytest.approx(data["area_m2"], rel=1e-4)
    assert main(["region", str(file), "nobody"]) == 1
    assert "'nobody'" in capsys.readouterr().err


def test_with_the_others_searched_again_nothing_is_lost(study, monkeypatch):
    monkeypatch.setattr("pe_tools.jobs.region_job.OTHERS", 3)
    monkeypatch.setattr("pe_tools.jobs.region_job.OTHERS_EVALUATIONS", 16)
    job = RegionJob(study, ROOF, allowed=0.05, count=16, workers=1, search_others=True)
    regions = []
    for _ in job:
        regions += [] if job.found in (None, *regions) else [job.found]
    alone, both = regions[-2:]
    assert both is job.result and both.with_others and not alone.with_others
    assert (both.loss <= alone.loss + 1e-12).all()
    assert (both.upper <= alone.upper + 1e-12).all()
    assert both.area >= alone.area == both.area_before
    assert {way.unit for way in both.ways} <= {"deg"}  # ways along it are of the others now
