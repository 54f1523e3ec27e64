"""What can be built: each figure against a plain definition, its limit, and what is not known."""

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scene.rig import hull_of
from pe_core.search import Front, Goals, Parametrization
from pe_core.search.build_figures import ALONE, BUILD_FIGURES, CELL_M, SUMS
from pe_core.search.placement import Placement
from pe_tools.advice import built_lines
from pe_tools.cli.verbs import main
from tests.engine import shapes

CAN = "Velodyne VLP-16 Puck"
"""A model of the catalogue with a housing, a mass and a power."""


def cans(*places, **more):
    model = pe.catalog.load(CAN)
    return [pe.Sensor(f"can {k}", model, pe.Pose(at), **more) for k, at in enumerate(places)]


def value(name, sensors, vehicle=None):
    return BUILD_FIGURES[name].of_placement(
        Placement.on(pe.Rig(sensors), vehicle or shapes.box_car())
    )


def corners(sensors):
    each = [hull_of(s.pose, pe.catalog.housing(s.model.name)).corners for s in sensors]
    return np.concatenate(each)


def test_lengths_are_those_of_the_housings_and_origins():
    """The box car is 4.6 m long, 1.8 m wide."""
    two = cans((-0.4, 0.3, 1.8), (2.33, -0.95, 0.6))
    housing = pe.catalog.housing(CAN)
    half = housing.size[0] / 2
    above = housing.size[2] - housing.optical_center[2]
    assert value("height", two) == pytest.approx(1.8 + above)
    assert value("width", two) == pytest.approx(2 * (0.95 + half), rel=0.02)  # a prism of 16 sides
    assert value("distance", two) == pytest.approx(math.dist((-0.4, 0.3, 1.8), (2.33, -0.95, 0.6)))
    assert value("protrusion", two) == pytest.approx(0.05 + half, rel=0.02)
    assert value("protrusion", two[:1]) == 0.0
    assert value("cleaning_reach", two) == pytest.approx(math.hypot(0.9 - 0.3, 1.8))
    assert value("cleaning_reach", two[1:]) == pytest.approx(0.6)  # outside: straight above ground


def test_frontal_area_is_what_housings_add_to_the_silhouette():
    """Cells of 1 cm whose middle any housing covers from the front, and neither box of the car."""
    rng = np.random.default_rng(5)
    for _ in range(5):
        places = rng.uniform((-2, -1.0, 0.8), (2, 1.0, 1.6), (3, 3)).round(3).tolist()
        sensors = cans(*places)
        y, z = np.meshgrid(np.arange(-2.9, 2.9, CELL_M), np.arange(0, 3.4, CELL_M), indexing="ij")
        y = y + CELL_M / 2
        z = z + CELL_M / 2
        seen = np.zeros(y.shape, bool)
        for sensor in sensors:  # upright cylinders: rectangles
            at = corners([sensor])
            _, y0, z0 = at.min(axis=0)
            _, y1, z1 = at.max(axis=0)
            seen |= (y >= y0) & (y <= y1) & (z >= z0) & (z <= z1)
        body = (abs(y) < 0.9) & (z > 0.2) & (z < 0.9) | (abs(y) < 0.7) & (z > 0.8) & (z < 1.4)
        expected = (seen & ~body).sum() * CELL_M**2
        assert value("frontal_area", sensors) == pytest.approx(expected, abs=30 * CELL_M**2)
    assert value("frontal_area", cans((0, 0, 1.0))) == 0.0
    twins = cans((0, 0, 1.6)), cans((0, 0, 1.6), (1, 0, 1.6))
    assert value("frontal_area", twins[0]) == value("frontal_area", twins[1]) > 0.0


def eyes(*yaws, hfov=90.0):
    return [
        shapes.camera(hfov, rotation=(0, 0, yaw), name=f"eye {k}") for k, yaw in enumerate(yaws)
    ]


