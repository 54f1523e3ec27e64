"""A Pareto front of several objectives: its figures, who is on it, its files and its commands."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import Front, Goals, pareto_front
from pe_tools.cli.verbs import main
from pe_tools.jobs import FrontJob, FrontJournals, front_dict
from pe_tools.jobs.front_objectives import FrontFigures, ScalarValue, spread
from pe_tools.page.build import write_front_page
from tests.engine import shapes

NAMES = ("entropy", "height", "worst_loss")

pytestmark = pytest.mark.usefixtures("few_errors", "no_key_figures")


def study(objectives=("entropy", "height"), points=4, **more):
    """Two LiDARs that see more from higher up: the car's roof is in their way."""
    model = shapes.small_lidar(16, 180)
    sensors = [
        shapes.lidar_on_roof(model, (x, 0.0, 1.8), name=n)
        for n, x in (("roof", 0.0), ("front", 1.0))
    ]
    goals = Goals(front=Front(objectives, points))
    free = {"roof": ("z", "pitch"), "front": ("z",)}
    limits = {name: {"z": (1.6, 2.6)} for name in free}
    search = pe.Search(free, limits, samples=1024, evaluations=320, goals=goals)
    given = {"search": search, "samples": 1024} | more
    return shapes.car_study(pe.Rig(sensors), **given)


@pytest.fixture(scope="module")
def whole():
    """A job that has found a front."""
    job = FrontJob(study(), 1)
    steps = list(job)
    assert steps[-1].stage == "done" and {s.stage for s in steps} > {"searching 4 points"}
    return job


@pytest.fixture(scope="module")
def found(whole):
    return whole.trade_off


def test_no_design_of_the_front_is_beaten_and_its_figures_are_those_of_its_rig(found):
    assert 2 <= len(found.front) <= 4 and found.objectives == ("entropy", "height")
    for design in found.front:
        rig = design.study.rig
        assert design.figures["height"] == pytest.approx(
            max(s.pose.position[2] for s in rig), abs=1e-9
        )
        assert design.figures["entropy"] == study().evaluator(1024).entropy(rig)
        for other in found.designs:
            beats = [other.figures[n] <= design.figures[n] for n in found.objectives]
            assert not all(beats) or other.figures == design.figures
    lowest = min(found.front, key=lambda d: d.figures["height"])
    assert lowest.figures["height"] < 1.8 and "best height" in lowest.name
    best = min(found.front, key=lambda d: d.figures["entropy"])
    plain = pt.OptimizeJob(replace(study(), search=replace(study().search, evaluations=40)), 1)
    list(plain)
    assert best.figures["entropy"] <= plain.outcome.before.entropy


def test_a_budget_below_the_number_of_points_is_no_unlimited_one():
    given = study()
    job = FrontJob(replace(given, search=replace(given.search, evaluations=2)), 1)
    list(job)
    assert 1 <= job.evaluations <= 4


def test_figures_are_those_of_plain_functions():
    given = study(NAMES)
    evaluator = given.evaluator(1024)
    figures = FrontFigures(given, NAMES, evaluator)(given.rig)
    alone = [evaluator.entropy(pe.Rig([s])) for s in given.rig]
    assert figures["worst_loss"] == pytest.approx(max(alone) - figures["entropy"], abs=2e-9)
    blind = FrontFigures(given, ("blind_ground", "height"), evaluator)(given.rig)
    assert blind["blind_ground"] == pytest.approx(given.sight().blind(given.rig, 0.5).area)


def test_margins_and_blind_zones_are_those_of_the_verdicts():
    body = pe.requirements.Body("post", (0.3, 0.3, 0.5))
    zone = pe.requirements.Zone(x=(4.0, 5.0), y=(-1.0, 1.0))
    ask = pe.requirements.Requirement("ahead", zone, [body], pe.requirements.Criterion())
    names = ("margin", "blind_zones", "entropy")
    given = study(names, requirements=(ask,))
    figures = FrontFigures(given, names, given.evaluator(1024))
    [verdict] = given.checker().check(given.rig)
    assert figures(given.rig)["margin"] == pytest.approx(verdict.margin)
    assert figures.costs(given.rig)[0] == pytest.approx(-verdict.margin)


