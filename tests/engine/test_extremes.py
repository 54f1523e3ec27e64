"""Each number of a setting at its ends, next to 0 and beyond all: an answer or one line."""

import dataclasses
import json
import math
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.codec import record
from pe_core.base.setting import Triple, settings_of
from pe_core.base.values import Angle, Number
from pe_core.metric.entropy import ApCurve
from pe_core.metric.frames import Frames
from pe_core.scene.data_sheet import DataSheet
from pe_core.scene.vehicle_description import Reference
from pe_core.scene.vehicle_state import Motion, State
from pe_core.scoring.requirements import BODIES, Criterion, Requirement, Zone
from pe_core.search import Limits
from pe_core.search.goals import Stop
from pe_core.sensors.ultrasonic.kind import Ultrasonic
from pe_core.sensors.weather import Weather
from pe_core.study.condition_table import condition_table
from pe_tools.jobs import result_dict
from tests.engine import shapes
from tests.thorough import tries

pytestmark = [pytest.mark.filterwarnings("error"), pytest.mark.usefixtures("no_key_figures")]

BESIDE = (5e-324, 1e-320, -1e-320, 1e-300, 1e308, -1e308)
LIDAR = shapes.small_lidar(4, 36)
CAMERA = pe.Camera("camera", 32, 24, hfov=1.0)
RADAR = next(m for m in map(pe.catalog.load, pe.catalog.names()) if m.kind == "radar")
ULTRASONIC = Ultrasonic("near", 5.0, 1.2, 0.8)
MODELS = {"lidar": LIDAR, "camera": CAMERA, "radar": RADAR, "ultrasonic": ULTRASONIC}


def extremes(rule):
    """Return numbers at the ends of a rule, beside them, and far beyond."""
    degrees = isinstance(rule, Angle)
    ends = [rule.minimum, rule.maximum, rule.minimum + 5e-324, *BESIDE]
    return [
        float(math.radians(e) if degrees else e) for e in ends if e is not None and math.isfinite(e)
    ]


def numbers_of(model):
    """Return the names of the numbers of a sensor or of a class."""
    return [f.name for f in dataclasses.fields(model) if type(getattr(model, f.name)) is float]


def changes(cls):
    """Yield changes of a class of settings, one at a time."""
    if cls is pe.ObjectClass:
        names = numbers_of(pe.Prior.road().classes[0])
        yield from ({name: end} for name in names for end in (0.0, 5e-324, 1e9))
    for name, declared in settings_of(cls).items():
        rule = declared.rule
        if isinstance(rule, Number | Angle):
            yield from ({name: end} for end in extremes(rule))
        if isinstance(rule, Triple):
            yield from ({name: (0.0, end, 0.0)} for end in extremes(rule.rule))


def rig(model=LIDAR, **sensor):
    return pe.Rig([pe.Sensor("one", model, pe.Pose((0.0, 0.0, 1.8)), **sensor)])


def study(placed=None, **fields):
    space = pe.PerceptionSpace(x=(-12, 12), y=(-8, 8), z=(0, 2), interval=1.0)
    return pe.Study(placed or rig(), shapes.box_car(), **{"space": space, "samples": 1024} | fields)


def answers(given):
    """Score a study as `pe score` does."""
    score = given.evaluator(workers=1).score(given.rig)
    json.dumps(score.to_dict(), allow_nan=False)
    assert math.isfinite(score.entropy)
    for verdict in given.verdicts(given.rig):
        json.dumps(record(verdict.row), allow_nan=False)
    if given.conditions:
        json.dumps(condition_table(given).to_dict(), allow_nan=False)


def searched(**search):
    """Search as `pe optimize` does, in eight evaluations."""
    given = pe.Search(free={"one": ("x", "z", "pitch")}, samples=1024, evaluations=8, **search)
    job = pt.OptimizeJob(study(search=given), 1)
    for _ in job:
        pass
    json.dumps(result_dict(job.outcome), allow_nan=False)


def goal(**goals):
    return replace(pe.Search().goals, **goals)


