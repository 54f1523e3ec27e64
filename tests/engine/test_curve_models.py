"""`[ap] model`: curves of whole objects from publications, or of LiDARs from scans."""

import importlib
import json
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.sensors import KINDS, detectors, scan_curves
from pe_core.sensors.kind import SIZES
from pe_core.study import study_from_dict, study_to_dict
from pe_tools import advice
from pe_tools.cli.verbs import main
from tests.engine import shapes

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
ADULT = """
[vehicle]
mesh = "car.npz"
[[requirement]]
name = "adult ahead"
body = "adult"
zone = { x = [12, 14], y = [-1, 1], step = 0.5 }
criterion = { ap = 0.6 }
"""


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(STUDY, "utf-8")
    return file


@pytest.fixture
def provisional(monkeypatch):
    """As if some runs were missing, whatever the file says."""
    fitted(monkeypatch, 1)


def fitted(monkeypatch, missing):
    """Let so many runs be missing."""
    now = scan_curves()
    other = replace(now, runs=now.planned - missing)
    module = importlib.import_module("pe_tools.advice.warnings")  # a function has its name
    monkeypatch.setattr(module, "scan_curves", lambda: other)


def test_curves_from_scans_are_of_the_road_s_classes_and_of_lidars_alone():
    assert set(scan_curves().curves) == {"lidar"}
    assert set(scan_curves().curves["lidar"]) == set(SIZES)
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


def test_a_study_file_has_the_model_only_where_it_is_another(path):
    study = pe.load_study(path)
    assert study.model.model == "paper" and "model" not in study_to_dict(study)["ap"]
    own = replace(study, model=pe.PerceptionModel("literal", model="scans", lidar=OWN))
    data = study_to_dict(own)
    assert data["ap"]["model"] == "scans"
    again = study_from_dict(data, folder=path.parent)
    assert again.model == own.model and again.model.lidar == OWN
    data["ap"]["model"] = "guess"
    with pytest.raises(pe.InputError, match=r'ap.model: expected .*"?scans'):
        study_from_dict(data, folder=path.parent)


def test_the_score_is_that_of_the_curves(path):
    """As if they were written out class by class; voxels are scored as before."""
    study = pe.load_study(path)
    written = pe.PerceptionModel(objects=scan_curves().curves)
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


@pytest.mark.parametrize("verb", ["score", "explain", "compare"])
def test_provisional_curves_are_one_line_and_the_option_chooses_them(
    verb, path, provisional, capsys
):
    assert main([verb, str(path)]) == 0
    assert "provisional" not in capsys.readouterr().out
    more = [str(path)] * (verb == "compare")
    assert main([verb, str(path), *more, "--ap-model", "scans"]) == 0
    assert capsys.readouterr().out.count("the curves from scans are provisional") == 1


def test_a_check_takes_the_curves_and_tells_them(path, provisional, capsys):
    """An adult whom a rig has to find with an AP of 0.6: it does by the curves from scans alone."""
    path.write_text(f"{STUDY}{ADULT}", "utf-8")
    car = shapes.box_car()
    pt.write_mesh(path.parent / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    assert main(["check", str(path)]) == 3
    assert "provisional" not in capsys.readouterr().err
    assert main(["check", str(path), "--ap-model", "scans"]) == 0
    assert capsys.readouterr().err.count("the curves from scans are provisional") == 1


def test_the_result_says_which_curves_it_used(path, tmp_path, provisional, capsys):
    for model in ("paper", "scans"):
        folder = tmp_path / model
        assert main(["score", str(path), "--ap-model", model, "-o", str(folder)]) == 0
        result = json.loads((folder / "result.json").read_text("utf-8"))
        assert result["ap_model"] == model
        codes = [each["code"] for each in result["warnings"]]
        assert codes.count(advice.PROVISIONAL) == (model == "scans")
        assert pe.load_study(folder / "study.toml").model.model == model


@pytest.mark.parametrize("model", ["bevfusion", "centerpoint"])
def test_curves_of_published_detectors_are_told_with_source_and_span(model, path, capsys):
    """They take the place of the classes' own; a class that they lack keeps its own."""
    known, own = detectors()[model], pe.PerceptionModel()
    chosen = pe.PerceptionModel(model=model)
    assert set(known.rows) == {"lidar"} and "within one rig" in known.trust
    for name, row in known.rows["lidar"].items():
        assert chosen.object_curve("lidar", name) == row.curve
        low, high = row.m
        ends = [row.curve.a * np.log(m) + row.curve.b for m in (low, high)]
        assert 0.2 < ends[0] < ends[1] < 1.05 and row.rmse < 0.12
    assert chosen.object_curve("lidar", "cone") == own.object_curve("lidar", "cone")
    assert chosen.object_curve("camera", "car") == own.object_curve("camera", "car")
    assert main(["curves"]) == 0
    told = capsys.readouterr().out
    assert f"\n{model}: {known.label}, {known.trust}; {known.source}\n" in told
    assert main(["score", str(path), "--ap-model", model, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["ap_model"] == model