def test_field_overlap_is_the_weakest_link_of_the_best_chain():
    assert value("overlap", eyes(0, 60)) == pytest.approx(30, abs=2)
    assert value("overlap", eyes(0, 70, 120, 180)) == pytest.approx(20, abs=2)
    assert value("overlap", eyes(170, -130)) == pytest.approx(30, abs=2)
    assert value("overlap", eyes(0, 60, 180)) == 0.0
    around = shapes.lidar_on_roof()
    assert value("overlap", [around, *eyes(0, 180)]) == pytest.approx(90, abs=2)
    up = shapes.camera(40.0, rotation=(0, -60, 0), name="up")
    assert value("overlap", [up, *eyes(0, hfov=40.0)]) == 0.0  # the same azimuths, apart in height


def test_the_best_chain_is_the_best_of_all_trees():
    rng = np.random.default_rng(8)
    for _ in range(10):
        sensors = eyes(*rng.uniform(-180, 180, 4).tolist(), hfov=float(rng.uniform(60, 120)))
        links = {
            (a, b): value("overlap", [sensors[a], sensors[b]])
            for a, b in itertools.combinations(range(4), 2)
        }
        best = 0.0
        for tree in itertools.combinations(links, 3):
            joined = {0}
            for _ in range(3):
                joined |= {n for link in tree if joined & set(link) for n in link}
            if len(joined) == 4:
                best = max(best, min(links[link] for link in tree))
        assert value("overlap", sensors) == best


def test_sums_add_up_and_what_is_not_known_is_named_and_never_zero():
    known = cans((0, 0, 1.8), (1, 0, 1.8))
    assert value("mass", known) == pytest.approx(2 * 0.83)
    assert value("power", known) == pytest.approx(16.0)
    heavy = replace(known[1], sheet=pe.DataSheet(mass=1.5, price=40.0))
    assert value("mass", [known[0], heavy]) == pytest.approx(0.83 + 1.5)
    eye = shapes.camera(name="eye")
    placed = Placement.on(pe.Rig([*known, eye]), shapes.box_car())
    for name in ("mass", "power", "data_rate", "protrusion", "frontal_area"):
        assert BUILD_FIGURES[name].of_placement(placed) is None
        assert BUILD_FIGURES[name].lacking(placed) == ("eye",)
    assert BUILD_FIGURES["price"].lacking(placed) == ("can 0", "can 1", "eye")
    assert BUILD_FIGURES["overlap"].lacking(Placement.on(pe.Rig([eye]), None)) == (ALONE,)
    assert BUILD_FIGURES["protrusion"].lacking(Placement.on(pe.Rig(known), None)) == ("no vehicle",)


LIMITS = (
    ("mass", 1.0, cans((0, 0, 1.8), (1, 0, 1.8))),
    ("power", 15.0, cans((0, 0, 1.8), (1, 0, 1.8))),
    ("data_rate", 7.0, cans((0, 0, 1.8))),
    ("protrusion", 0.01, cans((2.4, 0, 0.6))),
    ("cleaning_reach", 1.5, cans((0, 0, 1.8))),
    ("frontal_area", 0.002, cans((0, 0, 1.8))),
    ("overlap", 31.5, eyes(0, 60)),
)


def broken(name, at, sensors):
    """Limits that a rig breaks where one of them is so."""
    rig = pe.Rig(sensors)
    limits = pe.Limits(**{name: at})
    space = pe.SearchSpace.on_vehicle(rig, shapes.box_car(), figure_limits=limits)
    housings = {s.name: h for s in rig if (h := pe.catalog.housing(s.model.name))}
    coding = Parametrization(rig, replace(space, housings=housings))
    return sorted(text.split(" of ")[0].removeprefix("limits.") for text in coding.broken(rig))


