"""What each sensor of a rig contributes: a row a sensor, for panels, command line and pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..scene.sensors import Rig
from ..scene.vehicle import Vehicle
from ..scoring.score import Score
from ..scoring.zones import FAR_M, NEAR_M
from .figures import percent
from .mounting import stopped_shares
from .outlook import Outlook

SENSOR_COLUMNS = ("sensor", "loss [nats]", "costs most", "hidden by")
SHORT_ZONES = {
    "front": "ahead",
    "rear": "behind",
    "left": "left",
    "right": "right",
    "near": f"0-{NEAR_M:g} m",
    "mid": f"{NEAR_M:g}-{FAR_M:g} m",
    "far": f"> {FAR_M:g} m",
}
"""Zones (`scoring.zones.ZONES`) as a narrow column has room for them."""
OCCLUDERS_NAMED = 3
MIN_SHARE = 5e-4
"""A part that hides less is not named: the share would read 0.0%."""
MIN_RISE, MIN_LOSS = 0.005, 0.00005
"""Rises below the first would read 0.00, below the second they are none [nats]."""
NO_FIGURE = "-"


@dataclass(frozen=True, slots=True)
class SensorRow:
    """What one sensor contributes to its rig.

    Attributes
    ----------
    name : str
    loss : float or None
        How much the rig's entropy rises when the sensor fails [nats]; None for the only sensor.
    zone : str
        Zone (`scoring.zones.ZONES`) whose entropy rises most; empty where none rises, or unknown.
    zone_loss : float
        How much it rises there [nats], on a sample of the prior.
    hidden_by : dict of float
        Share of the sensor's beams or pixels that each part of the vehicle occludes, highest first.
    """

    name: str
    loss: float | None
    zone: str
    zone_loss: float
    hidden_by: Mapping[str, float]

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Texts of the columns `SENSOR_COLUMNS`."""
        return self.name, loss_text(self.loss), where_text(self), hidden_text(self.hidden_by)

    def to_dict(self) -> dict[str, Any]:
        """Return the row as plain JSON data."""
        return {
            "name": self.name,
            "loss_nats": self.loss,
            "zone": self.zone or None,
            "zone_loss_nats": self.zone_loss if self.zone else None,
            "hidden_by": dict(self.hidden_by),
        }


def sensor_rows(
    score: Score,
    rig: Rig | None = None,
    vehicle: Vehicle | None = None,
    seen: Outlook | None = None,
) -> tuple[SensorRow, ...]:
    """Return a row for every sensor of a score, in the rig's order.

    Parameters
    ----------
    score : Score
    rig, vehicle : Rig, Vehicle, optional
        What was scored: parts that hide pixels of a camera are then known, too.
    seen : Outlook, optional
        Of the same rig: says where the loss of a sensor costs most. Zones of a score on objects are
        unknown.
    """
    only = len(score.per_sensor) == 1
    rows = []
    for name, own in score.per_sensor.items():
        by_zone = {} if seen is None or score.objects else seen.shares.losses[name]
        zone = max(by_zone, key=lambda each: by_zone[each], default="")
        if not zone or by_zone[zone] < MIN_RISE:
            zone = ""
        parts = stopped_shares(None if rig is None else rig[name], own, vehicle)
        shown = {part: share for part, share in parts.items() if share >= MIN_SHARE}
        loss = None if only else own.lost
        rows.append(SensorRow(name, loss, zone, by_zone.get(zone, 0.0), shown))
    return tuple(rows)


def sensor_table(rows: Sequence[SensorRow]) -> list[str]:
    """Return rows as aligned lines of text under a header."""
    table = [SENSOR_COLUMNS, *(row.cells for row in rows)]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if k == 1 else cell.ljust(width)
            for k, (cell, width) in enumerate(zip(cells, widths, strict=True))
        ).rstrip()
        for cells in table
    ]


def loss_text(loss: float | None) -> str:
    """Return what the loss of a sensor costs, in nats: "1.29", "none", or "only"."""
    if loss is None:
        return "only"
    if abs(loss) < MIN_LOSS:
        return "none"
    return f"{max(loss, 0.0) if abs(loss) < MIN_RISE else loss:.2f}"


def where_text(row: SensorRow) -> str:
    """Return where the loss costs most: "> 40 m +2.10"."""
    return f"{SHORT_ZONES[row.zone]} +{row.zone_loss:.2f}" if row.zone else NO_FIGURE


def hidden_text(parts: Mapping[str, float]) -> str:
    """Return the parts that hide a sensor's view with their shares: "roof 6.0%, hood 1.5%"."""
    named = [f"{part} {percent(share)}" for part, share in parts.items()]
    more = ["..."] if len(named) > OCCLUDERS_NAMED else []
    return ", ".join(named[:OCCLUDERS_NAMED] + more) or NO_FIGURE
