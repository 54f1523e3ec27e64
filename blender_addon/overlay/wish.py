"""What is to be shown, as plain values: what a thread may work from while the scene goes on."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics

if TYPE_CHECKING:
    from ..engine import advice, pe

AVERAGE = "AVERAGE"
SELECTED, ALL, RIG = "SELECTED", "ALL", "RIG"
BY_STATE, BY_SENSOR, BY_CHANNEL = "STATE", "SENSOR", "CHANNEL"


FITTED, WHOLE, FIXED = "FITTED", "WHOLE", "FIXED"
"""What the colours of the ground map are spread over."""


@dataclass(frozen=True, slots=True)
class ViewSettings:
    """Settings of what is shown, by the names that the scene has them under."""

    layers: frozenset[str] = frozenset()
    ground_quantity: str = graphics.SENSORS
    ground_height: float | None = None
    ground_opacity: float = 0.5
    ground_range: str = FITTED
    entropy_range: tuple[float, float] = (0.0, 0.0)
    coverage_range: tuple[float, float] = (0.0, 1.0)
    ground_difference: bool = False
    blind_height: float = 0.0
    reach_class: str = "pedestrian"
    reach_of: str = RIG
    beams_of: str = ALL
    channels: str = graphics.ChannelMode.FEW
    channel: int = 1
    beam_colors: str = BY_SENSOR
    rings: bool = True
    footprints: bool = True
    view_range: float = 12.0
    beam_limit: int = 2000
    beam_length: float = 8.0


@dataclass(frozen=True, slots=True)
class SceneSensor:
    """A sensor of the scene, and what the scene says of it.

    `number` is its place among all of them; `drawn` whether its own picture is wanted, `counted`
    whether it is scored.
    """

    sensor: pe.Sensor
    number: int = 0
    selected: bool = False
    drawn: bool = True
    counted: bool = True

    @property
    def key(self) -> Hashable:
        """Tells it from itself moved, or made another one."""
        sensor = self.sensor
        of = sensor.name, id(sensor.model), sensor.pose
        return *of, sensor.group, sensor.curve, self.number


@dataclass(frozen=True, slots=True, eq=False)
class MountFaces:
    """The surface (F, 3, 3) [m] of a mount; `key` tells it from others, `strong`: draw it so."""

    name: str
    key: Hashable
    triangles: NDArray[np.float64]
    strong: bool = False


@dataclass(frozen=True, slots=True)
class SearchBox:
    """A box of bounds, or one that is forbidden: its lowest and highest corner [m]."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    forbidden: bool = False


@dataclass(frozen=True, slots=True)
class FocusRegion:
    """A focus weight: its areas ((x low, x high), (y low, y high)) [m]; classes None: all."""

    name: str
    factor: float
    areas: tuple[tuple[tuple[float, float], tuple[float, float]], ...]
    classes: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True)
class PictureWish:
    """A scene, as far as what is drawn depends on it.

    `body_key` tells vehicles from others, `prior_key` priors, spaces, AP curves and targets;
    `moving`: a rough picture now is better than a fine one later. `scored` is the ground map of the
    last score, of all voxels, if the scene still is as it was then. `ghosts` are another variant,
    or what a search that runs has found: `searching`. `compared` are the sensors that the
    difference map compares with.
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
    searching: bool = False
    place: advice.AskedPlace | None = None
    mounts: tuple[MountFaces, ...] = ()
    boxes: tuple[SearchBox, ...] = ()
    focus: tuple[FocusRegion, ...] = ()
    compared: tuple[pe.Sensor, ...] = ()
    compared_name: str = ""
    reference: pe.Reference | None = None

    @property
    def counted(self) -> tuple[SceneSensor, ...]:
        """Those that are scored."""
        return tuple(each for each in self.sensors if each.counted)

    def of_beams(self, kinds: frozenset[str]) -> tuple[SceneSensor, ...]:
        """Return those of some kinds whose beams are wanted."""
        everyone = self.view.beams_of == ALL
        wanted = (each for each in self.sensors if each.drawn and each.sensor.kind in kinds)
        return tuple(each for each in wanted if everyone or each.selected)