def test_a_path_that_fails_and_mounting_errors_count_in_the_margin():
    """A requirement that is not met never leaves the margin at what the others have."""
    body = pe.requirements.Body("post", (0.3, 0.3, 0.5))
    of = pe.requirements.Requirement
    ahead = of("ahead", pe.requirements.Zone(x=(4.0, 5.0), y=(-1.0, 1.0)), [body])
    spots = pe.requirements.Zone(spots=((1.0, 70.0), (5.0, 0.0)))
    names = ("margin", "entropy")

    def margin(*requirements, **keys):
        given = study(names, requirements=requirements)
        given = replace(given, search=replace(given.search, **keys))
        return FrontFigures(given, names, given.evaluator(1024))(given.rig)["margin"]

    assert margin(ahead, of("far", spots, [body])) == pytest.approx(-15.0)
    off = replace(ahead, robust_to=pe.requirements.RobustTo(mounting=True))
    loose = pe.Tolerance(angle=math.radians(40.0), draws=4)
    assert margin(off, tolerance=loose) < margin(ahead, tolerance=loose)


def test_the_front_of_points_is_what_no_other_beats():
    rng = np.random.default_rng(3)
    points = rng.integers(0, 6, (60, 3)).tolist()
    kept = pareto_front(points)
    for k, own in enumerate(points):
        better = [o for o in points if all(a <= b for a, b in zip(o, own, strict=True))]
        worse_than_some = any(o != own for o in better)
        assert (k in kept) == (not worse_than_some and points.index(own) == k)
    chosen = spread([points[k] for k in kept], 3)
    assert len(chosen) == 3 == len(set(chosen))


def test_a_concave_front_is_reached_between_its_ends():
    """A weighted sum would find its ends alone."""

    class Quarter:
        def costs(self, t):
            return [math.cos(t), math.sin(t)]

    value = ScalarValue(Quarter(), (0.5, 0.5), (0.0, 0.0), (1.0, 1.0))
    best = min(np.linspace(0.0, math.pi / 2.0, 91), key=value)
    assert math.degrees(best) == pytest.approx(45.0, abs=1.1)


def test_the_command_line_writes_a_front_and_its_page(tmp_path, capsys):
    given = study(())
    few = replace(given, search=replace(given.search, evaluations=40))
    pt.export_study(few, tmp_path / "study.toml")
    line = ["optimize", str(tmp_path / "study.toml"), "--json"]
    line += ["--set", 'optimize.front.objectives=["entropy", "height"]']
    assert main([*line, "-o", str(tmp_path / "out"), "--workers", "1"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["objectives"] == ["entropy", "height"] and data["front"]
    assert (tmp_path / "out" / "front.html").exists()


def test_a_front_that_resumes_is_the_same(whole):
    again = FrontJob(study(), 1)
    entries = whole.journals.entries()
    again.journals = FrontJournals({n: rows[: len(rows) // 2] for n, rows in entries.items()})
    list(again)
    assert again.journals.entries() == entries
    one, other = (front_dict(each) for each in (again.trade_off, whole.trade_off))
    assert {**one, "run": 0} == {**other, "run": 0}


def test_journals_that_are_not_of_this_front_are_refused(whole):
    """Entries that are left at the end, and the journal of a search that was never begun."""
    entries = whole.journals.entries()
    first = next(iter(entries))
    for wrong in ({first: entries[first] * 2}, {"of another front": entries[first]}):
        job = FrontJob(study(), 1)
        job.journals = FrontJournals(entries | wrong)
        with pytest.raises(pe.InputError, match=r"journals|no more entries"):
            list(job)


def droop(rig):
    """How far the sensors are below the highest place, summed [m]."""
    return sum(2.6 - sensor.pose.position[2] for sensor in rig)


def front_of(objectives, workers=1):
    job = pt.FrontJob(study(()), workers, objectives=objectives)
    list(job)
    return job.trade_off


def test_functions_are_objectives_beside_those_of_a_name(tmp_path):
    found = front_of(("entropy", droop))
    assert found.objectives == ("entropy", "droop") and len(found.front) >= 2
    for design in found.designs:
        assert design.figures["droop"] == pytest.approx(droop(design.study.rig), abs=1e-9)
    lowest = min(found.front, key=lambda d: d.figures["droop"])
    best = min(found.front, key=lambda d: d.figures["entropy"])
    assert lowest.figures["droop"] < best.figures["droop"]
    assert lowest.figures["entropy"] > best.figures["entropy"]
    pt.write_front(found, tmp_path)
    data = json.loads((tmp_path / "front.json").read_text())
    assert data["objectives"] == ["entropy", "droop"]
    write_front_page(found, data, tmp_path)
    assert "Droop" in (tmp_path / "front.html").read_text()


@pytest.mark.parametrize(
    "objectives", [(droop,), (droop, droop), ("entropy", "beauty"), ("entropy",)]
)
def test_objectives_that_are_none_are_refused(objectives):
    with pytest.raises(pe.InputError, match=r"front\.objectives"):
        pt.FrontJob(study(()), 1, objectives=objectives)
