"""What a search's result means for who mounts it: what rounding cost, and where its best agree."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from pe_core.base.codec import Recorded
from pe_core.base.setting import NotStored, Part
from pe_core.base.values import error_text, rounded
from pe_core.geometry.poses import rotate
from pe_core.scene.rig import Rig
from pe_core.scoring.score import SURE
from pe_core.search import Mounting, Value

TEN = 10
APART_M = 0.01
APART_RAD = math.radians(1.0)
"""How many of the best placements are compared, and how far two of them differ at least: at one
sensor by this distance or by this angle. Steps of one descent are no two opinions."""
CM = 100.0


@dataclass(frozen=True, slots=True)
class Rounding(Recorded):
    """What it costs to have a placement on the study's grid.

    `cost`: How much worse its value is than that of the best one off the grid [nats, or expected
        AP], on samples that the search did not use; None where no placement on the grid is allowed.
    `stderr`: The standard error of that.
    `evaluations`: How many placements on the grid were evaluated.
    `off`: Coordinates whose bounds have no value on the grid.
    `rig`: The placement.
    """

    cost: float | None
    stderr: float
    evaluations: int
    off: Annotated[tuple[str, ...], Part(key="off_grid")] = ()
    rig: Annotated[Rig | None, NotStored] = None

    def lines(self, unit: str) -> list[str]:
        """Return what rounding cost in lines."""
        looked = f"{self.evaluations} placements on the grid evaluated"
        if self.cost is None:
            return [f"no placement on the grid near the best one is allowed; {looked}"]
        sure = f" +- {error_text(self.stderr)}" if self.stderr else ""
        cost = f"costs {self.cost:+.4f}{sure} {unit}"
        if abs(self.cost) <= SURE * self.stderr:
            cost = f"costs nothing beyond{sure} {unit}"
        off = [f"not on the grid, by its bounds: {', '.join(self.off)}"] if self.off else []
        return [f"on the grid, which {cost}; {looked}", *off]


@dataclass(frozen=True, slots=True)
class SensorSpread:
    """How far the positions of a sensor are from that of the best placement at most [m], and how
    far it is turned [rad]. `mount` is the name of its mount; empty without one."""

    sensor: str
    distance: float
    angle: float
    mount: str = ""

    def text(self, count: int) -> str:
        """Return it in words: "roof: all ten within 6 cm and 2.0 deg"."""
        on = f" on {self.mount}" if self.mount else ""
        far = f"{math.ceil(CM * self.distance - 1e-9):.0f} cm"
        turned = math.degrees(self.angle)
        by = f" and {math.ceil(10.0 * turned - 1e-9) / 10.0:g} deg" if turned > 0.0 else ""
        return f"{self.sensor}: all {count} within {far}{by}{on}"


@dataclass(frozen=True, slots=True)
class Consensus:
    """Where the best placements of a search agree. `count`: How many, all different. `loss`: How
    much worse the last of them is than the best, on the sample of the search."""

    count: int
    loss: float
    sensors: tuple[SensorSpread, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        rows = [
            {
                "sensor": each.sensor,
                "distance": rounded(each.distance),
                "angle_deg": rounded(math.degrees(each.angle)),
                "mount": each.mount or None,
            }
            for each in self.sensors
        ]
        return {"placements": self.count, "loss": rounded(self.loss), "sensors": rows}

    def lines(self, unit: str) -> list[str]:
        """Return the spread of each sensor in lines, the widest last."""
        head = f"the {self.count} best different placements are within {self.loss:.4f} {unit}"
        return [head, *(each.text(self.count) for each in self.sensors)]


def consensus_of(
    known: Iterable[tuple[int, Value, Rig]], moving: Sequence[str], mounting: Mounting
) -> Consensus | None:
    """Return where the ten best placements agree; None where fewer than two differ.

    Parameters
    ----------
    known : iterable of (int, Value, Rig)
        Levels, values and placements of a search. Those of the last level count.
    moving : sequence of str
        The sensors that the search moves.
    """
    feasible = [each for each in known if each[1].is_feasible]
    last = max((level for level, _, _ in feasible), default=0)
    ranked = sorted(((v, r) for level, v, r in feasible if level == last), key=lambda e: e[0])
    chosen: list[tuple[Value, Rig]] = []
    for value, rig in ranked:
        if len(chosen) < TEN and all(_differ(rig, other, moving) for _, other in chosen):
            chosen.append((value, rig))
    if len(chosen) < 2:
        return None
    (best, first), *others = chosen
    rows = []
    for name in moving:
        apart = [_apart(first, rig, name) for _, rig in others]
        far = max(distance for distance, _ in apart)
        turned = max(angle for _, angle in apart)
        rows.append(SensorSpread(name, far, turned, mounting.on.get(name, "")))
    ordered = tuple(sorted(rows, key=lambda row: (row.distance, row.angle, row.sensor)))
    return Consensus(len(chosen), others[-1][0].objective - best.objective, ordered)


def _differ(one: Rig, other: Rig, moving: Sequence[str]) -> bool:
    apart = (_apart(one, other, name) for name in moving)
    return any(distance >= APART_M or angle >= APART_RAD for distance, angle in apart)


def _apart(one: Rig, other: Rig, name: str) -> tuple[float, float]:
    """Return distance [m] and angle [rad] between the poses of a sensor in two rigs."""
    a = one[name].pose
    b = other[name].pose
    if a == b:
        return 0.0, 0.0
    turn = rotate(a.ground_from_sensor.T, b.ground_from_sensor.T)
    cosine = (float(np.trace(turn)) - 1.0) / 2.0
    angle = math.acos(min(max(cosine, -1.0), 1.0))
    return math.dist(a.position, b.position), angle if angle > 1e-6 else 0.0
