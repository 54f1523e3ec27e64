"""Key figures: what a rig is decided by beside its entropy, a row a figure.

What is wanted of a rig, what a search keeps, the dashboard of the panel and the lines of a score
follow from the rows of `KEY_FIGURES`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from ..base.setting import Panel, check_settings, setting
from ..base.values import Number, Whole, rounded
from ..scene.rig import Rig
from ..scoring.score import TrafficAp
from ..scoring.sight.blind_ground import BLIND_TO_M, WITHIN_M, BlindSector, shown_end, shown_reach
from .build_figures import BUILD_FIGURES, Placement

if TYPE_CHECKING:
    from ..scoring.sight import Sight

REQUIREMENTS, ENTROPY = "requirements", "entropy"
NO_FIGURE = "-"
NONE_WANTED = -100
"""A field of the panel with this value or a lower one asks for nothing: 0 may be wanted."""


def blind_height(sight: Sight) -> float:
    """Return the height for which blind ground is computed [m]: the space may begin above it."""
    return max(BLIND_TO_M, sight.space.z[0])


def blind_area(sight: Sight, rig: Rig) -> float:
    """Return the ground within 10 m of the body where a child is invisible to a rig [m2]. It is the
    area of `Sight.blind` for a body of `BLIND_TO_M`, or of the lowest height of the space if that
    is greater. It is never too small."""
    return rounded(sight.blind_area(rig, blind_height(sight)))


def reaches(sight: Sight, rig: Rig) -> dict[str, tuple[float, bool]]:
    """Return by class how far ahead it is found [m], and whether that ends with the space. Empty
    where objects are scored: that score has their reach."""
    if sight.targets.are_objects:
        return {}
    return {name: sight.reach_ahead(rig, name) for name in sight.prior.class_names}


PARTS: dict[str, Callable[[Sight, Rig], Any]] = {
    "blind_m2": blind_area,
    "sectors": lambda sight, rig: sight.blind_sectors(rig),
    "reach": reaches,
    "traffic": lambda sight, rig: sight.in_traffic(rig),
}
"""Computations by the field of `KeyFigures` that they give; several figures share one."""


@dataclass(frozen=True, slots=True)
class KeyFigures:
    """What a rig is decided by beside its entropy: expected AP in traffic, and what is blind.

    `traffic`: None where the prior's objects have no room, or a sensor has a curve of its own.
    `sectors`: The widest blind sector for bodies of each height.
    `blind_m2, height, within`: Ground within a distance of the body's rectangle on which an object
        `height` tall is invisible [m2, m, m].
    `reach`: By class: how far ahead of the origin an object is found with an AP of 0.5 or more [m];
        0: it is not; and whether the space ends there: the true reach may be longer. Empty where
        objects are scored: that score already has it.
    `over_frames`: Entropy over the study's frames [nats]; None for one frame.
    `margins`: By story, where a study has some: its margin [s]; None: never confirmed.
    `built, unknown`: What can be built, by the names of `BUILD_FIGURES`: the figures that are
        known, and of which sensors the others are not.
    """

    traffic: TrafficAp | None
    sectors: tuple[BlindSector, ...]
    blind_m2: float
    height: float
    within: float
    reach: Mapping[str, tuple[float, bool]] = field(default_factory=dict)
    over_frames: float | None = None
    margins: Mapping[str, float | None] = field(default_factory=dict)
    built: Mapping[str, float] = field(default_factory=dict)
    unknown: Mapping[str, Sequence[str]] = field(default_factory=dict)

    @classmethod
    def of_rig(cls, sight: Sight, rig: Rig) -> KeyFigures:
        """Return the key figures of a rig; `InputError` where the ground is not in the space."""
        found = {name: part(sight, rig) for name, part in PARTS.items()}
        placed = Placement.on(rig, sight.vehicle)
        unknown = {key: list(row.lacking(placed)) for key, row in BUILD_FIGURES.items()}
        values = {key: row.value(placed) for key, row in BUILD_FIGURES.items()}
        return cls(
            **found,
            height=blind_height(sight),
            within=WITHIN_M,
            over_frames=sight.over_frames(rig),
            built={key: rounded(value) for key, value in values.items() if value is not None},
            unknown={key: lacking for key, lacking in unknown.items() if lacking},
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the figures as plain JSON data."""
        data = {**asdict(self), "sectors": [asdict(sector) for sector in self.sectors]}
        data["reach"] = {name: list(found) for name, found in self.reach.items()}
        if self.traffic is not None:
            data["traffic"]["rings"] = {n: list(ap) for n, ap in self.traffic.rings.items()}
            del data["traffic"]["scatter"]
        return data

    def errors_from(self, other: KeyFigures) -> dict[str, float]:
        """Return the standard errors of the differences from another rig's figures, by the names of
        `KEY_FIGURES`; figures without a scatter are left out."""
        if self.traffic is None or other.traffic is None:
            return {}
        common = self.traffic.rings.keys() & other.traffic.rings.keys()
        return {
            key: self.traffic.error_from(other.traffic, ring)
            for key, ring in AP_RINGS.items()
            if not ring or ring in common
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> KeyFigures:
        """Return the figures from the data of `to_dict`."""
        traffic = data["traffic"]
        if traffic is not None:
            rings = {name: (ap, error) for name, (ap, error) in traffic["rings"].items()}
            traffic = TrafficAp(**{**traffic, "rings": rings})
        sectors = tuple(BlindSector(**each) for each in data["sectors"])
        reach = {name: (metres, more) for name, (metres, more) in data["reach"].items()}
        return cls(**{**data, "traffic": traffic, "sectors": sectors, "reach": reach})


@dataclass(frozen=True, slots=True)
class FigureOfMerit:
    """A figure that a rig is decided by.

    `of` gives its values from what `part` of `PARTS` has found; the worst one counts. A search
    minimises none of them: it may keep the figure, whose `cost` is then no higher than that of what
    is wanted, or of the start. `rule` is that of what is wanted; None: it cannot be typed.
    `is_cut` says whether the space ends there: the true figure may be better.
    """

    key: str
    label: str
    unit: str
    about: str
    decimals: int = 2
    higher: bool = False
    part: str = ""
    of: Callable[[Any], Sequence[float]] = lambda found: ()
    cost: Callable[[float], float] = float
    rule: Number | Whole | None = None
    shown: Callable[[float], float] = float
    is_cut: Callable[[KeyFigures], bool] = lambda figures: False

    @property
    def name(self) -> str:
        """Its label within a sentence."""
        return self.label if self.label.startswith("AP") else self.label.lower()

    def value(self, figures: KeyFigures | None) -> float | None:
        """Return the figure of a rig; None where it is not known."""
        if figures is None or not self.part:
            return None
        values = self.of(getattr(figures, self.part))
        return (min if self.higher else max)(values) if values else None

    def costs(self, found: Any) -> tuple[float, ...]:
        """Return its values as costs, lower is better; a figure that is not known is the worst."""
        return tuple(self.cost_of(value) for value in self.of(found) or (0.0,))

    def cost_of(self, value: float) -> float:
        """Return the cost of a value."""
        return rounded(self.cost(value))

    def is_met(self, value: float, wanted: float) -> bool:
        """Whether a value is as wanted, or better."""
        return self.cost_of(value) <= self.cost_of(wanted)

    def begin(self, value: float) -> float:
        """Return a round number that a value meets: what is wanted begins with it."""
        scale = 10 ** min(self.decimals, 2)
        round_off = math.floor if self.higher else math.ceil
        return (
            round_off(value * scale) / scale if isinstance(self.rule, Number) else math.ceil(value)
        )

    def text(self, value: float | None, is_cut: bool = False) -> str:
        """Return a value with its unit: what is blind is rounded up, a reach down."""
        if value is None:
            return NO_FIGURE
        return f"{self.shown(value):.{self.decimals}f} {self.unit}".strip() + " and more" * is_cut


def _ring(name: str) -> Callable[[TrafficAp | None], Sequence[float]]:
    return lambda found: [found.rings[name][0]] if found and name in found.rings else []


def _whole(found: TrafficAp | None) -> Sequence[float]:
    return [] if found is None else [found.ap]


AP_RINGS = {"ap_near": "near", "ap_mid": "mid", "ap_far": "far", "traffic_ap": ""}
"""Key figures that are expected AP in traffic, and their rings; empty: all distances."""
_Ap = partial(
    FigureOfMerit, part="traffic", higher=True, cost=lambda ap: 1.0 - ap, rule=Number(0.0, cap=1.0)
)
_Blind = partial(FigureOfMerit, decimals=1, shown=shown_end)
UNSEEN = "where no sensor sees what is"
IN_TRAFFIC = "Expected AP of objects in traffic"
KEY_FIGURES = {
    row.key: row
    for row in (
        _Blind(
            *("blind_ground", "Blind ground", "m2", f"Ground within 10 m {UNSEEN} 0.5 m tall"),
            part="blind_m2",
            of=lambda area: (area,),
            rule=Number(0.0, unit="m2"),
        ),
        _Blind(
            *("blind_sector", "Blind sector", "deg", f"Sector at 20 m {UNSEEN} 0.5 to 1.5 m tall"),
            part="sectors",
            of=lambda sectors: [sector.width for sector in sectors],
            cost=math.ceil,  # closer ones are alike
            rule=Whole(0, 360, unit="deg"),
        ),
        FigureOfMerit(
            *("reach", "Reach", "m", "How far ahead each class is found (AP 0.5): the shortest", 0),
            higher=True,
            part="reach",
            shown=shown_reach,
            of=lambda found: [metres for metres, _ in found.values()],
            is_cut=lambda figures: bool(figures.reach) and min(figures.reach.values())[1],
            cost=lambda metres: 1.0 / (1.0 + metres),
            rule=Number(0.0, unit="m"),
        ),
        _Ap("ap_near", "AP near", "", f"{IN_TRAFFIC} nearer than 10 m", of=_ring("near")),
        _Ap("ap_mid", "AP middle", "", f"{IN_TRAFFIC}, 10 to 40 m", of=_ring("mid")),
        _Ap("ap_far", "AP far", "", f"{IN_TRAFFIC} beyond 40 m", of=_ring("far")),
        _Ap("traffic_ap", "AP in traffic", "", f"{IN_TRAFFIC}, at all distances", 3, of=_whole),
        FigureOfMerit(
            REQUIREMENTS, "Requirements", "met", "Requirements that are met", 0, higher=True
        ),
        FigureOfMerit(
            ENTROPY, "Entropy", "nats", "Perception entropy", 3, rule=Number(-99.0, cap=1e6)
        ),
    )
}
"""What a rig is decided by, by name; the entropy is last."""
KEPT = tuple(key for key, row in KEY_FIGURES.items() if row.part)
"""Figures that a search may keep."""


def _wanted(key: str) -> Any:
    row = KEY_FIGURES[key]
    assert row.rule is not None
    worst = "least" if row.higher else "most"
    digits = None if isinstance(row.rule, Whole) else row.decimals
    panel = Panel(f"wanted_{key}", row.label, none=NONE_WANTED, precision=digits)
    return setting(None, row.rule, f"{row.about} (wanted: at {worst})", panel)


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is wanted of a rig: values of `KEY_FIGURES`, each as bad as it may be."""

    blind_ground: float | None = _wanted("blind_ground")
    blind_sector: int | None = _wanted("blind_sector")
    reach: float | None = _wanted("reach")
    ap_near: float | None = _wanted("ap_near")
    ap_mid: float | None = _wanted("ap_mid")
    ap_far: float | None = _wanted("ap_far")
    traffic_ap: float | None = _wanted("traffic_ap")
    entropy: float | None = _wanted("entropy")

    def __post_init__(self) -> None:
        check_settings(self, "optimize", "wanted.")


@dataclass(frozen=True, slots=True)
class Reading:
    """A row of the dashboard: a figure, its value, what is wanted, whether a search keeps it.
    `value` is None where it is not known. Of requirements `wanted` is how many were checked."""

    figure: FigureOfMerit
    value: float | None
    wanted: float | None = None
    kept: bool = False
    is_cut: bool = False

    @property
    def met(self) -> bool | None:
        """Whether the value is as wanted; None where either is missing."""
        if self.value is None or self.wanted is None:
            return None
        return self.figure.is_met(self.value, self.wanted)

    @property
    def text(self) -> str:
        """The value in words, and where something is wanted whether it is met."""
        row, told = self.figure, self.figure.text(self.value, self.is_cut)
        if row.key == REQUIREMENTS:
            return f"{self.value:.0f} of {self.wanted:.0f} met" if self.value is not None else told
        if self.met is None or self.value is None or self.wanted is None:
            return told
        sign, off = ">=" if row.higher else "<=", row.text(abs(self.value - self.wanted))
        found = "met" if self.met else f"not met, off by {off}"
        return f"{told} ({found}: wanted {sign} {row.text(self.wanted)})"

    def to_dict(self) -> dict[str, Any]:
        """Return the row as plain JSON data."""
        found = {"value": self.value, "wanted": self.wanted, "met": self.met, "kept": self.kept}
        return {"figure": self.figure.key, "unit": self.figure.unit, **found}


def dashboard(
    figures: KeyFigures | None,
    entropy: float | None = None,
    met: Sequence[bool] = (),
    wanted: Wanted | None = None,
    keep: Sequence[str] = (),
) -> tuple[Reading, ...]:
    """Return all rows for a rig; `met` tells of each requirement whether it is met. Of `keep` a
    search keeps what is wanted; where nothing is, what its start has."""
    rows = []
    for key, row in KEY_FIGURES.items():
        value = entropy if key == ENTROPY else row.value(figures)
        asked = getattr(wanted, key, None)
        if key == REQUIREMENTS and met:
            value, asked = float(sum(met)), float(len(met))
        is_cut = figures is not None and row.is_cut(figures)
        rows.append(Reading(row, value, asked, key in keep, is_cut))
    return tuple(rows)
