"""How sure a search is: costs by axis, active constraints, other optima, flattery; its limits."""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import Goals, Judgement, Parametrization
from pe_tools.cli.terminal import summary
from pe_tools.jobs import result_dict
from pe_tools.sensitivity import (
    Archive,
    Difference,
    analyse,
    budget_of,
    sensitivity_from_dict,
    sensitivity_lines,
)
from pe_tools.sensitivity.fresh_samples import SAMPLES, FreshSamples
from pe_tools.sensitivity.moves import Neighbourhood
from pe_tools.sensitivity.optima import Basins
from pe_tools.sensitivity.shadow_prices import ShadowPrice, shadow_prices, with_sizes
from pe_tools.sensitivity.sizes import NONE, SizePricing
from pe_tools.sensitivity.wording import size_gain_text, size_text
from tests.engine import shapes

TOP_M = 1.8


def study(sensitivity="full", **search):
    model = shapes.small_lidar(4, 90)
    rig = pe.Rig([shapes.lidar_on_roof(model, (0.0, 0.0, TOP_M - 0.004))])
    limits = {"roof": {"z": (1.6, TOP_M)}}
    goals = Goals(sensitivity=sensitivity)
    given = {"free": {"roof": ("z", "pitch")}, "limits": limits, "goals": goals} | search
    settings = pe.Search(samples=2048, method="cma-es", evaluations=30, **given)
    return pe.Study(rig, shapes.box_car(), shapes.small_space(), search=settings, samples=2048)


def finished(job):
    for _ in job:
        pass
    return job.outcome


@pytest.fixture(scope="module")
def outcome():
    return finished(pe.OptimizeJob(study(), 1))


def test_costs_are_those_of_plain_evaluations_and_the_result_is_not_touched(outcome):
    found, rig = outcome.sensitivity, outcome.study.rig
    samples = FreshSamples(study(), rig)
    assert found.voxels == samples.size and len(samples._objectives) == SAMPLES
    row = next(each for each in found.axes if each.axis == "z")
    pose = rig["roof"].pose
    x, y, z = pose.position
    lower = rig.with_poses([pe.Pose.from_degrees((x, y, z - 0.01), pose.rotation_deg)])
    each = [one.entropy(lower) - one.entropy(rig) for one in samples._objectives]
    assert row.cost[-1.0].mean == pytest.approx(np.mean(each), abs=1e-9)
    assert row.cost[-1.0].stderr == pytest.approx(np.std(each, ddof=1) / 2.0, abs=1e-9)
    assert row.status == "free"
    assert {a.axis for a in found.axes if a.status == "fixed"} == {"x", "y", "roll", "yaw"}
    without = finished(pe.OptimizeJob(study("off"), 1))
    assert without.sensitivity is None and without.judged == outcome.judged
    assert without.study.rig["roof"].pose == pose and without.after.entropy == outcome.after.entropy


class CountingThreads(ThreadPoolExecutor):
    """Threads as workers, which count their tasks."""

    tasks = 0

    def submit(self, fn, /, *args, **kwargs):
        self.tasks += 1
        return super().submit(fn, *args, **kwargs)


def test_workers_do_the_analysis_and_find_the_same(outcome):
    job = pe.OptimizeJob(study(), 1)
    with CountingThreads(2) as threads:
        job.executor = threads
        by_workers = finished(job)
    assert threads.tasks > SAMPLES * by_workers.sensitivity.evaluations
    assert by_workers.sensitivity.to_dict() == outcome.sensitivity.to_dict()


def test_yaw_of_a_spinning_lidar_is_flatter_than_its_height(outcome):
    cost = {each.axis: each.worst.mean for each in outcome.sensitivity.axes}
    assert abs(cost["yaw"]) < max(abs(cost["z"]), abs(cost["pitch"]))


class Slope:
    """Fresh samples of a value that is known: the higher the better, the more ahead the better."""

    def __init__(self, rig):
        self.reference = rig

    def value(self, rig):
        x, _, z = rig["roof"].pose.position
        return -3.0 * z - 2.0 * x

    def evaluate(self, rigs):
        """Nothing is computed beforehand."""

    def change(self, rig, base=None):
        return Difference(self.value(rig) - self.value(base or self.reference), 0.0)


