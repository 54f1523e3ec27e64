"""A request: a snapshot of a scene as plain values, for a worker thread."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..choices import FocusRegion, LimitBox
from ..engine import graphics
from ..view.view_settings import ALL, ViewSettings

if TYPE_CHECKING:
    from ..engine import advice, jobs, motion, pe, requirements


@dataclass(frozen=True, slots=True)
class SceneSensor:
    """A sensor of the scene, and its state there. `color` is its colour; `drawn` whether its own
    layers are shown, `counted` whether it is scored."""

    sensor: pe.Sensor
    color: graphics.Rgb
    selected: bool = False
    drawn: bool = True
    counted: bool = True

    @property
    def key(self) -> Hashable:
        """Identifies the sensor with its pose and model."""
        sensor = self.sensor
        of = sensor.name, id(sensor.model), sensor.pose
        return *of, sensor.group, sensor.curve, self.color


@dataclass(frozen=True, slots=True, eq=False)
class MountFaces:
    """The surface (F, 3, 3) [m] of a mount; `key` identifies it, `strong` is how it is drawn."""

    name: str
    key: Hashable
    triangles: NDArray[np.float64]
    strong: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class SteeredSensor:
    """The sensor whose best way is shown, by name, and the study that says where it may go. `key`
    identifies both."""

    name: str
    study: pe.Study
    key: Hashable


@dataclass(frozen=True, slots=True)
class ViewRequest:
    """A snapshot of a scene: everything that the layers depend on.

    `body_key` identifies the vehicle, `prior_key` prior, space, AP curves and targets; `moving`: an
    approximate picture now is better than a fine one later. `scored` is the ground map of the last
    score, of all voxels, where the scene has not changed since. `ghosts` are the sensors of another
    variant; with `ghosts_title` those of a running search, or of suggestions. `compared` are the
    sensors that the difference map compares with. `requirement` is the name of the selected
    requirement, `scenario` the selected scenario, which is played with `rate_hz` frames a second.
    """

    sensors: tuple[SceneSensor, ...]
    vehicle: pe.Vehicle | None
    body_key: Hashable
    prior: pe.Prior | None
    prior_key: Hashable
    view: ViewSettings
    moving: bool = False
    scored: pe.GroundMap | None = None
    space: pe.PerceptionSpace | None = None
    model: pe.PerceptionModel | None = None
    targets: pe.TargetRule | None = None
    ghosts: tuple[pe.Sensor, ...] = ()
    ghosts_name: str = ""
    ghosts_title: str = ""
    place: advice.AskedPlace | None = None
    mounts: tuple[MountFaces, ...] = ()
    boxes: tuple[LimitBox, ...] = ()
    focus: tuple[FocusRegion, ...] = ()
    compared: tuple[pe.Sensor, ...] = ()
    compared_name: str = ""
    has_result: bool = False
    reference: pe.Reference | None = None
    requirements: tuple[requirements.Requirement, ...] = ()
    requirements_key: Hashable = None
    requirement: str = ""
    scenario: motion.Scenario | None = None
    confirmation: motion.Confirmation | None = None
    rates: tuple[tuple[str, float], ...] = ()
    rate_hz: float = 24.0
    where: jobs.PlaceMap | None = None
    region: advice.FreeRegion | None = None
    steered: SteeredSensor | None = None

    @property
    def counted(self) -> tuple[SceneSensor, ...]:
        """The sensors that are scored."""
        return tuple(each for each in self.sensors if each.counted)

    @property
    def is_wiped(self) -> bool:
        """Whether one view shows the ground of two variants."""
        return self.view.wipe and bool(self.ghosts) and not self.ghosts_title

    @property
    def of_other(self) -> ViewRequest:
        """The same request for the sensors of the other variant."""
        colors = graphics.sensor_colors(self.ghosts)
        sensors = tuple(SceneSensor(each, colors[each.name]) for each in self.ghosts)
        return replace(self, sensors=sensors)

    def of_beams(self) -> tuple[SceneSensor, ...]:
        """Return the sensors whose beams are to be drawn."""
        everyone = self.view.beams_of == ALL
        return tuple(
            each
            for each in self.sensors
            if each.drawn
            and graphics.drawing_of(each.sensor.kind).beams
            and (everyone or each.selected)
        )
