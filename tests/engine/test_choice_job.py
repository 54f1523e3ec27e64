"""Choices: their file, the front of price against entropy, a stop, what is written, the command."""

import csv
import json
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import EvaluatedRig
from pe_core.study import SEARCH
from pe_tools import jobs
from pe_tools.cli import verbs
from pe_tools.cli.front_text import front_summary
from pe_tools.jobs import design_study, front_job, write_front
from tests.engine import mounting
from tests.engine.refusals import wrongly_refused

pytestmark = pytest.mark.usefixtures("few_errors", "no_key_figures")
SPACE = pe.PerceptionSpace((-12, 12), (-8, 8), (0, 3), 0.5)
PRICES = {"Pandar64": 9.0, "Pandar40": 7.0, "Velodyne VLP-16 Puck": 2.0}
LIDARS = [{"model": "Pandar64", "price": 9}, {"model": "HDL-64E", "price": 5}]
ROOF = {"sensors": ["roof"], "option": LIDARS}


def options(names=PRICES):
    return [pe.Option(pe.catalog.load(name), PRICES.get(name, 1.0)) for name in names]


def study(choices, *sensors, free=("x", "pitch"), candidates=3, **limits):
    """A small study on the box car: few voxels, two rounds."""
    sensors = sensors or (mounting.can(),)
    schedule = pe.Schedule(candidates)
    return pe.Study(
        pe.Rig(sensors),
        mounting.car(),
        SPACE,
        search=pe.Search(
            {s.name: free for s in sensors}, samples=1024, schedule=schedule, method="random"
        ),
        samples=2048,
        mesh="car.npz",
        selection=pe.Selection(choices, **limits),
    )


def front_of(study, workers=None):
    job = pt.FrontJob(study, workers)
    for _ in job:
        pass
    return job.trade_off


def test_one_lidar_out_of_three_is_what_exhaustive_search_finds():
    """Every model put there by hand, searched by an ordinary job; what no other beats is left."""
    given = study([pe.Choice(options(), ["roof"])])
    found = front_of(given)
    by_hand = {}
    for name, price in PRICES.items():
        rig = pe.Rig([mounting.can(model=name)])
        job = pt.OptimizeJob(replace(given, rig=rig, selection=pe.Selection()))
        list(job)
        by_hand[name] = (price, job.outcome.after.entropy, job.outcome.study.rig["roof"].pose)
    best = {
        name
        for name, (price, entropy, _) in by_hand.items()
        if not any(p <= price and e <= entropy and n != name for n, (p, e, _) in by_hand.items())
    }
    assert {
        d.name: (d.price, d.entropy, d.study.rig["roof"].pose) for d in found.designs
    } == by_hand
    assert [d.name for d in found.front] == sorted(best, key=PRICES.get)
    assert found.is_complete and found.searched == 3 and len(best) > 1


def test_more_designs_are_looked_at_first_and_the_front_is_the_same(monkeypatch):
    """Nothing is free: a first look then is the search, and what it drops cannot be missed."""
    eye = mounting.can((0.5, 0.0, 1.6), "eye", model="Camera 60 deg")
    choices = [
        pe.Choice(options(["Pandar64", mounting.CAN]), ["roof"], optional=True),
        pe.Choice(options(["Camera 120 deg"]), ["eye"], optional=True),
    ]
    given = study(choices, mounting.can(), eye, free=())
    every = front_of(given)
    monkeypatch.setattr(front_job, "ALL_SEARCHED_UP_TO", 3)
    found = front_of(given)
    assert len(every.designs) == len(found.designs) == 5
    assert found.searched < every.searched == 5
    assert [(d.name, d.entropy) for d in found.front] == [(d.name, d.entropy) for d in every.front]
    assert found.is_complete


def test_a_stop_keeps_the_front_so_far():
    job = pt.FrontJob(study([pe.Choice(options(), ["roof"])]))
    for _ in job:
        if job.trade_off is not None:
            job.stop()
    found = job.trade_off
    assert found.stopped and found.front and not found.is_complete
    assert len(found.designs) == found.searched == 1


def test_a_design_without_a_place_is_reported_and_the_others_stay():
    """The tall can does not fit under a height that the small one keeps to."""
    given = study([pe.Choice(options(["Pandar64", mounting.CAN]), ["roof"])], free=("x",))
    found = front_of(replace(given, limits=pe.Limits(height=mounting.ON_ROOF[2] + 0.04)))
    assert [d.name for d in found.front] == [mounting.CAN]
    assert "height" in found.refused["Pandar64"]