def in_condition(**conditions):
    answers(study(conditions=pe.Conditions(**conditions)))


def of_classes(change):
    """A class of the prior: its numbers have rules, but are no settings."""
    car = pe.Prior.road().classes[0]
    answers(study(prior=pe.Prior("road", (replace(car, **change),))))


def curve(change):
    model = pe.PerceptionModel(lidar=ApCurve(**{"a": 0.15, "b": 0.6} | change))
    answers(study(model=model))


def keeps(change):
    front = Zone(x=(3.0, 8.0), y=(-2.0, 2.0))
    bodies = (next(iter(BODIES.values())),)
    wanted = Criterion(**{"points": 1} | change)
    answers(study(requirements=(Requirement("front", front, bodies, wanted),)))


USES = {
    ApCurve: curve,
    Frames: lambda change: answers(study(frames=Frames(**{"frames": 3} | change))),
    Weather: lambda change: in_condition(weathers=(Weather("wet", **change),)),
    State: lambda change: in_condition(states=(State("bent", **change), State("as is"))),
    Motion: lambda change: in_condition(
        states=(State("open", motions=(Motion(parts=("cabin",), **change),)),)
    ),
    DataSheet: lambda change: answers(study(rig(sheet=DataSheet(**change)))),
    Reference: lambda change: answers(
        study(reference=Reference(**{"rear_axle_x": -1.3, "rear_axle_z": 0.3} | change))
    ),
    pe.PerceptionModel: lambda change: answers(study(model=pe.PerceptionModel(**change))),
    pe.PerceptionSpace: lambda change: answers(
        study(space=pe.PerceptionSpace(**{"x": (-12, 12), "y": (-8, 8), "z": (0, 2)} | change))
    ),
    Criterion: keeps,
    pe.Tolerance: lambda change: searched(tolerance=pe.Tolerance(**change)),
    pe.Schedule: lambda change: searched(
        schedule=pe.Schedule(**{"candidates": 4} | change), method="random"
    ),
    pe.Constraints: lambda change: searched(
        mounting=pe.Mounting(constraints=pe.Constraints(**change))
    ),
    Stop: lambda change: searched(goals=goal(stop=Stop(**change))),
    Limits: lambda change: answers(study(limits=Limits(**change))),
    pe.Focus: lambda change: answers(
        study(prior=replace(pe.Prior.road(), focus=(pe.Focus(**{"factor": 2.0} | change),)))
    ),
    pe.ObjectClass: of_classes,
}


@pytest.mark.parametrize(
    ("cls", "change"),
    [(cls, change) for cls in USES for change in changes(cls)][:: tries(5, 1)],
    ids=lambda value: getattr(value, "__name__", str(value)),
)
def test_a_setting_at_the_ends_of_its_numbers_has_an_answer_or_one_line(cls, change):
    try:
        USES[cls](change)
    except pe.InputError as error:
        assert "\n" not in str(error) and len(str(error)) < 400


@pytest.mark.parametrize(
    ("kind", "name", "value"),
    [
        (kind, name, value)
        for kind, model in MODELS.items()
        for name in numbers_of(model)
        for value in (0.0, *BESIDE, 1e-3, 1e5, 1e9, math.radians(178.0), math.radians(359.0))
    ][:: tries(5, 1)],
)
def test_a_number_of_a_sensor_at_its_ends_has_an_answer_or_one_line(kind, name, value):
    try:
        answers(study(rig(replace(MODELS[kind], **{name: value}))))
    except pe.InputError as error:
        assert "\n" not in str(error) and len(str(error)) < 400


@pytest.mark.parametrize("cls", USES, ids=lambda cls: cls.__name__)
def test_the_settings_as_they_are_have_an_answer(cls):
    USES[cls]({"share": 1.0} if cls is Criterion else {})


@pytest.mark.parametrize("kind", MODELS)
def test_the_sensors_as_they_are_have_an_answer(kind):
    answers(study(rig(MODELS[kind])))
