"""How sure a search is: costs by axis, active constraints, other optima; its limits."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring.sampling import HELD_OUT
from pe_core.search import Goals, Parametrization
from pe_tools.cli.terminal import summary
from pe_tools.jobs import result_dict
from pe_tools.sensitivity import NEAR, Archive, StepCosts, sensitivity_lines
from pe_tools.sensitivity.flatness import Neighbourhood, PoseStep, active_constraints, flatness
from pe_tools.sensitivity.optima import Basins
from tests.engine import shapes
from tests.engine.processes import finished

TOP_M = 1.8


def study(sensitivity="full", **search):
    model = shapes.small_lidar(4, 90)
    rig = pe.Rig([shapes.lidar_on_roof(model, (0.0, 0.0, TOP_M - 0.004))])
    limits = {"roof": {"z": (1.6, TOP_M)}}
    goals = Goals(sensitivity=sensitivity)
    given = {"free": {"roof": ("z", "pitch")}, "limits": limits, "goals": goals} | search
    settings = pe.Search(samples=2048, evaluations=30, **given)
    return pe.Study(rig, shapes.box_car(), shapes.small_space(), search=settings, samples=2048)


@pytest.fixture(scope="module")
def outcome():
    return finished(pt.OptimizeJob(study(), 1))


def test_costs_are_those_of_plain_evaluations_and_the_result_is_not_touched(outcome):
    found, rig = outcome.sensitivity, outcome.study.rig
    halves = [study().evaluator(1024, shift=shift) for shift in HELD_OUT]
    row = next(each for each in found.axes if each.axis == "z")
    pose = rig["roof"].pose
    x, y, z = pose.position
    lower = rig.with_poses([pe.Pose.from_degrees((x, y, z - 0.01), pose.rotation_deg)])
    costs = [each.entropy(lower) - each.entropy(rig) for each in halves]
    assert row.cost[-1.0] == pytest.approx(np.mean(costs), abs=1e-12)
    assert row.cost[-1.0] != 0.0 and row.stderr > 0.0
    assert row.status == "free"
    assert {a.axis for a in found.axes if a.status == "fixed"} == {"x", "y", "roll", "yaw"}
    without = finished(pt.OptimizeJob(study("off"), 1))
    assert without.sensitivity is None and without.evaluated == outcome.evaluated
    assert without.study.rig["roof"].pose == pose and without.after.entropy == outcome.after.entropy


def test_yaw_of_a_spinning_lidar_is_flatter_than_its_height(outcome):
    cost = {each.axis: each.worst for each in outcome.sensitivity.axes}
    assert abs(cost["yaw"]) < max(abs(cost["z"]), abs(cost["pitch"]))


class Known:
    """An objective whose value is known."""

    def __init__(self, value):
        self.value = value

    def entropy(self, rig):
        return self.value(*rig["roof"].pose.position)


def slope(rig):
    """The higher the better, the more ahead the better."""
    return StepCosts(rig, [Known(lambda x, y, z: -3.0 * z - 2.0 * x)])


def wells(x, *_):
    """Two wells along x, at -1 and at 1.2; the second is 0.1 less deep."""
    return min((x + 1.0) ** 2, (x - 1.2) ** 2 + 0.1)


def active(given):
    """Active constraints of a study on a slope, by the text of their step."""
    design = Neighbourhood(given.rig, given.search_space())
    table = list(flatness(slope(given.rig), design.status, (NEAR,)))
    return {each.step.text: each for each in active_constraints(table, design)}


def on_one_beam(**search):
    """A sensor that may move along x and z, and a rule that it breaks nowhere."""
    given = study(free={"roof": ("x", "z")}, **search)
    rule = pe.Mounting(constraints=pe.Constraints(max_width=0.5))
    return replace(given, search=replace(given.search, mounting=rule))


def test_active_constraints_name_what_forbids_a_step_and_its_gain():
    found = active(on_one_beam())
    top, allowed = found["roof z +1 cm"], found["roof x +1 cm"]
    assert top.name == "bounds of z of 'roof'" and top.gain == pytest.approx(-0.03)
    assert allowed.constraints == () and allowed.gain == pytest.approx(-0.02)
    held = active(study(free={"roof": ("z",)}))
    assert [held[step].name for step in ("roof z +1 cm", "roof x +1 cm")] == [
        *("bounds of z of 'roof'", "x of 'roof' held")
    ]
    assert next(iter(held)) == "roof z +1 cm"  # the largest gain first


def free_study(sensors, free, vehicle=None, **mounting):
    rig = pe.Rig(sensors)
    settings = pe.Search(free=dict.fromkeys((s.name for s in rig), free))
    settings = replace(settings, mounting=pe.Mounting(**mounting))
    return pe.Study(rig, vehicle, shapes.small_space(), search=settings)


def test_rules_slots_fixed_sensors_and_kept_requirements_forbid_steps():
    model = shapes.small_lidar(4, 90)
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(1.0, 2.0))])
    roof = pe.Sensor("roof", model, pe.Pose((0.995, 0.0, 1.8), (0.0, 0.0, 0.0)))
    given = free_study([roof], ("x",), constraints=limits)
    assert active(given)["roof x +1 cm"].name == "no_go 'hatch' for 'roof'"

    slots = [pe.Slot(f"{x}", pe.Pose((x, 0.0, 1.8), (0.0, 0.0, 0.0))) for x in (0.0, 0.7)]
    on = {"mounts": {"rack": pe.SlotMount(slots)}, "on": {"roof": "rack"}}
    racked = free_study([roof.moved(slots[-1].pose)], (), **on)
    assert active(racked)["roof z +1 cm"].name == "slots of 'rack'"

    settings = replace(given.search, goals=Goals(fixed=("roof",)))
    assert active(replace(given, search=settings))["roof x +1 cm"].constraints[0] == (
        "x of 'roof' held"
    )
    design = Neighbourhood(given.rig, given.search_space())
    table = list(flatness(slope(given.rig), design.status, (NEAR,)))
    found = active_constraints(table, design, lambda _: ["front"])
    assert all(each.constraints[-1] == "requirement 'front'" for each in found)


def test_a_step_along_a_surface_is_allowed_and_one_off_it_is_not():
    mounts = {"top": pe.SurfaceMount(("body",))}
    roof = shapes.lidar_on_roof(shapes.small_lidar(4, 90), (0.0, 0.0, 0.9))
    given = free_study([roof], (), shapes.box_car(), mounts=mounts, on={"roof": "top"})
    given = replace(given, rig=Parametrization(given.rig, given.search_space()).start.rig)
    design = Neighbourhood(given.rig, given.search_space())
    assert design.status("roof", "x") == "surface"
    assert design.forbidding(PoseStep("roof", "x", 1.0)) == ()
    assert design.forbidding(PoseStep("roof", "z", 1.0)) == ("mount 'top'",)


def at(rig, x):
    _, y, z = rig["roof"].pose.position
    return rig.with_poses([pe.Pose.from_degrees((x, y, z), (0.0, 0.0, 0.0))])


def test_another_optimum_is_told_from_the_flank_of_the_same_one():
    given = study(free={"roof": ("x",)}, limits={"roof": {"x": (-2.0, 2.0)}})
    best = at(given.rig, -1.0)
    archive = Archive()
    for x in (-1.0, -0.98, -0.4, -0.1, 0.7, 1.0, 1.05):
        rig = at(given.rig, x)
        archive.note(rig, 0, wells(x))
    archive.note(at(given.rig, 1.9), 0, math.inf)  # not below the best so far
    xs = [rig["roof"].pose.position[0] for rig in archive.placements()]
    assert xs == [-1.0, 1.05, 0.7, -0.4, -0.1]
    endings = Basins(StepCosts(best, [Known(wells)]), given.search_space()).endings(
        archive.placements()
    )
    assert (endings.examined, endings.same_basin, len(endings.runners_up)) == (4, 2, 1)
    [other] = endings.runners_up
    assert other.rig["roof"].pose.position[0] == 1.05  # the best of its basin that was evaluated
    assert other.behind == pytest.approx(0.1225) and other.moved == ("roof",)


def test_it_is_in_result_json_and_on_the_terminal(outcome):
    table = result_dict(outcome)["sensitivity"]
    assert len(table["axes"]) == 6
    text = summary(outcome)
    for line in sensitivity_lines(outcome.sensitivity):
        assert line in text
