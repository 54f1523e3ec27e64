"""The last result of a scene: stored as the JSON of its files, read and worded for the panel here.

A scene keeps figures and codes; texts are made when they are asked for.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import bpy
from bpy.types import Object, PropertyGroup, Scene

from ..engine import advice, jobs, known_defects, pe, search, sight, studies
from .requirements import store_verdicts
from .scene_diagnostics import DRIVER, MISSING

MARKING = (MISSING, DRIVER)
"""Codes of warnings that mark a result: what was scored is not what was meant."""
ARROW = " \N{RIGHTWARDS ARROW} "
BEGAN = "began"
"""Key of the scores and figures with which the first of several searches in a row began."""


class ResultPart(NamedTuple):
    """A zone of the ground or a class of objects: its label, entropy [nats], visible share. Of a
    class: the distance ahead up to which it is found with an AP of 0.5; if objects were scored, its
    expected AP."""

    name: str
    is_class: bool
    entropy: float
    coverage: float
    ap: str = ""
    reach: str = ""


class Result:
    """A result as the panel shows it. Entropies are in nats, shares from 0 to 1."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.data = data
        self.after = data["after"]
        began = data.get(BEGAN, data)
        self.before = began["before"]
        self.placed_before = began.get("placements", {}).get("before", {})
        first = began.get("figures", {})
        figures = {"before": first.get("before"), "after": data.get("figures", {}).get("after")}
        self.kind: str = data["kind"]
        self.figures = {which: each for which, each in figures.items() if each is not None}
        self.entropy = self.after["entropy"]
        self.entropy_before = self.before["entropy"]
        self.coverage = self.after["coverage"]
        self.coverage_before = self.before["coverage"]
        self.stderr: float = self.after["stderr"]
        self.change_errors = self._change_errors()
        self.gain: str = data.get("gain", "").replace("+-", "±")
        self.cost: str = data.get("cost", "")
        self.warnings = tuple(advice.Advice(**row) for row in data["warnings"])

    def _change_errors(self) -> dict[str, float]:
        """Return the standard errors of what searches changed, by key figure. Of several searches
        in a row the scores of both ends are of one sample, and no error of their difference is
        kept: it is taken as of independent ones, which is too large."""
        if BEGAN not in self.data:
            return dict(self.data.get("change_stderr", {}))
        errors = {search.ENTROPY: math.hypot(self.before["stderr"], self.stderr)}
        figures = [search.KeyFigures.from_dict(each) for each in self.figures.values()]
        if len(figures) == 2:
            errors |= figures[1].errors_from(figures[0])
        return errors

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """A line for each condition, the mean and the worst, and what a state covers."""
        if (told := self.data.get("conditions")) is None:
            return ()
        rows = tuple(studies.ConditionScore(**row) for row in told["rows"])
        sensors = tuple(told["mean_without"])
        table = studies.ConditionTable(rows, told["samples"], sensors, told["below_ground"])
        lines = (line.strip() for line in jobs.condition_lines(table)[1:])
        warnings = advice.condition_warnings(table)
        return *lines, *(f"{w.subject}: {w.text}" if w.subject else w.text for w in warnings)

    @cached_property
    def missing(self) -> tuple[str, ...]:
        """What the scene lacked when it was scored, and defects that were fixed since."""
        lacking = (each.text for each in self.warnings if each.code in MARKING)
        return *lacking, *known_defects.fixed_since(self.data)

    @property
    def fragile(self) -> str:
        """Why the placement is fragile; empty where it is not."""
        return next((each.text for each in self.warnings if each.code == advice.FRAGILE), "")

    @property
    def ap(self) -> str:
        """The expected AP of all objects with its standard error; empty without objects."""
        found = self.after.get("objects")
        return f"{found['ap']:.3f} ± {advice.error_text(found['ap_stderr'])}" if found else ""

    def robustness(self, which: str) -> str:
        """Return how a figure of robustness ("rise", "loss") changed; empty where it is unknown."""
        if (found := self.data.get("robustness")) is None:
            return ""
        rigs = [search.RigRobustness(**found[when]) for when in ("before", "after")]
        if which == "rise":
            texts = [rig.rise_text("\N{PLUS-MINUS SIGN}") for rig in rigs]
        else:
            texts = [f"{rig.loss:+.3f}" for rig in rigs if rig.loss is not None]
        return f"{ARROW.join(texts)} nats" if texts else ""

    @cached_property
    def parts(self) -> tuple[ResultPart, ...]:
        """Entropy and coverage by zone and by class, for the panel's table."""
        made = []
        for name, part in self.after["per_zone"].items():
            label = advice.WHERE.get(name, name)
            title = label[:1].upper() + label[1:]
            made.append(ResultPart(title, False, part["entropy"], part["coverage"]))
        found = self.after.get("objects", {}).get("per_class", {})
        ahead = self.figures.get("after", {}).get("reach", {})
        for name, part in self.after["per_class"].items():
            found_to, is_least = ahead.get(name, (None, False))
            reach = "" if found_to is None else sight.reach_text(found_to, is_least)
            title = name[:1].upper() + name[1:]
            row = ResultPart(title, True, part["entropy"], part["coverage"], reach=reach)
            if (own := found.get(name)) is not None:
                reach = advice.lone_reach(own["reach"]["front"])
                row = row._replace(ap=f"{own['ap']:.2f}", reach=reach)
            made.append(row)
        return tuple(made)

    @cached_property
    def sensors(self) -> dict[str, pe.SensorScore]:
        """The scores of the sensors, by name."""
        return {name: pe.SensorScore(**own) for name, own in self.after["per_sensor"].items()}


@lru_cache(maxsize=16)
def result_of(text: str) -> Result:
    """Return the result in a text that is not empty."""
    return Result(json.loads(text))


