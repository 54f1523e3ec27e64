"""Designs of a study with choices: their studies and names, and the front of those not beaten."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.notebook import ShortRepr, Tabular
from pe_core.geometry.poses import Pose, rotate
from pe_core.scene.data_sheet import DataSheet
from pe_core.scene.rig import Rig, Sensor, SensorModel
from pe_core.scoring.requirements import Verdict
from pe_core.scoring.score import Score
from pe_core.search import (
    Mounting,
    Selection,
    Start,
    SurfaceMount,
    Value,
    mirrored,
    pose_from_values,
    pose_values,
    standoff_point,
)
from pe_core.search.build_figures import SUMS
from pe_core.search.figures import AP, ENTROPY, PRICE, figure_of
from pe_core.study.study import Study

from ..advice import Advice, curve_note, hardware_note

Models = Mapping[str, SensorModel | None]
NO_SHEETS: Mapping[str, DataSheet] = {}


def design_study(
    study: Study, models: Models, sheets: Mapping[str, DataSheet] = NO_SHEETS
) -> Study:
    """Return the study of a design, without choices. `models` has the model of each sensor that the
    study lets choose, `sheets` what is known of it; None leaves the sensor out. A sensor on a
    surface keeps the position of its base: with a housing of another height, its origin is higher
    or lower."""
    gone = {name for name, model in models.items() if model is None}
    rig = Rig([_taken(sensor, models, sheets) for sensor in study.rig if sensor.name not in gone])
    order = [sensor.name for sensor in rig]
    mounting = study.search.mounting
    goals = study.search.goals
    groups = [[name for name in group if name not in gone] for group in mounting.groups]
    mounting = replace(
        mounting,
        on={name: mount for name, mount in mounting.on.items() if name not in gone},
        pairs=[pair for pair in mounting.pairs if not gone & set(pair)],
        groups=[group for group in groups if len(group) > 1],
    )
    starts = [
        Start(start.name, {n: pose for n, pose in start.poses.items() if n in order})
        for start in goals.starts
    ]
    goals = replace(goals, fixed=[name for name in goals.fixed if name in order], starts=starts)
    rig = rig.with_poses(_seated(study.rig, rig, mounting))
    search = replace(study.search, mounting=mounting, goals=goals)
    conditions = study.conditions.without(gone)
    limits = study.limits.changed(price=None)  # the design is within it
    return replace(
        study, rig=rig, conditions=conditions, search=search, selection=Selection(), limits=limits
    )


def design_names(designs: Sequence[Models]) -> list[str]:
    """Return a name for each design: its models, with their sensors if two designs need it."""
    names = []
    for models in designs:
        counts = Counter(model.name for model in models.values() if model is not None)
        words = (f"{count} x {name}" if count > 1 else name for name, count in counts.items())
        names.append(" + ".join(words) or "none of them")
    twice = {name for name, count in Counter(names).items() if count > 1}
    for k, models in enumerate(designs):
        if names[k] in twice:
            named = (f"{m.name} ({name})" for name, m in models.items() if m is not None)
            names[k] = " + ".join(named)
    return names


def _taken(sensor: Sensor, models: Models, sheets: Mapping[str, DataSheet]) -> Sensor:
    """Return a sensor with its model; a new kind discards its fusion group and AP curve."""
    if (model := models.get(sensor.name)) is None:
        return sensor
    taken = replace(sensor, model=model, sheet=sheets.get(sensor.name, DataSheet()))
    return taken if model.kind == sensor.kind else replace(taken, fusion=None, curve=None)


def _seated(before: Rig, rig: Rig, mounting: Mounting) -> list[Pose]:
    """Return the initial pose of each sensor: bases on surfaces stay, pairs are mirrored."""
    poses = {}
    for sensor in rig:
        mount = mounting.mount_of(sensor.name)
        models = before[sensor.name].model, sensor.model
        poses[sensor.name] = sensor.pose
        if isinstance(mount, SurfaceMount) and models[0] is not models[1]:
            old, new = (standoff_point(mount, catalog.housing(m.name)) for m in models)
            if not np.array_equal(old, new):
                shift = rotate(sensor.pose.ground_from_sensor, old - new).tolist()
                moved = zip("xyz", sensor.pose.position, shift, strict=True)
                values = pose_values(sensor.pose) | {axis: w + by for axis, w, by in moved}
                poses[sensor.name] = pose_from_values(values)
    for first, second in mounting.pairs:
        if poses[first] is not rig[first].pose:
            poses[second] = mirrored(poses[first])
    return [poses[sensor.name] for sensor in rig]


@dataclass(frozen=True, slots=True)
class Design(ShortRepr):
    """A design that was evaluated.

    Attributes
    ----------
    name, models
        `models` are those of the sensors that the study lets choose; None for one that is left out.
    study : Study
        The design as a study, with the best placement found and without choices.
    figures : mapping of str to float
        Its objectives by name, and the price of choices. Of a design that was only screened, the
        study's objective alone; of a search by expected AP, the entropy as well.
    score : Score, optional
        Without a ground map; None for a design that was only screened, which has no verdicts
        either.
    warnings : tuple of Advice
    verdicts : tuple of Verdict
    violation : float
        By how much the placement of a screening breaks constraints; its figure is then the worst.
    """

    name: str
    models: Models
    study: Study
    figures: Mapping[str, float]
    score: Score | None = None
    warnings: tuple[Advice, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    violation: float = 0.0

    @property
    def price(self) -> float:
        """The price of its sensors; 0 without choices."""
        return self.figures.get(PRICE, 0.0)

    @property
    def entropy(self) -> float:
        """Of its placement [nats], that of the score; NaN after a screening by expected AP."""
        given = self.figures.get(ENTROPY, math.nan)
        return given if self.score is None else self.score.entropy

    @property
    def broken(self) -> tuple[str, ...]:
        """Names of the requirements that are not met."""
        return tuple(verdict.requirement.name for verdict in self.verdicts if not verdict.met)

    @property
    def met_text(self) -> str:
        """How many requirements are met: "2 of 3 met"; empty where none was asked for."""
        count = len(self.verdicts)
        return f"{count - len(self.broken)} of {count} met" if count else ""

    @property
    def value(self) -> Value:
        """What its search minimised, as scored: entropy [nats], or minus the expected AP."""
        objective = -self.figures[AP] if AP in self.figures else self.entropy
        return Value(self.violation, objective)

    def costs(self, names: Sequence[str]) -> list[float | Value]:
        """Return its objectives as values to minimise: sums, and figures of its placement."""
        costs = ((name, figure_of(name).signed(self.figures[name])) for name in names)
        return [cost if name in SUMS else Value(self.violation, cost) for name, cost in costs]

    @property
    def is_infeasible(self) -> bool:
        """Whether its value is no figure: the screening found no placement to keep."""
        return self.violation > 0.0


@dataclass(frozen=True, slots=True)
class TradeOff(Tabular):
    """The result of a choice of sensors.

    Attributes
    ----------
    study : Study
        The study with its choices.
    designs : tuple of Design
        All evaluated designs with a feasible placement, by their objectives.
    front : tuple of Design
        Designs that no other design beats in all objectives. Only
        designs that were searched are compared, if there are any; if the search keeps requirements,
        only those of them that break the fewest.
    refused : mapping of name to str
        Why designs have no feasible placement.
    is_complete, stopped : bool
        Whether all designs within the limits were evaluated, and whether the job was stopped early.
    seconds : float
    objectives : tuple of str
        Those of the front, by default price and entropy (or AP).
    """

    study: Study
    designs: tuple[Design, ...]
    front: tuple[Design, ...]
    refused: dict[str, str] = field(default_factory=dict)
    is_complete: bool = True
    stopped: bool = False
    seconds: float = 0.0
    objectives: tuple[str, ...] = ()

    def _rows(self) -> list[dict[str, Any]]:
        return [
            {"design": d.name, "entropy [nats]": d.entropy, **d.figures}
            | {"on the front": d in self.front, "requirements": d.met_text or None}
            for d in self.designs
        ]

    @property
    def searched(self) -> int:
        """How many designs were searched in full."""
        return sum(design.score is not None for design in self.designs)

    @property
    def told(self) -> str:
        """What is on the front, and of how many designs."""
        labels = ", ".join(figure_of(name).name for name in self.objectives)
        of_all = f"{len(self.front)} on the front of {labels}"
        if not self.study.selection.choices or self.study.search.goals.front.objectives:
            return of_all
        count = len(self.designs) + len(self.refused)
        more = "of more"
        every = "all that the limits allow" if self.is_complete else more
        return f"{of_all}; {self.searched} searched of {count} looked at ({every})"

    @property
    def requirements_note(self) -> str:
        """What the designs of the front make of the study's requirements; empty without any."""
        count = len(self.study.requirements)
        if not count or not self.front or not self.searched:
            return ""
        fewest = min(len(design.broken) for design in self.front)
        if self.study.limits.keeps_requirements and fewest:
            some = f"the fewest broken are {fewest}, by the designs of the front"
            return f"no design meets all {count} requirements: {some}"
        good = sum(not design.broken for design in self.front)
        return f"{good} of {len(self.front)} on the front meet all {count} requirements"

    @property
    def notes(self) -> list[str]:
        """What limits a front: entropies of other sensors, AP that is not the paper's."""
        return [note for note in (self.hardware_note, curve_note([self.study])) if note]

    @property
    def hardware_note(self) -> str:
        """What limits a front by entropy of designs with other sensors; empty for others."""
        if ENTROPY not in self.objectives:
            return ""
        return hardware_note([s.model for s in design.study.rig] for design in self.front)
