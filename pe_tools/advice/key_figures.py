"""The table of a rig's sensors, and what can be built in words."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pe_core.scene.rig import Rig
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.score import FAR_M, NEAR_M, Score
from pe_core.search import NO_FIGURE, KeyFigures
from pe_core.search.build_figures import ALONE, BUILD_FIGURES
from pe_core.search.figures import PRICE
from pe_tools.wording import aligned, percent

from .mount_checks import occluded_shares
from .summary import SIDES, Outlook

SENSOR_COLUMNS = ("sensor", "loss [nats]", "costs most", "occluded by")
SHORT_ZONES = {
    **SIDES,
    "near": f"0-{NEAR_M:g} m",
    "mid": f"{NEAR_M:g}-{FAR_M:g} m",
    "far": f"> {FAR_M:g} m",
}
"""Short text for each zone of `scoring.zones.ZONES`, for a narrow column."""
OCCLUDERS_NAMED = 3
MIN_SHARE = 5e-4  # A part that hides a smaller share is not named: the share would read 0.0%
MIN_RISE = 0.005
MIN_LOSS = 0.00005
"""A rise of entropy [nats] below `MIN_RISE` would read 0.00; below `MIN_LOSS` it counts as none."""


@dataclass(frozen=True, slots=True)
class SensorRow:
    """What one sensor contributes to its rig. `loss` is how much the rig's entropy rises when the
    sensor fails [nats]; None for the only one. `zone` (`scoring.zones.ZONES`) is that whose entropy
    rises most, by `zone_loss` [nats] on a sample of the prior; empty where none rises, or unknown.
    `occluded_by` is the share of the sensor's beams or pixels that each part of the vehicle
    occludes, highest first."""

    name: str
    loss: float | None
    zone: str
    zone_loss: float
    occluded_by: Mapping[str, float]

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Texts of the columns `SENSOR_COLUMNS`."""
        where = f"{SHORT_ZONES[self.zone]} +{self.zone_loss:.2f}" if self.zone else NO_FIGURE
        named = [f"{part} {percent(share)}" for part, share in self.occluded_by.items()]
        more = ["..."] if len(named) > OCCLUDERS_NAMED else []
        hidden = ", ".join(named[:OCCLUDERS_NAMED] + more) or NO_FIGURE
        return self.name, loss_text(self.loss), where, hidden

    def to_dict(self) -> dict[str, Any]:
        """Return the row as plain JSON data."""
        return {
            "name": self.name,
            "loss_nats": self.loss,
            "zone": self.zone or None,
            "zone_loss_nats": self.zone_loss if self.zone else None,
            "occluded_by": dict(self.occluded_by),
        }


def sensor_rows(
    score: Score,
    rig: Rig | None = None,
    vehicle: Vehicle | None = None,
    seen: Outlook | None = None,
) -> tuple[SensorRow, ...]:
    """Return a row for every sensor of a score, in the rig's order. With the rig and the vehicle
    that were scored, the parts that hide pixels of a camera are listed, too. `seen`, the outlook of
    the same rig, has the zone in which the loss of a sensor costs most; for a score on objects this
    zone is unknown."""
    only = len(score.per_sensor) == 1
    rows = []
    for name, sensor_score in score.per_sensor.items():
        by_zone = {} if seen is None or score.objects else seen.shares.losses[name]
        zone = max(by_zone, key=by_zone.__getitem__, default="")
        zone = zone if zone and by_zone[zone] >= MIN_RISE else ""
        parts = occluded_shares(None if rig is None else rig[name], sensor_score, vehicle)
        shown = {part: share for part, share in parts.items() if share >= MIN_SHARE}
        loss = None if only else sensor_score.lost
        rows.append(SensorRow(name, loss, zone, by_zone.get(zone, 0.0), occluded_by=shown))
    return tuple(rows)


def sensor_table(rows: Sequence[SensorRow]) -> list[str]:
    """Return rows as aligned lines of text under a header."""
    return aligned([SENSOR_COLUMNS, *(row.cells for row in rows)], (1,))


def loss_text(loss: float | None) -> str:
    """Return the rise of entropy without a sensor, in nats: "1.29", "none", or "only"."""
    if loss is None:
        return "only"
    if abs(loss) < MIN_LOSS:
        return "none"
    return f"{max(loss, 0.0) if abs(loss) < MIN_RISE else loss:.2f}"


def built_lines(figures: Sequence[KeyFigures]) -> list[str]:
    """Return what can be built in two lines, of one rig, or of start and result; none without it.
    Figures that are not known are named with their sensors; prices only where there are some."""
    last = figures[-1]
    texts = []
    by_sensors = dict[str, list[str]]()
    for key, row in BUILD_FIGURES.items():
        if found := dict.fromkeys(row.text(f.values[key]) for f in figures if key in f.values):
            texts.append(f"{row.name} {' -> '.join(found)}")
        elif (lacking := last.unknown.get(key, (ALONE,))) != (ALONE,) and key != PRICE:
            by_sensors.setdefault(", ".join(lacking), []).append(row.name)
    named = [f"{', '.join(labels)} ({who})" for who, labels in by_sensors.items()]
    lines = {"to build": ", ".join(texts), "unknown": "; ".join(named)}
    return [f"{name}  {text}" for name, text in lines.items() if text]