def store_outcome(scene: Scene, outcome: jobs.Outcome, signature: str) -> None:
    """Store an outcome in the scene, as result.json holds it. `signature` is the scene's signature
    at the time when it was read: the scene may have changed since."""
    settings = scene.perception_entropy
    data = jobs.result_dict(outcome, blender_version())
    data["after"] = scored_data(outcome.after, outcome.figures and outcome.figures[1])
    settings.result_json = json.dumps(data)
    settings.result_signature = signature
    store_warnings(settings, outcome.warnings)
    store_verdicts(settings, outcome.verdicts)
    settings.result_stale = False


def stored_result(scene: Scene, study: pe.Study) -> Mapping[str, Any] | None:
    """Return the data of the last result of a scene; None where it is not of the study."""
    settings = scene.perception_entropy
    found = settings.result
    return found.data if found is not None and jobs.is_result_of(found.data, study) else None


def begin_with(settings: PropertyGroup, first: Result) -> None:
    """Note that a search went on from the result of another: it is compared with its start."""
    data = json.loads(settings.result_json)
    data[BEGAN] = first.data.get(BEGAN) or {
        key: first.data[key] for key in ("before", "figures", "placements") if key in first.data
    }
    settings.result_json = json.dumps(data)


def blender_version() -> dict[str, str]:
    """Return the version of Blender, as result.json holds it."""
    return {"blender": bpy.app.version_string}


def figures_of_sensor(obj: Object) -> pe.SensorScore | None:
    """Return an object's figures in the last result of its scene; None where it has none."""
    here = bpy.context.scene
    scene = here if here in obj.users_scene else next(iter(obj.users_scene), None)
    result = None if scene is None else scene.perception_entropy.result
    return None if result is None else result.sensors.get(obj.name)


def sensor_loss(obj: Object) -> str:
    """Return how much the rig's entropy rises without a sensor that has figures, as text."""
    scores = bpy.context.scene.perception_entropy.result.sensors
    return advice.loss_text(scores[obj.name].lost if len(scores) > 1 else None)


def rename_figures(scene: Scene, before: str, name: str) -> None:
    """Keep a sensor's figures in the last result under its new name."""
    settings = scene.perception_entropy
    if settings.has_result and before in settings.result.sensors:
        data = json.loads(settings.result_json)
        own = data["after"]["per_sensor"]
        own[name] = own.pop(before)
        settings.result_json = json.dumps(data)


def store_warnings(settings: PropertyGroup, warnings: Sequence[advice.Advice]) -> None:
    """Store the warnings about a scene's sensors and vehicle, for the panel."""
    rows = [each.to_dict() for each in warnings if each.code != advice.FRAGILE]
    settings.warnings_json = json.dumps(rows)


@lru_cache(maxsize=16)
def warnings_of(text: str) -> tuple[advice.Advice, ...]:
    """Return the warnings in a text; none in an empty one."""
    return tuple(advice.Advice(**row) for row in json.loads(text or "[]"))


class FrontRow(NamedTuple):
    """A design of a Pareto front: its name, its variant's key, and its figures."""

    name: str
    key: int
    figures: str


@dataclass(frozen=True, slots=True)
class ShownFront:
    """The last Pareto front, cheapest first; how it was found, and what limits a comparison."""

    rows: tuple[FrontRow, ...] = ()
    told: str = ""
    note: str = ""

    def to_json(self) -> str:
        """Return the front as text."""
        return json.dumps(asdict(self))


@lru_cache(maxsize=16)
def front_of(text: str) -> ShownFront:
    """Return the front in a text; one without designs in an empty text."""
    data = json.loads(text or "{}")
    return ShownFront(
        **{**data, "rows": tuple(FrontRow._make(row) for row in data.get("rows", ()))}
    )


class ResultViews:
    """What a scene's settings say of the last result, read from their texts."""

    result_json: str
    warnings_json: str
    front_json: str

    @property
    def has_result(self) -> bool:
        """Whether a score is stored."""
        return bool(self.result_json)

    @property
    def result(self) -> Result | None:
        """The last result."""
        return result_of(self.result_json) if self.result_json else None

    @property
    def result_warnings(self) -> tuple[advice.Advice, ...]:
        """The warnings of the last check."""
        return warnings_of(self.warnings_json)

    @property
    def front(self) -> ShownFront:
        """The last Pareto front."""
        return front_of(self.front_json)


def scored_data(score: pe.Score, figures: advice.KeyFigures | None = None) -> dict[str, Any]:
    """Return a score as plain data, with the scatter that the error of a difference needs, and the
    key figures beside it."""
    scatter = {} if score.scatter is None else {"scatter": score.scatter.to_dict()}
    beside = {} if figures is None else {"figures": figures.to_dict()}
    return {**score.to_dict(), **scatter, **beside}


def score_from_dict(figures: Mapping[str, Any]) -> pe.Score:
    """Return a score from plain data."""
    by_class, by_zone = (
        {name: pe.PartScore(**part) for name, part in figures[which].items()}
        for which in ("per_class", "per_zone")
    )
    by_sensor = {name: pe.SensorScore(**own) for name, own in figures["per_sensor"].items()}
    entropy = figures["entropy"]
    coverage = figures["coverage"]
    stderr = figures["stderr"]
    objects = figures.get("objects")
    scatter = figures.get("scatter")
    return pe.Score(
        entropy,
        coverage,
        stderr,
        by_class,
        per_zone=by_zone,
        per_sensor=by_sensor,
        voxels=figures["voxels"],
        objects=None if objects is None else pe.ObjectScore.from_dict(objects),
        scatter=None if scatter is None else pe.Scatter.from_dict(scatter),
    )