def test_designs_that_keep_requirements_come_first(tmp_path):
    """Points that only the larger LiDARs have: the cheapest is on the front unless they are kept.

    Where no design meets all requirements, the front is of those that break the fewest.
    """
    many, most = (
        pe.requirements.Requirement(
            name,
            pe.requirements.Zone(spots=((f"front + {ahead}", 0.0),)),
            (pe.requirements.BODIES["adult"],),
            pe.requirements.Criterion(points=points),
        )
        for name, ahead, points in (("many", 3, 150), ("most", 9, 1000))
    )
    plain = study([pe.Choice(options(), ["roof"])], free=())

    def front(*requirements, keep):
        limits = pe.Limits(requirements=True if keep else None)
        return front_of(replace(plain, requirements=requirements, limits=limits))

    told = front(many, keep=False)
    kept = front(many, keep=True)
    none = front(many, most, keep=True)
    assert {d.name: d.broken for d in told.designs}[mounting.CAN] == ("many",)
    assert mounting.CAN in [d.name for d in told.front]
    assert kept.front and all(not d.broken for d in kept.front)
    assert {d.name for d in kept.designs} == set(PRICES)
    assert [d.name for d in none.front] == [d.name for d in kept.front]
    assert all(d.broken == ("most",) for d in none.front)
    assert "no design meets all 2 requirements" in front_summary(none)
    assert "(1 of 1 met)" in front_summary(kept)
    rows = {row["name"]: row for row in write_front(kept, tmp_path)["designs"]}
    assert rows[mounting.CAN]["requirements_not_met"] == ["many"]


def test_files_hold_every_design_of_the_front_as_a_study(tmp_path):
    """What is read back scores to the bit what front.json tells."""
    eye = mounting.can((0.5, 0.0, 1.6), "eye", model="Camera 60 deg")
    eyes = pe.Choice(options(["Camera 60 deg"]), ["eye"], optional=True)
    given = study(
        [pe.Choice(options(["Pandar64", mounting.CAN]), ["roof"]), eyes],
        mounting.can(),
        eye,
        free=(),
    )
    found = front_of(given)
    data = write_front(found, tmp_path)
    assert json.loads((tmp_path / "front.json").read_text()) == data
    rows = list(csv.DictReader((tmp_path / "front.csv").open()))
    assert [row["design"] for row in rows if row["on_front"] == "1"] == data["front"]
    on_front = [row for row in data["designs"] if row["on_front"]]
    assert len(on_front) == len(list((tmp_path / "designs").glob("*.toml"))) > 2
    for row in on_front:
        read = pe.load_study(tmp_path / row["study"])
        assert read.evaluator().score(read.rig).entropy == row["entropy"]
        assert not read.selection.choices
        assert {s.name: s.model.name for s in read.rig} == {
            name: model for name, model in row["models"].items() if model is not None
        }


def test_on_a_surface_another_housing_keeps_the_place_of_its_base():
    rig, _ = mounting.space(mounting.can(), mount={"roof": mounting.roof()})
    spots = pe.Mounting({"roof": mounting.roof()}, {"roof": "roof"})
    given = pe.Study(rig, mounting.car(), search=pe.Search(mounting=spots))
    tall = pe.catalog.load("Velodyne HDL-32E")
    changed = design_study(given, {"roof": tall}).rig["roof"]
    base, own = (
        s.pose.position[2] - pe.catalog.housing(s.model.name).optical_center[2]
        for s in (rig["roof"], changed)
    )
    assert own == pytest.approx(base, abs=1e-5)
    assert changed.pose.position[2] > rig["roof"].pose.position[2] + 0.05
    design_study(given, {"roof": tall}).coding()  # its start is on the mount


