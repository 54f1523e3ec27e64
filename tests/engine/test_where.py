"""Where a sensor should go: places all over the surface, their figures and their rules."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog, search
from pe_core.scoring.sampling import SEARCHED
from pe_core.search.places import IN_BODY, LOW, surface_points
from pe_tools.cli.verbs import main
from pe_tools.jobs import where_job
from tests.engine import shapes

LIDAR = pe.Sensor("LiDAR", shapes.small_lidar(8, 90))


@pytest.fixture
def study():
    rig = pe.Rig([shapes.camera(position=(2.2, 0.0, 1.2), name="front")])
    return shapes.car_study(rig)


def mapped(study, sensor=LIDAR, **options):
    job = where_job.WhereJob(study, sensor, **{"count": 40, "workers": 1, **options})
    for _ in job:
        pass
    return job.found


def test_points_are_on_the_surface_and_every_beginning_covers_it():
    triangles = shapes.box_car().triangles
    points, faces = surface_points(triangles, 200)
    again, _ = surface_points(triangles, 60)
    corners = triangles[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.abs(((points - corners[:, 0]) * normal).sum(axis=1)).max() < 1e-9
    assert len(np.unique(points, axis=0)) == 200
    assert len(again) == 60
    for count in (20, 80):
        apart = np.linalg.norm(points[:, None] - points[None, :count], axis=2)
        nearest = apart.min(axis=1)
        among = apart[:count] + 99.0 * np.eye(count)
        assert nearest.max() <= among.min() + 1e-9  # no gap is wider than places are apart


@pytest.mark.parametrize("figure", ["entropy", "traffic_ap", "blind_sector"])
def test_a_change_is_that_of_the_figure_with_the_sensor_there(study, figure):
    found = mapped(study, figure=figure, count=60)
    figure_of = {
        "entropy": study.evaluator(2048, shift=SEARCHED).entropy,
        "traffic_ap": lambda rig: few_scenes(study).in_traffic(rig).ap,
        "blind_sector": lambda rig: max(s.width for s in study.sight().blind_sectors(rig)),
    }[figure]
    worst = found.best(60)[-3:]
    assert len(worst) == 3
    for each in worst:
        rig = pe.Rig([*study.rig, replace(LIDAR, pose=each.pose)])
        change = figure_of(rig) - figure_of(study.rig)
        assert each.value - found.base == pytest.approx(change, abs=3e-9)


def test_the_best_places_are_reported_on_a_larger_sample(study):
    """The place that fits the map's voxels best is no better than it is in the study's score."""
    study = replace(study, samples=16_384)
    found = mapped(study, count=80)
    assert found.base == study.evaluator().entropy(study.rig)
    for each in found.best(5, 0.5):
        rig = pe.Rig([*study.rig, replace(LIDAR, pose=each.pose)])
        assert each.value == study.evaluator().entropy(rig)


def test_requirements_are_counted_with_their_mounting_errors(study):
    zone = pe.requirements.Zone(spots=((5.0, 0.0),))
    child = pe.requirements.BODIES["child"]
    under = pe.requirements.RobustTo(mounting=True)
    wanted = pe.requirements.Requirement("child", zone, (child,), robust_to=under)
    loose = replace(study.search, tolerance=search.Tolerance(angle=np.radians(40.0)))
    held = replace(study, requirements=(wanted,), search=loose)
    assert held.verdicts()[0].met_whole and not held.verdicts()[0].met
    assert mapped(held, figure="requirements", count=1).base == 0.0


def few_scenes(study):
    return replace(study, targets=replace(study.targets, scenes=32)).sight(SEARCHED)


def test_a_sensor_stands_off_the_surface_upright_and_looks_outward(study):
    camera = shapes.camera(name="Camera")
    for each in mapped(study, camera).places:
        place = each
        off = np.array(place.pose.position) - np.array(place.point)
        assert off == pytest.approx(0.05 * np.array(place.normal), abs=1.1e-5)
        _, _, yaw = place.pose.rotation_deg
        assert place.pose.rotation_deg[:2] == (0.0, 0.0)
        middle = np.mean(study.vehicle.bounds, axis=0)
        ahead = np.array([np.cos(np.radians(yaw)), np.sin(np.radians(yaw))])
        away = (np.array(place.point) - middle)[:2]
        assert ahead @ away > 0.99 * np.linalg.norm(away)
    assert {e.pose.rotation_deg[2] for e in mapped(study).places} == {0.0}  # sees all around


def test_forbidden_places_have_the_rule_as_reason_and_no_value(study):
    no_go = search.NoGo("windshield", x=(1.0, 9.0), z=(0.8, 9.0))
    mounting = search.Mounting(constraints=search.Constraints(no_go=[no_go]))
    searched = replace(study.search, mounting=mounting)
    study = replace(study, search=searched, limits=search.Limits(height=1.3))
    found = mapped(study, count=120)
    assert set(found.reasons()) >= {LOW, "no_go 'windshield'", "limits.height"}
    for each in found.places:
        x, _, z = each.pose.position
        assert (each.value is None) == bool(each.reason)
        if z < 0.2:
            assert each.reason == LOW
        elif z > 1.3:
            assert each.reason == "limits.height"
        elif x > 1.0 and z > 0.8:
            assert each.reason == "no_go 'windshield'"
        else:
            assert each.reason in ("", IN_BODY)


def test_the_command_writes_what_the_job_finds(study, tmp_path, capsys):
    path = tmp_path / "car.toml"
    rows = tmp_path / "places.csv"
    pt.export_study(study, path)
    given = ["where", str(path), "--model", "Camera 90 deg", "--places", "30"]
    assert main([*given, "--json", "-o", str(rows)]) == 0
    data = json.loads(capsys.readouterr().out)
    sensor = pe.Sensor("Camera", catalog.load("Camera 90 deg"))
    found = mapped(pe.load_study(path), sensor, count=30)
    assert data == json.loads(json.dumps(found.to_dict()))
    table = list(csv.DictReader(rows.open()))
    assert [float(r["value"]) if r["value"] else None for r in table] == [
        each.value for each in found.places
    ]
    assert main(given) == 0
    best = found.best()[0]
    assert f"{best.value:.3f} nats" in capsys.readouterr().out.splitlines()[2]
    assert main([*given, "-o", str(rows)]) == 1  # it is there
