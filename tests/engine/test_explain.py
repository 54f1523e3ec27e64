"""The verbs explain and compare on the command line."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.search import FIGURES
from pe_tools import advice
from pe_tools.cli.verbs import main
from tests.engine import shapes

PAGE = (Path(pe.__file__).parent.parent / "docs" / "explain.md").read_text("utf-8")


def saved(folder, name, rig=None, **changes):
    """A small study in a file of its own."""
    rig = rig or shapes.roof_rig(16, 180)
    study = shapes.car_study(rig)
    pt.export_study(replace(study, **changes), folder / name)
    return str(folder / name)


@pytest.fixture
def study(tmp_path):
    return saved(tmp_path, "car.toml")


def test_explain_as_json(study, capsys):
    assert main(["explain", study, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    loaded = pe.load_study(study)
    score = loaded.evaluator().score(loaded.rig)
    assert data["score"] == score.to_dict() and data["warnings"] == []
    seen = advice.outlook(loaded.sight(), loaded.rig)
    assert data["words"] == list(advice.rig_words(score, seen, loaded.rig))
    assert {name: data[name] for name in seen.to_dict()} == json.loads(json.dumps(seen.to_dict()))
    assert data["reach"]["class"] == "pedestrian"


def test_explain_one_place(study, capsys):
    assert main(["explain", study, "--at", "8", "-2.2", "0.7"]) == 0
    loaded = pe.load_study(study)
    place = advice.ask_place(
        loaded.rig,
        loaded.space,
        loaded.prior,
        loaded.vehicle,
        point=(8, -2.2, 0.7),
        model=loaded.model,
    )
    out, err = capsys.readouterr()
    assert out.splitlines() == list(place.text)
    assert err == f"{loaded.vehicle_line}\n"  # nothing is scored for it
    assert main(["explain", study, "--at", "8", "-2.2", "0.7", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)["place"]
    assert data == json.loads(json.dumps(place.to_dict())) and data["sensors"][0]["name"] == "roof"


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ("--at 1", "--at: expected X Y, perhaps Z: numbers of metres, found 1"),
        ("--at 1 2 3 4", "--at: expected X Y, perhaps Z: numbers of metres, found 1 2 3 4"),
        ("--at nan 2", "--at: expected X Y, perhaps Z: numbers of metres, found nan 2"),
        ("--at 1 2 3 --body adult", "--at: expected X Y: numbers of metres, found 1 2 3"),
        ("--suggest", "--suggest: expected --at X Y, a place to fix, found none"),
        ("--at 1 2 --body adult --suggest", "--suggest: expected --at X Y, a place to fix, found"),
        ("--heading 30 --at 1 2", "--heading: expected --body NAME, which it turns, found none"),
        ("--class car --at 1 2", "--class: expected no --at: it says whose reach is told, found"),
        ("--samples 2048 --at 1 2", "--samples: expected no --at: a place has no sample, found"),
        ("--at x 2", "argument --at: expected a number, found 'x'"),
    ],
)
def test_what_is_no_place_or_would_be_ignored_is_named_by_its_option(study, asked, message, capsys):
    try:
        assert main(["explain", study, *asked.split()]) == 1
    except SystemExit as usage:
        assert usage.code == 2
    assert message in capsys.readouterr().err


def test_a_body_stands_on_the_ground_and_is_told_with_who_sees_it(study, capsys):
    loaded = pe.load_study(study)
    near, far = (advice.StandingBody("adult", (x, 1.0), 90.0) for x in (8.0, 500.0))
    seen, unseen = advice.see_bodies(loaded.rig, loaded.vehicle, (near, far))
    assert near.objects.centers[0, 2] == pytest.approx(near.objects.sizes[0, 2] / 2.0)
    assert seen.summary.startswith("seen by 1 of 1") and unseen.summary == "seen by no sensor"
    assert seen.text == (
        f"adult at (8, 1) m, heading 90 deg: {seen.summary}",
        f"roof: {seen.sensors[0].m:g} beams",
    )
    where = ["--body", "adult", "--at", "8", "1", "--heading", "90"]
    assert main(["explain", study, *where]) == 0
    assert capsys.readouterr().out.splitlines() == list(seen.text)


def test_compare_tells_blind_ground_reach_and_ap_and_a_known_rig_beside(tmp_path, capsys):
    """The table and the JSON have the engine's key figures; for a wrong rig nothing is scored."""
    study = saved(tmp_path, "car.toml")
    call = ["compare", study, "--samples", "1024", "--beside", "paper_car_camera60"]
    assert main(call) == 0
    lines = capsys.readouterr().out.splitlines()
    first = pe.load_study(study)
    rig = catalog.rig_on(catalog.known_rig("paper_car_camera60"), first.vehicle)
    look = first.sight()
    figures = [advice.KeyFigures.of_rig(look, each) for each in (first.rig, rig)]
    assert lines[0].split() == ["car", "paper_car_camera60"]
    (ground,) = (line for line in lines if line.startswith("  0.5 m tall, within 10 m"))
    row = FIGURES["blind_ground"]
    assert all(row.text(row.value(own)).split()[0] in ground for own in figures)
    assert ground.count("*") == 1, "less blind ground is better"
    title = lines.index(FIGURES["reach"].heading)
    assert lines[title + 1].split()[:2] == ["car", f"{math.floor(figures[0].reach['car'][0])}"]
    assert main([*call, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["figures"] == {
        "car": figures[0].to_dict(),
        "paper_car_camera60": figures[1].to_dict(),
    }
    assert main([*call, "--beside", "nobody"]) == 1
    out, err = capsys.readouterr()
    assert out == "" and "expected" in err and "scoring" not in err


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("prior", {"prior": pe.Prior.uniform()}),
        ("space", {"space": shapes.small_space(1.0)}),
        ("AP curves and fusion", {"model": pe.PerceptionModel("literal")}),
    ],
)
def test_what_does_not_compare_is_refused_in_a_line(study, tmp_path, field, changes, capsys):
    other = saved(tmp_path, "other.toml", **changes)
    assert main(["compare", study, other]) == 1
    out, err = capsys.readouterr()
    expected = (
        f"pe: other: {field}: expected the same as in car, to be compared with it, found another"
    )
    assert (out, err.splitlines()) == ("", [expected])