def test_shadow_prices_name_the_constraint_and_the_gain_of_a_step():
    given = study(free={"roof": ("x", "z")})
    search = replace(given.search, mounting=pe.Mounting(constraints=pe.Constraints(max_width=0.5)))
    given = replace(given, search=search)
    slope = Slope(given.rig)
    around = Neighbourhood(given.rig, given.search_space())
    prices = {p.constraints: p for p in shadow_prices(slope, around, ())}
    top = prices["bounds of z of 'roof'",]
    assert top.step.text == "roof z +1 cm" and top.gain.mean == pytest.approx(-0.03)
    allowed = prices[()]
    assert allowed.step.text == "roof x +1 cm" and allowed.gain.mean == pytest.approx(-0.02)
    held = study(free={"roof": ("z",)})
    prices = shadow_prices(slope, Neighbourhood(held.rig, held.search_space()), ())
    assert [p.name for p in prices] == ["bounds of z of 'roof'", "x of 'roof' held"]


def sized(given, samples=None):
    """Active constraints of a study by their names, with what a size of each gains."""
    around = Neighbourhood(given.rig, given.search_space())
    samples = samples or Slope(given.rig)
    return {
        p.name: p
        for p in with_sizes(shadow_prices(samples, around, ()), SizePricing(samples, around))
    }


def test_a_larger_step_over_a_bound_gains_five_times_as_much():
    size = sized(study(free={"roof": ("x", "z")}))["bounds of z of 'roof'"].size
    assert (size.size, size.step.text) == ("5 cm", "roof z +5 cm")
    assert size.gain.mean == pytest.approx(-0.15)
    assert size_text(size) == "roof z +5 cm" and size_gain_text(size) == "0.1500 +- 0.0001"


def test_a_larger_step_that_another_constraint_forbids_is_not_taken():
    """The sensor without a housing is its origin: 2 cm above it is the limit of the height."""
    given = study(free={"roof": ("z",)})
    limit = pe.Constraints(max_height=TOP_M + 0.02)
    given = replace(given, search=replace(given.search, mounting=pe.Mounting(constraints=limit)))
    size = sized(given)["bounds of z of 'roof'"].size
    assert size.step.text == "roof z +1 cm" and size.gain.mean == pytest.approx(-0.03)


BOX = {"kind": "lidar", "elevations_deg": [-5.0, 5.0], "azimuth_count": 36, "max_range_m": 60.0}


@pytest.fixture
def boxes():
    """Three LiDARs of the catalogue that differ in the width of their housings: 20, 19, 14 cm."""
    widths = {"wide box": 0.2, "tall box": 0.2, "small box": 0.14}
    for name, width in widths.items():
        size = [width, width, 0.19 if name == "tall box" else 0.2]
        housing = {"shape": "box", "size": size, "optical_center": [0.0, 0.0, 0.1]}
        pe.catalog.add(name, {**BOX, "source": "test", "housing": housing | {"source": "test"}})
    yield
    for name in widths:
        pe.catalog.remove(name)


def free_study(sensors, free, vehicle=None, **mounting):
    rig = pe.Rig(sensors)
    settings = pe.Search(free=dict.fromkeys((s.name for s in rig), free))
    settings = replace(settings, mounting=pe.Mounting(**mounting))
    return pe.Study(rig, vehicle, shapes.small_space(), search=settings)


def boxed(position, name="roof"):
    return pe.Sensor(name, pe.catalog.load("wide box"), pe.Pose(position, (0.0, 0.0, 0.0)))


def test_a_smaller_housing_gains_the_way_that_it_frees(boxes):
    """The front of a box 20 cm wide is at a no-go area. Half of 20 - 14 cm are 3 cm of way.

    The box that is only less high is the next one by volume, but frees nothing ahead.
    """
    area = pe.NoGo("hatch", x=(1.1, 2.0))
    limits = pe.Constraints(no_go=[area])
    given = free_study([boxed((1.0, 0.0, 1.8))], ("x",), constraints=limits)
    price = sized(given)["no_go 'hatch' for 'roof'"]
    assert price.gain.mean == pytest.approx(-0.02)
    assert (price.size.size, price.size.sensors) == ("small box", ("roof",))
    assert price.size.step.text == "roof x +3 cm" and price.size.gain.mean == pytest.approx(-0.06)
    assert size_text(price.size) == "the housing of small box, roof x +3 cm"
    table = price.to_dict()["size"]
    assert table["housing_of"] == ["roof"] and table["gain"] == pytest.approx(0.06)


