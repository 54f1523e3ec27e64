"""The [prior] of a study: models, classes of one's own, and back to the file."""

import tomllib
from dataclasses import replace

import pytest

import pe_core as pe
from pe_core.base.table_reader import dumps
from pe_core.study.study_file import study_from_dict, study_to_dict

SENSOR = '[[sensor]]\nname = "roof"\nmodel = "Pandar64"\nposition = [0, 0, 1.8]\n'
FAR_CAR = '[[prior.class]]\nname = "car"\ndecay_x = 60\n'
TRAM = """
[[prior.class]]
name = "tram"
size = [15, 2.5, 3.6]
height_spread = 0.3
decay_x = 50
laplace_y = 5
gauss_y = 2.0
laplace_share = 0.5
"""


@pytest.fixture
def prior_of(tmp_path):
    def load(text):
        path = tmp_path / "study.toml"
        path.write_text(text + SENSOR, "utf-8")
        return pe.load_study(path).prior

    return load


def saved(prior):
    """Return the [prior] that is written for a prior, after checking that it is read back."""
    study = pe.Study(pe.Rig([pe.Sensor("roof", pe.catalog.load("Pandar64"), pe.Pose((0, 0, 2)))]))
    data = study_to_dict(replace(study, prior=prior))
    assert study_from_dict(tomllib.loads(dumps(data))).prior == prior
    return data.get("prior", {"model": "road"})


def test_a_class_of_the_road_can_be_changed(prior_of):
    car, *others = pe.Prior.road().classes
    prior = prior_of(FAR_CAR)
    assert prior.classes == (replace(car, decay_x=60.0), *others)
    assert saved(prior) == {"model": "road", "class": [{"name": "car", "decay_x": 60.0}]}


def test_classes_can_be_chosen(prior_of):
    prior = prior_of('[prior]\nclasses = ["tram", "car"]\n' + FAR_CAR + TRAM)
    assert prior.class_names == ("tram", "car") and prior.classes[1].decay_x == 60.0
    assert saved(prior)["classes"] == ["tram", "car"]
    some = pe.Prior("highway", pe.Prior.highway().classes[:2], (pe.Focus(2.0, classes=("car",)),))
    assert saved(some)["classes"] == ["car", "truck"]
    assert "class" not in saved(some)