def without_sight(text):
    """A text without the figures that `Sight` samples: it may come to sample better."""
    lines = re.sub(r"^(a \w+ is found|blind to what is|expected AP).*", r"\1", text, flags=re.M)
    return re.sub(r"\d+% by two or more", "by two or more", lines)


@pytest.mark.parametrize(
    "asked", [pytest.param(("--samples", "65536"), marks=pytest.mark.thorough), ("--at", "-8", "6")]
)
def test_the_page_s_examples_are_what_is_reported(asked, monkeypatch, capsys):
    monkeypatch.chdir(Path(pe.__file__).parent.parent)
    command = ["explain", "blend_assets/experiments/4_cameras.toml", *asked]
    assert main(command) == 0
    example = f"$ pe {' '.join(command)}\n{capsys.readouterr().out}```"
    assert without_sight(example) in without_sight(PAGE)


def test_the_page_names_every_warning():
    rows = set(re.findall(r"`(\w+)`", "\n".join(re.findall(r"^- (`.*?`):", PAGE, re.M))))
    room = Path(advice.__file__).parent
    text = "".join((room / name).read_text() for name in ("mount_checks.py", "vehicle_checks.py"))
    told = set(re.findall(r"(?:Advice|_stand)\(\s*[\w.]+, \"(\w+)\"", text))
    of_studies = {advice.FRAGILE, advice.UNMET, "returns", "range_term"}
    assert told | of_studies == rows and len(rows) == 23
