"""What a difference in score is worth: how often the rig with the better score had the higher AP.

The figures are those of docs/validity/difference, in differences.toml. Nothing is said beside a
difference that no pairs of rigs were like.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Protocol

from pe_core import catalog
from pe_core.base.codec import Node, read_value
from pe_core.base.files import decode_text, read_bytes
from pe_core.base.table_reader import load_toml
from pe_core.geometry.grids import PerceptionSpace
from pe_core.prior.prior import Prior
from pe_core.scene.rig import Rig
from pe_core.scoring.targets import TargetRule
from pe_core.search import FIGURES
from pe_core.search.figures import AP, COVERAGE, ENTROPY, TRAFFIC_AP
from pe_core.sensors import PerceptionModel
from pe_core.sensors.camera import CAMERA
from pe_core.sensors.lidar import ALL, LIDAR

from .score_comparison import TRAFFIC, ComparedRow

FILE = Path(__file__).with_name("differences.toml")
KINDS = {
    LIDAR.name: {
        "lidars_layouts": "LiDARs, one vehicle, real layouts",
        "lidars_good": "LiDARs, one vehicle, good placements",
        "lidars_fixed": "LiDARs, one vehicle",
    },
    CAMERA.name: {"cameras": "simulated rigs of cameras all round, seen cars within 50 m"},
}
"""By kind of sensor: rigs that had pairs, the first one counts that the table has, and their
words."""
BESIDE = {
    ENTROPY: ("rig", "", ENTROPY),
    TRAFFIC_AP: (TRAFFIC, "", AP),
    COVERAGE: ("rig", "", COVERAGE),
}
"""Group, name and measure of the row of a comparison that shows a score of the table."""
HEIGHT_M = (0.0, 5.0)
"""What is evaluated above the ground, in the pairs of a row with a distance of its own."""
OF = 10


class ScoredBy(Protocol):
    """What the scores of several rigs have in common: a `Study` has it."""

    @property
    def space(self) -> PerceptionSpace:
        """The evaluated space."""

    @property
    def prior(self) -> Prior:
        """Where objects are expected."""

    @property
    def model(self) -> PerceptionModel:
        """AP curves and fusion."""

    @property
    def targets(self) -> TargetRule:
        """Voxels or objects."""


@dataclass(frozen=True, slots=True)
class Worth:
    """A row of the table: P = 1 / (1 + exp(-k d)) for a difference of d in units of the score.

    Attributes
    ----------
    kind, score : str
        Whose pairs they were (`KINDS`), and the figure that differs.
    k, k_low, k_high : float
        The slope, and its interval (95 %).
    largest : float
        Beyond this a difference counts as it.
    rigs, pairs : int
    source : str
    of_class : str
        The class whose AP of objects in traffic the pairs were scored by; empty: all, by voxels.
    within : float
        The space of the pairs: x and y within it [m]; 0: the default one.
    sensors : (int, int)
        Fewest and most sensors of a rig of the pairs; (0, 0): any number.
    """

    kind: str
    score: str
    k: float
    k_low: float
    k_high: float
    largest: float
    rigs: int
    pairs: int
    source: str
    of_class: str = ""
    within: float = 0.0
    sensors: tuple[int, int] = (0, 0)

    @property
    def beside(self) -> tuple[str, str, str]:
        """Group, name and measure of the row of a comparison that it is said beside."""
        return ("class", self.of_class, AP) if self.of_class else BESIDE[self.score]

    def is_alike(self, by: ScoredBy) -> bool:
        """Whether scores are made as those of the pairs, but for the side of the voxels."""
        space = PerceptionSpace()
        if self.within:
            along = (-self.within, self.within)
            space = PerceptionSpace(along, along, HEIGHT_M)
        targets = by.targets.are_objects and by.targets.traffic
        return (
            (by.space.x, by.space.y, by.space.z) == (space.x, space.y, space.z)
            and by.prior == Prior.road()
            and by.model == PerceptionModel()
            and (targets if self.of_class else not by.targets.are_objects)
        )

    def has_sizes(self, rigs: Sequence[Rig]) -> bool:
        """Whether rigs have as many sensors as those of the pairs had."""
        fewest, most = self.sensors
        return not most or all(fewest <= len(rig) <= most for rig in rigs)

    def of_ten(self, difference: float) -> tuple[int, int, int]:
        """Return of how many of ten such pairs the better one had the higher AP: P, low, high."""
        d = min(abs(difference), self.largest)
        low, own, high = (
            round(OF / (1.0 + math.exp(-k * d))) for k in (self.k_low, self.k, self.k_high)
        )
        return own, low, high


@cache
def worths() -> tuple[Worth, ...]:
    """Return the rows of the table."""
    tables = load_toml(FILE, "differences", decode_text(read_bytes(FILE)))
    rows: tuple[Worth, ...] = read_value(
        tuple[Worth, ...], Node(tables.get("difference", []), FILE.name, "difference")
    )
    return rows


def worth_rows(by: ScoredBy, rigs: Sequence[Rig], one_vehicle: bool) -> dict[str, Worth]:
    """Return by score the row for differences between some rigs; none where no pairs were alike.

    `one_vehicle`: Whether all rigs are on one.
    """
    sensors = [sensor for rig in rigs for sensor in rig]
    kinds = {sensor.kind for sensor in sensors}
    plain = all(sensor.fusion is None and sensor.curve is None for sensor in sensors)
    solid = all(getattr(sensor.model, "returns", ALL) == ALL for sensor in sensors)
    if len(kinds) != 1 or not (plain and solid):
        return {}
    (kind,) = kinds
    if kind == LIDAR.name and not (one_vehicle and same_models(rigs)):
        return {}
    alike = [row for row in worths() if row.is_alike(by) and row.has_sizes(rigs)]
    return preferred(alike, tuple(KINDS.get(kind, ())))


def preferred(rows: Sequence[Worth], kinds: Sequence[str]) -> dict[str, Worth]:
    """Return by score the row of the first of some kinds that has one."""
    return {row.score: row for kind in reversed(kinds) for row in rows if row.kind == kind}


def same_models(rigs: Sequence[Rig]) -> bool:
    """Whether rigs have the same models, in any order."""
    tables = [sorted(repr(catalog.to_table(sensor.model)) for sensor in rig) for rig in rigs]
    return all(table == tables[0] for table in tables)


def worth_text(worth: Worth, difference: float) -> str:
    """Return what a difference is worth: "7 of 10 such differences in entropy went with a better
    detector (5 to 8; LiDARs, one vehicle)"."""
    own, low, high = worth.of_ten(difference)
    name = FIGURES[worth.score].label
    name = name if name[:2].isupper() else name[:1].lower() + name[1:]
    label = next(labels[worth.kind] for labels in KINDS.values() if worth.kind in labels)
    return (
        f"{own} of {OF} such differences in {name} went with a better detector "
        f"({low} to {high}; {label})"
    )


def worth_lines(
    names: Sequence[str], rows: Sequence[ComparedRow], worth: dict[str, Worth]
) -> tuple[str, ...]:
    """Return a sentence for each difference of a rig from the best one that pairs were like.

    `rows` are those of `compare` and of `compare_figures`, `worth` is of `worth_rows`.
    """
    found = []
    by_place = {own.beside: own for own in worth.values()}
    for row in rows:
        own = by_place.get((row.group, row.name, row.measure))
        if own is None or not row.order:
            continue
        first, *others = row.order
        for k in others:
            if row.differ(first, k):
                by = (row.values[first] or 0.0) - (row.values[k] or 0.0)
                text = worth_text(own, by)
                found.append(f"{names[first]} before {names[k]}: {text}.")
    return tuple(found)
