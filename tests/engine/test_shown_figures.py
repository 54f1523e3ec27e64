"""What is asked is what is computed: a figure alone is as among all, and nothing else runs."""

import json
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.errors import InputError
from pe_core.metric.frames import Frames
from pe_core.scoring.requirements import BODIES, Requirement, RequirementChecker, Zone
from pe_core.scoring.sight import Sight
from pe_core.search import BUILD_FIGURES, FIGURES, SHOWN, KeyFigures
from pe_core.search.figures import AP_RINGS
from pe_tools.cli.verbs import main
from pe_tools.jobs import ScoreJob
from tests.engine import shapes

CHILD = Requirement("child", Zone(x=(3.0, 5.0), y=(-1.0, 1.0), step=0.5), (BODIES["child"],))
PARTS = {
    "blind_area": {"blind_ground"},
    "blind_sectors": {"blind_sector"},
    "reach_ahead": {"reach"},
    "in_traffic": set(AP_RINGS),
    "over_frames": {"entropy"},
}
"""Methods of a `Sight`, and the figures that need them."""


@pytest.fixture(scope="module")
def study():
    poses = [pe.Pose.from_degrees((x, 0.0, 1.9), (0.0, 5.0, 0.0)) for x in (-0.5, 0.5)]
    models = [shapes.small_lidar(8, 180), shapes.small_lidar(4, 90)]
    sensors = [
        pe.Sensor(name, model, pose)
        for name, model, pose in zip(("roof", "front"), models, poses, strict=True)
    ]
    return shapes.car_study(
        pe.Rig(sensors), samples=1024, requirements=(CHILD,), frames=Frames(frames=2)
    )


@pytest.fixture(scope="module")
def whole(study):
    """The score of the study, with all figures."""
    return ScoreJob(study).run()


@pytest.fixture
def calls(monkeypatch):
    """Names of the methods that are called: those of `PARTS`, and the check of requirements."""
    called = set()

    def spy(owner, name):
        method = getattr(owner, name)

        def counted(*args, **options):
            called.add(name)
            return method(*args, **options)

        monkeypatch.setattr(owner, name, counted)

    for name in PARTS:
        spy(Sight, name)
    spy(RequirementChecker, "steps")
    return called


def dashboard_of(outcome):
    return {row.figure.key: row.value for row in outcome.dashboard}


@pytest.mark.parametrize("name", SHOWN)
def test_a_figure_alone_is_as_among_all_and_nothing_else_is_computed(name, study, whole, calls):
    alone = ScoreJob(replace(study, figures=(name,))).run()
    values = whole.figures_after.values
    assert alone.after == whole.after
    assert alone.figures_after.values == {k: v for k, v in values.items() if k == name}
    shown = {key: value for key, value in dashboard_of(whole).items() if key == name}
    assert dashboard_of(alone) == shown
    needed = {part for part, names in PARTS.items() if name in names}
    assert calls == needed | {"steps"} & ({"steps"} if name == "requirements" else set())


def test_without_a_figure_there_is_the_score_alone(study, whole, calls):
    alone = ScoreJob(replace(study, figures=())).run()
    assert alone.after == whole.after
    assert not (calls or alone.dashboard or alone.verdicts or alone.figures_after.values)


@pytest.mark.parametrize("name", ["reach", "height"])
def test_a_figure_with_a_limit_is_computed_all_the_same(name, study, whole):
    limited = replace(study, figures=("blind_ground",), limits=pe.Limits(**{name: 1.0}))
    found = ScoreJob(limited).run()
    assert found.figures_after.values.keys() == {"blind_ground", name}
    assert found.figures_after.values[name] == whole.figures_after.values[name]
    assert {"blind_ground", name} == dashboard_of(found).keys()


def test_figures_do_not_depend_on_what_else_is_asked(study):
    """Of any pair, on one `Sight`: what one figure has cached serves the next one."""
    sight = study.sight()
    all_values = KeyFigures.of_rig(sight, study.rig).values
    for first in FIGURES:
        for second in ("blind_ground", "traffic_ap", "overlap"):
            found = KeyFigures.of_rig(sight, study.rig, (first, second)).values
            assert found == {k: v for k, v in all_values.items() if k in (first, second)}


