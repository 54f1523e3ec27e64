"""Key figures: the values of `FIGURES` for a rig, and the dashboard that they are read from."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..base.codec import Recorded
from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.score import TrafficAp
from ..scoring.sight.blind_ground import WITHIN_M, BlindSector
from .build_figures import BUILD_FIGURES
from .figure import Figure
from .figures import (
    AP,
    AP_RINGS,
    BLIND_SECTOR,
    ENTROPY,
    FIGURES,
    REACH,
    REQUIREMENTS,
    SHOWN,
    on_dashboard,
)
from .limit import FigureLimits
from .rig_view import RigView, blind_height

if TYPE_CHECKING:
    from ..scoring.sight import Sight


def shown_figures(named: Collection[str], limits: FigureLimits) -> tuple[str, ...]:
    """Return the names of the figures that are named and of those with a limit, in the order of
    `FIGURES`."""
    asked = {*named, *(key for key, _ in limits)}
    return tuple(key for key in FIGURES if key in asked)


@dataclass(frozen=True, slots=True)
class KeyFigures(Recorded):
    """What a rig is decided by beside its entropy: expected AP in traffic, and what is blind. What
    was not asked for is as what is not known.

    `traffic`: None where the prior's objects have no room, or a sensor has a curve of its own.
    `sectors`: The widest blind sector for bodies of each height.
    `height, within`: Blind ground is that within a distance of the body's rectangle on which an
        object `height` tall is invisible [m, m].
    `values`: The figures that are known, by the names of `FIGURES`.
    `reach`: By class: how far ahead of the origin an object is found with an AP of 0.5 or more [m];
        0: it is not; and whether the space ends there: the true reach may be longer. Empty where
        objects are scored: that score already has it.
    `over_frames`: Entropy over the study's frames [nats]; None for one frame.
    `margins`: By scenario, where a study has some: its margin [s]; None: never confirmed.
    `unknown`: Of what can be built, by the names of `BUILD_FIGURES`: of which sensors it is not
        known.
    """

    traffic: TrafficAp | None
    sectors: tuple[BlindSector, ...]
    height: float
    within: float
    values: Mapping[str, float] = field(default_factory=dict)
    reach: Mapping[str, tuple[float, bool]] = field(default_factory=dict)
    over_frames: float | None = None
    margins: Mapping[str, float | None] = field(default_factory=dict)
    unknown: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @classmethod
    def of_rig(cls, sight: Sight, rig: Rig, names: Collection[str] = SHOWN) -> KeyFigures:
        """Return those key figures of a rig that are named, of `SHOWN`; nothing else is computed.
        `InputError` where blind ground is named and the ground is not in the space."""
        view = RigView(sight, rig)
        rows = {key: row for key, row in FIGURES.items() if key in names}
        found = {key: row.worst(row.values(view)) for key, row in rows.items()}
        built = (key for key in BUILD_FIGURES if key in names)
        unknown = {key: tuple(BUILD_FIGURES[key].lacking(view.placement)) for key in built}
        return cls(
            view.traffic if AP_RINGS.keys() & rows.keys() else None,
            view.sectors if BLIND_SECTOR in rows else (),
            height=blind_height(sight),
            within=WITHIN_M,
            values={key: rounded(value) for key, value in found.items() if value is not None},
            reach=view.reach if REACH in rows else {},
            over_frames=sight.over_frames(rig) if ENTROPY in rows else None,
            unknown={key: lacking for key, lacking in unknown.items() if lacking},
        )

    def errors_from(self, other: KeyFigures) -> dict[str, float]:
        """Return the standard errors of the differences from another rig's figures, by the names of
        `FIGURES`; figures without a scatter are left out."""
        if self.traffic is None or other.traffic is None:
            return {}
        common = self.traffic.rings.keys() & other.traffic.rings.keys()
        return {
            key: self.traffic.error_from(other.traffic, ring)
            for key, ring in AP_RINGS.items()
            if not ring or ring in common
        }


@dataclass(frozen=True, slots=True)
class ReadingRow:
    """A row of the dashboard as plain data: `figure` is a name of `FIGURES`."""

    value: float | None
    wanted: float | None
    met: bool | None
    kept: bool
    figure: str
    unit: str


@dataclass(frozen=True, slots=True)
class Reading:
    """A row of the dashboard: a figure, its value, what is wanted, whether a search keeps it.
    `value` is None where it is not known. Of requirements `wanted` is how many were checked."""

    figure: Figure
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
        row = self.figure
        told = self.figure.text(self.value, self.is_cut)
        if row.key == REQUIREMENTS:
            return f"{self.value:.0f} of {self.wanted:.0f} met" if self.value is not None else told
        if self.met is None or self.value is None or self.wanted is None:
            return told
        sign = ">=" if row.higher else "<="
        off = row.text(abs(self.value - self.wanted))
        found = "met" if self.met else f"not met, off by {off}"
        return f"{told} ({found}: wanted {sign} {row.text(self.wanted)})"

    @property
    def row(self) -> ReadingRow:
        """The row as plain data."""
        return ReadingRow(
            value=self.value,
            wanted=self.wanted,
            met=self.met,
            kept=self.kept,
            figure=self.figure.key,
            unit=self.figure.unit,
        )


def dashboard(
    figures: KeyFigures | None,
    entropy: float | None = None,
    met: Sequence[bool] = (),
    limits: FigureLimits | None = None,
    ap: float | None = None,
    *,
    names: Collection[str] = SHOWN,
) -> tuple[Reading, ...]:
    """Return the rows for a rig: what every rig is decided by, as far as it is named, and what else
    has a limit. `met` tells of each requirement whether it is met; `ap` is the expected AP of the
    score."""
    limits = limits or FigureLimits()
    of_score = {ENTROPY: entropy, AP: ap, REQUIREMENTS: float(sum(met)) if met else None}
    rows = [row for row in on_dashboard() if row.key in names]
    rows += [row for key, _ in limits if (row := FIGURES[key]) not in rows]
    return tuple(
        Reading(
            row,
            of_score.get(row.key, row.value(figures)),
            float(len(met)) if row.key == REQUIREMENTS and met else limits.value(row.key),
            kept=limits.kept(row.key) is not None,
            is_cut=figures is not None and row.is_cut(figures),
        )
        for row in rows
    )