def test_an_interrupted_front_goes_on_to_the_same_bits(tmp_path, capsys):
    """Journals of half of the searches are lost, and half of the entries of another."""
    given = study([pe.Choice(options(), ["roof"])], free=("pitch",))
    pt.export_study(given, tmp_path / "car.toml")
    file = str(tmp_path / "car.toml")
    out = tmp_path / "out"
    assert verbs.main(["optimize", file, "--json", "-o", str(out)]) == 0
    whole = json.loads(capsys.readouterr().out)
    kept = json.loads((out / "front.json").read_text())
    assert whole["kind"] == "front" and {**whole, "run": 0} == {**kept, "run": 0}
    state = json.loads((out / SEARCH).read_text())
    names = list(state["journals"])
    cut = {n: rows[: len(rows) // (k + 1)] for k, (n, rows) in enumerate(state["journals"].items())}
    assert len(names) == 3 and all(cut.values())
    journals = jobs.FrontJournals({n: [EvaluatedRig(*row) for row in cut[n]] for n in names[:2]})
    begun = jobs.FrontJob(given)
    begun.journals = journals
    jobs.FrontCheckpoint(begun).save(out)
    assert verbs.main(["optimize", "--json", "--resume", str(out)]) == 0
    told = capsys.readouterr()
    resumed = json.loads(told.out)  # the files of the study are those beside the checkpoint
    resumed["inputs"]["study"]["vehicle"] = whole["inputs"]["study"]["vehicle"]
    assert {**resumed, "run": 0} == {**whole, "run": 0}
    assert "going on after" in told.err
    assert json.loads((out / SEARCH).read_text()) == state
    assert verbs.main(["optimize", file, "--seed", "5", "--resume", str(out)]) == 1
    assert "search.json: study: expected the study and the" in capsys.readouterr().err
    (out / SEARCH).write_text("{}")
    assert verbs.main(["optimize", file, "--resume", str(out)]) == 1
    assert "expected the state of a search" in capsys.readouterr().err


def data(choice=(), **more):
    if choice:
        more["selection"] = {**more.get("selection", {}), "choice": list(choice)}
    sensors = [
        {"name": "roof", "model": "Pandar64", "position": [0, 0, 2]},
        {"name": "eye", "model": "Camera 60 deg", "position": [1, 0, 2]},
    ]
    return {"sensor": sensors, **more}


def option(model, price):
    return {"sensors": ["roof"], "option": [{"model": model, "price": price}]}


REFUSED = [
    ("selection.choice[0].option", {"choice": [{"sensors": ["roof"]}]}),
    (
        "selection.choice[0].option[0].price",
        {"choice": [{"sensors": ["roof"], "option": [{"model": "Pandar64"}]}]},
    ),
    ("selection.choice[0].option[0].price", {"choice": [option("Pandar64", -1)]}),
    ("selection.choice[0].option[0].model", {"choice": [option("Pandar65", 1)]}),
    (
        "choice[0]: option",
        {"choice": [option("Pandar64", 1)], "selection": {"max_of_kind": {"lidar": 0}}},
    ),
    ("choice[0]: sensor", {"choice": [{**ROOF, "sensors": ["foot"]}]}),
    ("choice[0]: mount", {"choice": [{"mount": "rack", "option": LIDARS}]}),
    ("selection.choice[0].sensor, mount", {"choice": [{"option": LIDARS}]}),
    ("selection.choice[0].sensor, mount", {"choice": [{**ROOF, "mount": "rack"}]}),
    ("choice[1]: sensor", {"choice": [ROOF, ROOF]}),
    ("selection.choice[0].option", {"choice": [{**ROOF, "option": LIDARS * 2}]}),
    ("selection.choice[0].optional", {"choice": [{**ROOF, "optional": 1}]}),
    ("selection.choice[0].pice", {"choice": [{**ROOF, "pice": 1}]}),
    ("selection.max_of_kind.sonar", {"selection": {"max_of_kind": {"sonar": 1}}}),
    ("limits.price", {"limits": {"price": float("nan")}}),
    ("selection: price", {"choice": [ROOF], "limits": {"price": 4}}),
    ("selection: max_sensors", {"choice": [ROOF], "selection": {"max_sensors": 1}}),
]


def test_what_is_wrong_is_refused():
    assert wrongly_refused(lambda v: pe.study_from_dict(data(**v)), REFUSED) == []


def test_limits_that_leave_nothing_together_are_named_together():
    """A second camera is too many, a LiDAR too dear: each limit alone leaves the other."""
    either = [{"model": "Pandar64", "price": 9}, {"model": "Camera 30 deg", "price": 1}]
    of_kind = {"max_of_kind": {"camera": 1}, "max_sensors": 7}
    choice = [{"sensors": ["roof"], "option": either}]
    with pytest.raises(pe.InputError, match="selection: price and max_of_kind: expected limits"):
        pe.study_from_dict(data(choice=choice, selection=of_kind, limits={"price": 5}))


def test_what_leads_a_group_stays():
    group = {"groups": [["roof", "eye"]]}
    with pytest.raises(pe.InputError, match="optional: expected false for the leading sensor"):
        pe.study_from_dict(data(choice=[{**ROOF, "optional": True}], optimize=group))


def test_the_second_of_a_pair_goes_with_the_first():
    left = {"name": "left", "model": "Pandar64", "position": [0, 1, 2]}
    right = {"name": "right", "model": "Pandar64", "position": [0, -1, 2]}
    rest = {"sensor": [left, right], "optimize": {"pairs": [["left", "right"]]}}
    with pytest.raises(pe.InputError, match="the first of the pair, 'left'"):
        pe.study_from_dict(
            {**rest, "selection": {"choice": [{"sensors": ["right"], "option": LIDARS}]}}
        )
    study = pe.study_from_dict(
        {**rest, "selection": {"choice": [{"sensors": ["left"], "option": LIDARS}]}}
    )
    assert [study.designs().price(picks) for picks in study.designs()] == [10.0, 18.0]