def test_a_limit_is_a_rule_of_each_placement():
    for name, limit, sensors in LIMITS:
        found = value(name, sensors)
        looser = found * (0.9 if name == "overlap" else 1.1)
        told = [broken(name, at, sensors) for at in (limit, found, looser)]
        assert told == [[name], [], []], name


def test_a_limit_of_what_is_not_known_is_refused_in_one_line():
    for name in ("mass", "protrusion"):
        rig = pe.Rig([*cans((0, 0, 1.8)), shapes.camera(name="eye")])
        limits = pe.Limits(**{name: 1.0})
        study = shapes.car_study(rig, limits=limits)
        with pytest.raises(pe.InputError) as error:
            study.coding()
        assert error.value.field == name and "eye" in error.value.found
        assert "\n" not in str(error.value) and "can" not in error.value.found


def choice_study(**more):
    """A study that chooses each of two cans' models by price, mass and power."""
    small, large = (shapes.small_lidar(n, 90) for n in (4, 16))
    object.__setattr__(large, "name", "large")
    options = [
        pe.Option(small, price=100.0, mass=0.5, power=5.0, data_rate=8.0),
        pe.Option(large, price=300.0, mass=2.0, power=9.0, data_rate=30.0),
    ]
    sensors = [
        shapes.lidar_on_roof(small, (x, 0, 1.8), name=n) for n, x in (("a", -0.5), ("b", 0.5))
    ]
    choices = [pe.Choice(options, ["a"]), pe.Choice(options, ["b"], optional=True)]
    goals = Goals(front=Front(("entropy", "mass"), 3))
    search = pe.Search({"a": ("z",), "b": ("z",)}, samples=1024, evaluations=24, goals=goals)
    selection = pe.Selection(choices)
    rig = pe.Rig(sensors)
    given = {"search": search, "samples": 1024, "selection": selection}
    given["limits"] = pe.Limits(**more)
    return shapes.car_study(rig, **given)


@pytest.mark.parametrize("limits", [{}, {"mass": 2.5}, {"power": 10.0, "mass": 2.0}])
def test_designs_within_limits_of_sums_are_those_of_an_exhaustive_search(limits):
    designs = choice_study(**limits).designs()
    found = {picks: [designs.sum(key, picks) for key in SUMS] for picks in designs}
    mass = (0.5, 2.0)
    power = (5.0, 9.0)
    rate = (8.0, 30.0)
    price = (100.0, 300.0)
    plain = {}
    for a, b in itertools.product(range(2), range(3)):
        sums = [own[a] + (own[b] if b < 2 else 0.0) for own in (mass, power, rate, price)]
        if sums[0] <= limits.get("mass", 99) and sums[1] <= limits.get("power", 99):
            plain[a, b] = sums
    assert found == plain
    with pytest.raises(pe.InputError, match="mass"):
        choice_study(mass=0.4).designs()


def test_a_score_tells_what_can_be_built_and_of_whom_it_is_not_known(tmp_path, capsys):
    sensors = [*cans((-0.4, 0, 1.8)), shapes.camera(name="eye")]
    given = {"search": pe.Search(samples=1024), "samples": 1024}
    study = shapes.car_study(pe.Rig(sensors), **given)
    pt.export_study(study, tmp_path / "study.toml")
    assert main(["score", str(tmp_path / "study.toml"), "-o", str(tmp_path / "out")]) == 0
    told = capsys.readouterr().out.splitlines()
    data = json.loads((tmp_path / "out" / "result.json").read_text())["figures"]["after"]
    placed = Placement.on(study.rig, study.vehicle)
    assert {key: data["values"].get(key) for key in BUILD_FIGURES} == {
        key: pytest.approx(row.of_placement(placed)) for key, row in BUILD_FIGURES.items()
    }
    assert data["unknown"]["mass"] == ["eye"] and "mass" not in data["values"]
    lines = built_lines([pt.advice.KeyFigures.from_dict(data)])
    assert len(lines) == 2 and set(lines) <= set(told) and "eye" in lines[1]