def test_no_smaller_housing_is_no_size(boxes):
    """A sensor without a housing, and one above which even the smallest has no room to go."""
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(1.0, 2.0))])
    model = shapes.small_lidar(4, 90)
    sensor = pe.Sensor("roof", model, pe.Pose((0.995, 0.0, 1.8), (0.0, 0.0, 0.0)))
    given = free_study([sensor], ("x",), constraints=limits)
    size = sized(given)["no_go 'hatch' for 'roof'"].size
    assert size.size == NONE and size.gain is None and size_text(size) == NONE
    assert ShadowPrice(("no_go",), None, None, size).size.to_dict() == {"size": NONE}


class Inwards(Slope):
    """The nearer the left sensor is to the middle, the better."""

    def value(self, rig):
        return rig["left"].pose.position[1]


def test_both_sensors_of_a_pair_take_the_smaller_housing(boxes):
    """A gap of 2 mm is there already: the box that is only less high does not bring it."""
    sensors = [boxed((0.0, y, 1.8), n) for n, y in (("left", 0.101), ("right", -0.101))]
    limits = pe.Constraints(clear_housings=True)
    pairs = [("left", "right")]
    given = free_study(sensors, ("y",), constraints=limits, pairs=pairs)
    price = sized(given, Inwards(given.rig))["clear housings of 'left' and 'right'"]
    assert price.size.sensors == ("left", "right") and price.size.step.text == "left y -3.1 cm"
    assert price.size.gain.mean == pytest.approx(-0.031)
    text = "the housing of small box for left and right, left y -3.1 cm"
    assert size_text(price.size) == text


def test_a_list_of_slots_is_relaxed_by_one_slot():
    slots = [pe.Slot(f"{x}", pe.Pose((x, 0.0, 1.8), (0.0, 0.0, 0.0))) for x in (0.0, 0.7, 1.5)]
    sensor = pe.Sensor("roof", shapes.small_lidar(4, 90), slots[-1].pose)
    mounts = {"rack": pe.SlotMount(slots)}
    given = free_study([sensor], (), mounts=mounts, on={"roof": "rack"})
    sizes = {p.step.text: p.size for p in sized(given).values()}
    around = Neighbourhood(given.rig, given.search_space())
    sizes = SizePricing(Slope(given.rig), around)
    ahead = next(m for m in around.design_moves() if m.step.text == "roof x +1 cm")
    size = sizes.gain(ahead.forbidden_by, ahead.step)
    assert size_text(size) == "one slot, roof x +70 cm" and size.gain.mean == pytest.approx(-1.4)
    up = next(m for m in around.design_moves() if m.step.text == "roof z +1 cm")
    assert sizes.gain(up.forbidden_by, up.step).size == NONE  # all slots are at one height


def test_what_has_no_sizes_says_so_and_a_spent_budget_is_told_apart():
    given = study(free={"roof": ("z",)})
    around = Neighbourhood(given.rig, given.search_space())
    sizes, slope = SizePricing(Slope(given.rig), around), Slope(given.rig)
    step = next(around.design_moves()).step
    assert sizes.gain(("bounds of z of 'roof'", "requirement 'front'"), step).size == NONE
    assert sizes.gain(("standoff of 'roof'",), step).size == NONE
    prices = with_sizes(shadow_prices(slope, around, ()), sizes, lambda: False)
    assert prices and all(price.size is None for price in prices)


def test_moves_of_a_rig_with_a_fixed_sensor():
    """What stays has no variables, whatever axes were free; the others keep theirs."""
    sensors = [
        shapes.lidar_on_roof(shapes.small_lidar(4, 90), (0.0, y, 1.7), name=n)
        for n, y in (("a", 0.4), ("b", -0.4))
    ]
    given = free_study(sensors, ("x",))
    goals = Goals(fixed=("a",))
    given = replace(given, search=replace(given.search, goals=goals))
    around = Neighbourhood(given.rig, given.search_space())
    moves = {m.step.text: m for m in around.design_moves()}
    assert moves["b x +1 cm"].forbidden_by == ()
    assert moves["b x +1 cm"].rig["b"].pose.position[0] == pytest.approx(0.01)
    assert moves["a x +1 cm"].forbidden_by == ("x of 'a' held",)


