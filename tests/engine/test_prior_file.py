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


@pytest.mark.parametrize("model", ["road", "highway", "uniform"])
def test_models_are_saved_by_their_name_alone(prior_of, model):
    prior = prior_of(f'[prior]\nmodel = "{model}"\n')
    assert prior == getattr(pe.Prior, model)()
    assert saved(prior) == {"model": model}


def test_a_class_of_the_road_can_be_changed(prior_of):
    car, *others = pe.Prior.road().classes
    prior = prior_of(FAR_CAR)
    assert prior.classes == (replace(car, decay_x=60.0), *others)
    assert saved(prior) == {"model": "road", "class": [{"name": "car", "decay_x": 60.0}]}


def test_a_class_can_be_added(prior_of):
    prior = prior_of(TRAM + "share = 0.5\nlanes = [-3, 3]\n")
    tram = pe.ObjectClass(
        name="tram",
        size=(15.0, 2.5, 3.6),
        height_spread=0.3,
        decay_x=50.0,
        laplace_y=5.0,
        gauss_y=2.0,
        laplace_share=0.5,
        lanes=(-3.0, 3.0),
        share=0.5,
    )
    assert prior.classes == (*pe.Prior.road().classes, tram)
    (table,) = saved(prior)["class"]
    assert table["name"] == "tram" and table["lanes"] == [-3.0, 3.0] and len(table) == 9
    assert prior_of(TRAM).classes[-1] == replace(tram, share=1.0, lanes=(0.0,))


def test_classes_can_be_chosen(prior_of):
    prior = prior_of('[prior]\nclasses = ["tram", "car"]\n' + FAR_CAR + TRAM)
    assert prior.class_names == ("tram", "car") and prior.classes[1].decay_x == 60.0
    assert saved(prior)["classes"] == ["tram", "car"]
    some = pe.Prior("highway", pe.Prior.highway().classes[:2], (pe.Focus(2.0, classes=("car",)),))
    assert saved(some)["classes"] == ["car", "truck"]
    assert "class" not in saved(some)


def test_focus_knows_the_classes_of_one_s_own(prior_of):
    focus = '[[prior.focus]]\nfactor = 2\nclasses = ["tram"]\n'
    assert prior_of(TRAM + focus).focus == (pe.Focus(2.0, classes=("tram",)),)
    with pytest.raises(pe.InputError, match=r"classes: expected one of car, .*cone, found 'tram'"):
        prior_of(focus)
