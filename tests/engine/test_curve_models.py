"""`[ap]`: curves of objects from publications or from scans, the range term, the floor."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.metric import average_precision
from pe_core.metric.entropy import ranged
from pe_core.scoring.score import zone_masks
from pe_core.scoring.sight import Sight
from pe_core.sensors import KINDS, ObjectMeasurementCache, detectors, measure, scan_curves
from pe_core.sensors.kind import SIZES
from pe_core.study import study_from_dict, study_to_dict
from pe_tools import advice
from pe_tools.cli.verbs import main
from tests.engine import shapes

CAMERA_RESULTS = Path(__file__).parents[2] / "docs/validity/cameras/results.json"
OWN = pe.ApCurve(0.2, 0.1)
SCANS = pe.PerceptionModel(model="scans")
STUDY = """
samples = 4096
[metric]
targets = "objects"
traffic = true
scenes = 8
[[sensor]]
name = "roof"
model = "Velodyne VLP-16 Puck"
position = [0.0, 0.0, 1.9]
[[sensor]]
name = "front"
model = "Camera 60 deg"
position = [1.0, 0.0, 1.4]
"""


RANGED = f"""{STUDY}
[ap.objects.camera.car]
a = 0.055
b = 0.6
c = 0.12
"""
FADING = pe.ApCurve(0.055, 0.6, 0.12)
"""A camera's curve with a range term."""


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(STUDY, "utf-8")
    return file


@pytest.fixture
def noted(path):
    """As `path`, with a range term, and its warning."""
    path.write_text(RANGED, "utf-8")
    return advice.curve_note([pe.load_study(path)])


def test_curves_from_scans_are_of_the_road_s_classes_and_of_lidars_alone():
    assert set(scan_curves()) == {"lidar"}
    assert set(scan_curves()["lidar"]) == set(SIZES)
    for kind in KINDS:
        assert SCANS.curve(kind) == pe.PerceptionModel().curve(kind)
        for name in SIZES:
            changed = SCANS.object_curve(kind, name) != pe.PerceptionModel().object_curve(
                kind, name
            )
            assert changed == (kind == "lidar")
    with pytest.raises(pe.InputError, match="tram"):
        SCANS.object_curve("lidar", "tram")


def test_a_curve_of_the_study_wins_over_the_model():
    model = pe.PerceptionModel(objects={"lidar": {"car": OWN, "tram": OWN}}, model="scans")
    assert model.object_curve("lidar", "car") == model.object_curve("lidar", "tram") == OWN
    assert model.object_curve("lidar", "cone") == SCANS.object_curve("lidar", "cone")
    paper = model.with_model("paper")
    assert paper.object_curve("lidar", "car") == OWN and paper != model
    assert paper.object_curve("lidar", "cone") == pe.PerceptionModel().object_curve("lidar", "cone")
    assert "scans" in repr(model) and "scans" not in repr(paper)


def test_the_score_is_that_of_the_curves(path):
    """As if they were written out class by class; voxels are scored as before."""
    study = pe.load_study(path)
    written = pe.PerceptionModel(objects=scan_curves())
    by_name, by_value, before = (
        replace(study, model=m).evaluator().score(study.rig) for m in (SCANS, written, study.model)
    )
    assert by_name.entropy == by_value.entropy != before.entropy
    assert by_name.objects.ap == by_value.objects.ap > before.objects.ap
    voxels = replace(study, targets=pe.TargetRule())
    now, then = (
        replace(voxels, model=m).evaluator().entropy(voxels.rig) for m in (SCANS, study.model)
    )
    assert now == then


def test_what_is_not_the_paper_s_is_one_line(path, noted, capsys):
    assert main(["explain", str(path)]) == 0
    assert noted and capsys.readouterr().out.count(noted) == 1


def test_the_curve_of_camera_rigs_is_that_of_the_study_and_of_cars_alone(capsys):
    """A class enters by the rule of docs/validity/cameras/plan.md: statements 7 and 8 hold."""
    saved = json.loads(CAMERA_RESULTS.read_text("utf-8"))["curves"]
    holds = {name for name, row in saved.items() if {*map(row["verdicts"].get, "78")} == {"holds"}}
    known = detectors()["camera_rigs"]
    assert set(known.rows) == {"camera"} and set(known.rows["camera"]) == holds == {"car"}
    row = known.rows["camera"]["car"]
    car = saved["car"]
    assert row.curve == pe.ApCurve(car["a"], car["b"]) and row.rmse == car["rmse"]["fitted"]
    assert row.m == tuple(car["m"]) and row.a_interval == tuple(car["a_interval"])
    assert str(car["at_bound"]) in known.trust and "within 50 m" in known.trust
    own = pe.PerceptionModel()
    chosen = pe.PerceptionModel(model="camera_rigs")
    assert chosen.object_curve("camera", "car") == row.curve
    for kind, name in (("camera", "pedestrian"), ("camera", "truck"), ("lidar", "car")):
        assert chosen.object_curve(kind, name) == own.object_curve(kind, name)
    assert main(["sensors", "--curves"]) == 0
    told = capsys.readouterr().out
    assert f"\ncamera_rigs: {known.label}, {known.trust}; {known.source}\n" in told
    assert "a 0.047 to 0.439 (95 %)" in told


def by_definition(m, curve, distance):
    """AP = clip(a ln m - c ln R + b, 0.001, 0.999) where m > 0, R at least 1 m; else 0.001."""
    with np.errstate(divide="ignore"):
        ap = curve.a * np.log(m) - curve.c * np.log(np.maximum(distance, 1.0)) + curve.b
    return np.clip(np.where(m > 0.0, ap, 0.001), 0.001, 0.999)