@pytest.mark.parametrize("wrong", [["reach", "reach"], ["scenario_margin"], [3], "reach", None])
def test_wrong_names_are_one_error_of_the_field(wrong, study):
    with pytest.raises(InputError) as error:
        replace(study, figures=wrong)
    assert error.value.field == "figures"


def test_an_unknown_name_is_told_the_nearest(study):
    with pytest.raises(InputError) as error:
        replace(study, figures=("blind_sectr",))
    assert "blind_sector" in error.value.expected


@pytest.fixture
def file(study, tmp_path):
    pt.export_study(study, tmp_path / "study.toml")
    return tmp_path / "study.toml"


def printed(capsys, arguments):
    assert main([str(each) for each in arguments]) == 0
    return capsys.readouterr().out


def test_the_command_line_shows_what_is_asked(file, whole, capsys):
    names = ["blind_sector", "overlap"]
    data = json.loads(printed(capsys, ["score", file, "--figures", ",".join(names), "--json"]))
    values = whole.figures_after.values
    assert data["figures"]["after"]["values"] == {name: values[name] for name in names}
    assert [row["figure"] for row in data["dashboard"]] == ["blind_sector"]
    assert "requirements" not in data or not data["requirements"]
    text = printed(capsys, ["score", file, "--figures", ",".join(names)])
    said = {key for key in SHOWN if FIGURES[key].name in text and key != "entropy"}
    assert said - {"distance", "width", "height", "mass", "power", "price", "reach"} == set(names)


def test_the_option_is_the_key(file, capsys):
    asked = printed(capsys, ["score", file, "--figures", "reach, height", "--json"])
    key = printed(capsys, ["score", file, "--set", 'figures=["reach", "height"]', "--json"])
    results = [json.loads(text) for text in (asked, key)]
    for result in results:
        result.pop("run")
    assert results[0] == results[1]


def test_a_comparison_has_what_any_study_asks(file, tmp_path, capsys, study):
    other = tmp_path / "other.toml"
    pt.export_study(replace(study, figures=("blind_sector",)), other)
    pt.export_study(replace(study, figures=("reach",)), file, replace_study=True)
    data = json.loads(printed(capsys, ["compare", file, other, "--json"]))
    rows = {row["measure"]: row["values"] for row in data["rows"] if row["group"] != "zone"}
    assert {"blind_sector", "reach"} <= rows.keys()
    assert not rows.keys() & {"blind_ground", *AP_RINGS}
    assert None not in rows["blind_sector"] + rows["reach"]


def test_a_sweep_computes_what_its_table_shows(file, tmp_path, capsys):
    folder = tmp_path / "sweep"
    tried = "sensor.front.position.0=0.4,0.5,0.6"
    asked = "blind_ground,height"
    text = printed(
        capsys, ["sweep", file, "--set", tried, "--figures", asked, "-o", folder, "--workers", 1]
    )
    rows = json.loads((folder / "sweep.json").read_text("utf-8"))["runs"]
    assert len(rows) == 3
    for row in rows:
        assert row.keys() & {*SHOWN} == {"entropy", "blind_ground", "height"}
    head = text.splitlines()[0]
    assert FIGURES["blind_ground"].name in head
    assert FIGURES["height"].name in head
    assert not any(FIGURES[key].name in head for key in BUILD_FIGURES if key != "height")


def test_runs_of_a_sweep_are_as_scores_of_their_own(file, tmp_path, capsys):
    """They share what has not moved."""
    folder = tmp_path / "sweep"
    places = ("0.4", "0.5", "0.6")
    key = "sensor.front.position.0"
    tried = f"{key}={','.join(places)}"
    printed(capsys, ["sweep", file, "--set", tried, "-o", folder, "--workers", 1])
    for place in places:
        alone = json.loads(printed(capsys, ["score", file, "--set", f"{key}={place}", "--json"]))
        run = json.loads((folder / f"study,{key}={place}" / "result.json").read_text("utf-8"))
        for part in ("after", "figures", "dashboard", "requirements", "warnings"):
            assert run[part] == alone[part]


def test_a_study_file_keeps_them(file, study):
    chosen = replace(study, figures=("reach", "height"))
    pt.export_study(chosen, file, replace_study=True)
    assert pe.load_study(file).figures == chosen.figures
