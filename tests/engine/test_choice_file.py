"""What a study file says of choices: read, written, and refused in one line each."""

from pathlib import Path

import pytest

import pe_core as pe
from tests.engine.refusals import wrongly_refused

CHOICES = Path(__file__).parents[2] / "blend_assets" / "choices"
LIDARS = [{"model": "Pandar64", "price": 9}, {"model": "HDL-64E", "price": 5}]
ROOF = {"sensor": "roof", "option": LIDARS}


def data(**more):
    sensors = [
        {"name": "roof", "model": "Pandar64", "position": [0, 0, 2]},
        {"name": "eye", "model": "Camera 60 deg", "position": [1, 0, 2]},
    ]
    return {"sensor": sensors, **more}


def option(model, price):
    return {"sensor": "roof", "option": [{"model": model, "price": price}]}


def test_what_is_read_is_written_again():
    own = {
        "kind": "lidar",
        "elevations_deg": [-5.0, 0.0],
        "azimuth_step_deg": 1.0,
        "max_range_m": 9,
    }
    choice = {
        "sensors": ["roof", "eye"],
        "optional": True,
        "option": [*LIDARS, {"model": own, "price": 0.1}],
    }
    limits = {"max_price": 30, "max_sensors": 2, "max_of_kind": {"lidar": 2}, "currency": "EUR"}
    sensor = {"name": "held", "model": "Pandar40", "position": [0, 0, 1]}
    first = pe.study_from_dict(
        {"sensor": [*data()["sensor"], sensor], "choice": [choice], "selection": limits}
    )
    written = pe.study_to_dict(first)
    again = pe.study_from_dict(written)
    assert pe.study_to_dict(again) == written
    assert again.selection.max_of_kind == {"lidar": 2}
    assert [o.price for o in again.selection.choices[0].options] == [9.0, 5.0, 0.1]
    assert "choice" not in pe.study_to_dict(pe.study_from_dict(data()))


REFUSED = [
    ("choice[0].option", {"choice": [{"sensor": "roof"}]}),
    (
        "choice[0].option[0].price",
        {"choice": [{"sensor": "roof", "option": [{"model": "Pandar64"}]}]},
    ),
    ("choice[0].option[0].price", {"choice": [option("Pandar64", -1)]}),
    ("choice[0].option[0].model", {"choice": [option("Pandar65", 1)]}),
    (
        "choice[0]: option",
        {"choice": [option("Pandar64", 1)], "selection": {"max_of_kind": {"lidar": 0}}},
    ),
    ("choice[0]: sensor", {"choice": [{**ROOF, "sensor": "foot"}]}),
    ("choice[0]: mount", {"choice": [{"mount": "rack", "option": LIDARS}]}),
    ("choice[0].sensor, mount", {"choice": [{"option": LIDARS}]}),
    ("choice[0].sensor, mount", {"choice": [{**ROOF, "mount": "rack"}]}),
    ("choice[0].sensor, sensors", {"choice": [{**ROOF, "sensors": ["eye"]}]}),
    ("choice[1]: sensor", {"choice": [ROOF, ROOF]}),
    ("choice[0].option", {"choice": [{**ROOF, "option": LIDARS * 2}]}),
    ("choice[0].optional", {"choice": [{**ROOF, "optional": 1}]}),
    ("choice[0].pice", {"choice": [{**ROOF, "pice": 1}]}),
    ("selection.max_of_kind.sonar", {"selection": {"max_of_kind": {"sonar": 1}}}),
    ("selection.max_price", {"selection": {"max_price": float("nan")}}),
    ("selection: max_price", {"choice": [ROOF], "selection": {"max_price": 4}}),
    ("selection: max_sensors", {"choice": [ROOF], "selection": {"max_sensors": 1}}),
]


def test_what_is_wrong_is_refused():
    assert wrongly_refused(lambda v: pe.study_from_dict(data(**v)), REFUSED) == []


def test_limits_that_leave_nothing_together_are_named_together():
    """A second camera is too many, a LiDAR too dear: each limit alone leaves the other."""
    either = [{"model": "Pandar64", "price": 9}, {"model": "Camera 30 deg", "price": 1}]
    limits = {"max_of_kind": {"camera": 1}, "max_price": 5, "max_sensors": 7}
    with pytest.raises(
        pe.InputError, match="selection: max_price and max_of_kind: expected limits"
    ):
        pe.study_from_dict(data(choice=[{"sensor": "roof", "option": either}], selection=limits))


def test_what_leads_a_group_stays():
    group = {"group": [{"sensors": ["roof", "eye"]}]}
    with pytest.raises(pe.InputError, match="optional: expected false for the leading sensor"):
        pe.study_from_dict(data(choice=[{**ROOF, "optional": True}], optimize=group))


def test_the_second_of_a_pair_goes_with_the_first():
    left = {"name": "left", "model": "Pandar64", "position": [0, 1, 2]}
    right = {"name": "right", "model": "Pandar64", "position": [0, -1, 2]}
    rest = {"sensor": [left, right], "optimize": {"pair": [{"sensors": ["left", "right"]}]}}
    with pytest.raises(pe.InputError, match="the first of the pair, 'left'"):
        pe.study_from_dict({**rest, "choice": [{"sensor": "right", "option": LIDARS}]})
    study = pe.study_from_dict({**rest, "choice": [{"sensor": "left", "option": LIDARS}]})
    assert [study.designs().price(picks) for picks in study.designs()] == [10.0, 18.0]


@pytest.mark.parametrize(("name", "count"), [("roof_lidar", 8), ("bus_corners", 34)])
def test_the_examples_have_the_designs_that_the_page_tells_of(name, count):
    study = pe.load_study(CHOICES / f"{name}.toml")
    assert len(list(study.designs())) == count
    page = (CHOICES.parents[1] / "docs" / "mounts_and_search.md").read_text("utf-8")
    assert f"`{name}.toml`" in page