class Wells:
    """Two wells along x, at -1 and at 1.2; the second is 0.1 less deep."""

    def __init__(self, rig):
        self.reference = rig

    def value(self, rig):
        x = rig["roof"].pose.position[0]
        return min((x + 1.0) ** 2, (x - 1.2) ** 2 + 0.1)

    def mean(self, rig):
        return Difference(self.value(rig), 0.0)

    change, evaluate = Slope.change, Slope.evaluate


def at(rig, x):
    _, y, z = rig["roof"].pose.position
    return rig.with_poses([pe.Pose.from_degrees((x, y, z), (0.0, 0.0, 0.0))])


def test_another_optimum_is_told_from_the_flank_of_the_same_one():
    given = study(free={"roof": ("x",)}, limits={"roof": {"x": (-2.0, 2.0)}})
    best = at(given.rig, -1.0)
    archive = Archive()
    for x in (-1.0, -0.98, -0.4, -0.1, 0.7, 1.0, 1.05):
        rig = at(given.rig, x)
        archive.note(rig, 0, Judgement(Wells(best).value(rig), False))
    archive.note(at(given.rig, 1.9), 0, Judgement(0.0, True))  # a lower bound is none to rank by
    xs = [rig["roof"].pose.position[0] for rig in archive.placements()]
    assert xs == [-1.0, 1.05, 0.7, -0.4, -0.1]
    endings = Basins(Wells(best), given.search_space()).endings(archive.placements())
    assert (endings.examined, endings.same_basin, len(endings.runners_up)) == (4, 2, 1)
    [other] = endings.runners_up
    assert other.rig["roof"].pose.position[0] == pytest.approx(1.2, abs=0.03)
    assert other.behind.mean == pytest.approx(0.1, abs=0.002) and other.moved == ("roof",)


def test_a_search_that_resumes_says_the_same(outcome):
    job = pe.OptimizeJob(study(), 1)
    job.journal = pe.search.Journal(outcome.judged[:11])
    again = result_dict(finished(job))
    assert again["sensitivity"] == result_dict(outcome)["sensitivity"]


def test_it_is_in_result_json_on_the_terminal_and_read_back(outcome):
    table = result_dict(outcome)["sensitivity"]
    found = sensitivity_from_dict(table, outcome.study.rig)
    assert found.to_dict() == table and len(table["axes"]) == 6
    text = summary(outcome)
    for line in sensitivity_lines(outcome.sensitivity):
        assert line in text
    assert "1 cm or 1 deg" in text and "fresh voxels" in text


def test_a_short_search_is_not_outlasted_by_its_analysis():
    auto = study(None)
    assert budget_of(auto, 100) is None and budget_of(study("off"), 10**6) is None
    assert budget_of(auto, 200) == ((1.0,), False)
    assert budget_of(auto, 300) == ((1.0, 5.0), False)
    assert budget_of(auto, 2000) == ((1.0, 5.0), True)
    evaluator = auto.evaluator(2048)
    given = (auto, auto, evaluator, Archive(), 10**6, FreshSamples(auto, auto.rig))
    assert analyse(*given, lambda: False) is None


def test_linked_sensors_move_together_and_the_price_of_the_link_is_told():
    model = shapes.small_lidar(4, 90)
    names = {"left": 0.4, "right": -0.4}
    rig = pe.Rig([shapes.lidar_on_roof(model, (0.0, y, 1.7), name=n) for n, y in names.items()])
    mounting = pe.Mounting(pairs=[("left", "right")])
    settings = pe.Search(free={"left": ("x",)}, mounting=mounting)
    given = pe.Study(rig, shapes.box_car(), shapes.small_space(), search=settings)
    around = Neighbourhood(rig, given.search_space())
    assert around.leaders == ("left",) and around.status("right", "x") == "linked"
    move = next(m for m in around.design_moves() if m.step.text == "left x +1 cm")
    assert [s.pose.position[0] for s in move.rig] == [0.01, 0.01] and not move.forbidden_by
    assert len(Parametrization(rig, given.search_space()).variables) == 1
    assert math.isclose(around.rig["left"].pose.position[1], 0.4)
