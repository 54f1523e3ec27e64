"""Studies whose prior is labelled boxes: read, saved, exported to score the same bits elsewhere."""

from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from tests.engine.refusals import wrongly_refused
from tests.engine.test_box_files import CSV, KITTI, changed
from tests.engine.test_study_file import MINIMAL

STUDY = f"""
[space]
x = [-25, 25]
y = [-10, 10]
z = [0, 4]
interval = 0.5
[prior]
boxes = "labels"
[[prior.focus]]
factor = 2.0
classes = ["pedestrian"]
{MINIMAL}"""


@pytest.fixture
def write(tmp_path):
    def to_file(text, name="labels"):
        path = tmp_path / name
        path.write_text(text, "utf-8")
        return path

    return to_file


def test_a_study_names_its_boxes(write):
    write(KITTI)
    path = write(STUDY, "study.toml")
    study = pe.load_study(path)
    assert study.prior.class_names == ("car", "pedestrian")
    assert study.prior.boxes.file == "labels" and study.prior.focus[0].factor == 2.0
    pe.save_study(study, path)
    text = path.read_text()
    assert 'boxes = "labels"' in text and "model = " not in text.split("[[sensor]]")[0]
    assert "origin" not in text
    assert pe.load_study(path).prior == study.prior


def test_a_study_says_where_the_labels_origin_is(write):
    write(KITTI)
    text = changed(STUDY, 'boxes = "labels"', 'boxes = "labels"\norigin = [1.5, 0.0, 1.6]')
    path = write(text, "study.toml")
    prior = pe.load_study(path).prior
    assert prior.boxes.x[0] == pytest.approx(11.5)
    pe.save_study(pe.load_study(path), path)
    assert "origin = [1.5, 0.0, 1.6]" in path.read_text()
    assert pe.load_study(path).prior == prior


@pytest.mark.parametrize(("name", "table"), [("study", "boxes.csv"), ("other", "other.boxes.csv")])
def test_an_exported_study_scores_the_same_bits_elsewhere(write, tmp_path, name, table):
    write(KITTI)
    placed = changed(STUDY, '"labels"', '"labels"\norigin = [1.5, 0.25, 1.61]')
    study, name = pe.load_study(write(placed, "s.toml")), f"{name}.toml"
    (tmp_path / "out").mkdir()
    pt.export_study(study, tmp_path / "out" / name)
    expected = sorted([".perception-entropy.json", name, table])
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == expected
    (tmp_path / "labels").unlink()
    copy = pe.load_study(tmp_path / "out" / name)
    assert copy.prior.boxes.file == table and copy.prior.boxes == study.prior.boxes
    for each in (0, 4096):
        scores = [s.evaluator(each).score(s.rig).to_dict() for s in (study, copy)]
        assert scores[0] == scores[1]


def test_boxes_in_memory_are_exported_too(write, tmp_path):
    write(CSV)
    study = pe.load_study(write(STUDY.replace('classes = ["pedestrian"]', ""), "s.toml"))
    loose = replace(study, prior=pe.Prior.from_boxes([("car", 5, 0, 1, 4, 2, 1.5, 0.3)]))
    outcome = pt.Outcome("score", loose, loose, *[loose.evaluator().score(loose.rig)] * 2)
    data = pt.write_outcome(outcome, tmp_path / "out")
    again = pe.load_study(tmp_path / "out" / "study.toml")
    assert again.prior.boxes == loose.prior.boxes
    assert again.evaluator().score(again.rig).to_dict() == data["after"]


BAD = [
    ("{}/none.csv", ('"labels"', '"none.csv"')),
    ("prior.boxes", ('"labels"', "3")),
    ("prior.model", ('"labels"', '"labels"\nmodel = "road"')),
    ("prior.classes", ('"labels"', '"labels"\nclasses = []')),
    ("prior.origin", ('"labels"', '"labels"\norigin = [1, 2]')),
    ("prior.origin", ('"labels"', '"labels"\norigin = [1, 2, inf]')),
    ("focus: classes", ("pedestrian", "truck")),
    ("prior.origin", ('boxes = "labels"', "origin = [1, 2, 3]")),
    ("{}/wrong: line 2", ('"labels"', '"wrong"')),
]


def test_bad_priors_of_boxes_are_refused(write, tmp_path):
    write(KITTI)
    write(changed(KITTI, "1.75", "-1"), "wrong")

    def loaded(change):
        pe.load_study(write(changed(STUDY, *change), "study.toml"))

    rows = [(field.format(tmp_path), change) for field, change in BAD]
    assert wrongly_refused(loaded, rows, tmp_path / "study.toml") == []