@pytest.mark.parametrize("curve", [FADING, pe.ApCurve(0.152, 0.659, 0.3), pe.ApCurve(0.2, 0.1)])
def test_ap_with_a_range_term_is_that_of_its_definition(curve):
    m = np.array([0.0, 1.0, 3.5, 120.0, 4000.0])
    for distance in (0.2, 1.0, 7.5, 80.0):
        found = average_precision(ranged(m, curve, np.full(5, distance)), curve)
        assert found == pytest.approx(by_definition(m, curve, distance), abs=1e-12)
    assert ranged(m, OWN, np.ones(5)) is m and pe.ApCurve(0.2, 0.1, 0.0) == OWN
    with pytest.raises(pe.InputError):
        pe.ApCurve(0.2, 0.1, -0.1)


@pytest.mark.parametrize("blind", ["floor", "literal"])
def test_voxels_have_the_range_term_on_the_grid_and_on_a_sample(blind):
    """Each kind in a group of its own; the entropy of each voxel by definition."""
    curves = {"camera": FADING, "lidar": pe.ApCurve(0.1, 0.7, 0.2)}
    model = pe.PerceptionModel(blind, **curves)
    space = pe.PerceptionSpace((4.0, 12.0), (-3.0, 3.0), (0.0, 2.0), 0.5)
    roof = shapes.lidar_on_roof(shapes.small_lidar(16, 720), (0.0, 0.0, 1.7), name="roof")
    front = pe.Sensor("front", catalog.load("Camera 60 deg"), pe.Pose((1.0, 0.0, 1.4)))
    axes = np.meshgrid(*(space.centers(k) for k in range(3)), indexing="ij")
    centers = np.stack([w.ravel() for w in axes], axis=1)
    distance = np.hypot(centers[:, 0], centers[:, 1])
    for sensors, exact in (([roof], 1e-8), ([roof, front], 5e-4)):  # areas in single precision
        total = 0.0
        for sensor in sensors:
            m = measure(sensor, centers, space.interval).astype(float)
            ap = by_definition(m, curves[sensor.kind], distance)
            total += (1.0 / ap - 1.0) ** -2 - (999.0**-2 if blind == "floor" else 0.0)
        total += 999.0**-2 if blind == "floor" else 0.0
        entropy = np.mean(1.0 + np.log(2.0 * np.pi) - np.log(total))
        rig = pe.Rig(sensors)
        prior = pe.Prior.uniform()
        for samples, error in ((0, exact), (1 << 12, 0.01)):
            found = pe.Evaluator(space, prior, model=model, samples=samples)
            assert found.entropy(rig) == pytest.approx(entropy, abs=error)
            assert found.score(rig).entropy == pytest.approx(found.entropy(rig), abs=1e-8)
        assert abs(pe.Evaluator(space, prior).entropy(rig) - entropy) > 0.1
        sight = Sight(space, prior, model=model)
        h = (1.0 + np.log(2.0 * np.pi) - np.log(total)).reshape(space.shape)[:, :, 1]
        ground = sight.ground(rig, height=0.75, step=space.interval)
        assert ground.entropy == pytest.approx(h, abs=4.0 * exact)


def test_objects_have_the_range_term(path):
    study = pe.load_study(path)
    study = replace(study, rig=pe.Rig([study.rig["front"]]))
    evaluator = study.evaluator()
    drawn = evaluator.drawn
    m = ObjectMeasurementCache(drawn.objects, study.vehicle, True).measure(study.rig)["front"]
    distance = np.hypot(*drawn.objects.centers[:, :2].T)
    curves = dict.fromkeys(SIZES, FADING)
    ap = by_definition(m, FADING, distance)
    found = replace(study, model=pe.PerceptionModel(objects={"camera": curves})).evaluator()
    mean = np.average(ap, weights=drawn.weights)
    traffic = found.expected_ap(study.rig)
    assert found.score(study.rig).objects.ap == traffic.ap == pytest.approx(mean, abs=1e-8)
    near = zone_masks(*drawn.objects.centers[:, :2].T)["near"]
    of_near = np.average(ap[near], weights=drawn.weights[near])
    assert traffic.rings["near"][0] == pytest.approx(of_near, abs=1e-8)


def test_a_file_has_a_range_term_only_where_it_is_set_and_it_is_told(path, tmp_path, capsys):
    plain = study_to_dict(pe.load_study(path)).get("ap", {})
    assert "c" not in plain.get("camera", {})
    path.write_text(RANGED, "utf-8")
    study = pe.load_study(path)
    assert study.model.object_curve("camera", "car") == FADING
    assert study_from_dict(study_to_dict(study), folder=tmp_path).model == study.model
    assert main(["score", str(path), "--json"]) == 0
    codes = [each["code"] for each in json.loads(capsys.readouterr().out)["warnings"]]
    assert "range_term" in codes
    own = [replace(s, curve=FADING) if s.name == "front" else s for s in study.rig]
    voxels = replace(study, rig=pe.Rig(own), targets=pe.TargetRule())
    assert "'front'" in advice.curve_note([voxels])
    assert study_from_dict(study_to_dict(voxels), folder=tmp_path).rig["front"].curve == FADING
    assert main(["compare", str(path), str(path)]) == 0
    assert capsys.readouterr().out.count("ap.objects.camera.car") == 1
