"""A built rig against the designed one: sensors paired, how far each is off, what that costs."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pe_core.base.values import rounded
from pe_core.geometry.poses import Pose, rotate, rpy_from_matrix
from pe_core.scene.rig import Rig, Sensor
from pe_core.search import FIGURES

from .score_comparison import ComparedRow

SAME_M = 5e-6
SAME_RAD = math.radians(5e-5)
"""A sensor that is off by no more than the rounding of placements is built as designed."""
ARM_M = 1.0
"""Of two poses that are turned, a point this far from the sensor moves by the angle times this."""
WHOLE = 1
"""Column of the whole built rig in the compared rows: behind the design, before single sensors."""
MM = 1e3


@dataclass(frozen=True, slots=True)
class BuiltPair:
    """A designed sensor and the built one that is meant by it, which may have another name."""

    designed: Sensor
    built: Sensor

    @property
    def name(self) -> str:
        """Name in the design."""
        return self.designed.name

    @property
    def offset(self) -> tuple[float, float, float]:
        """Built position minus the designed one, ground frame [m]."""
        both = zip(self.built.pose.position, self.designed.pose.position, strict=True)
        x, y, z = (rounded(built - designed) for built, designed in both)
        return x, y, z

    @property
    def turn(self) -> tuple[float, float, float]:
        """Roll, pitch and yaw of the built sensor in the designed one's frame [rad]."""
        designed = self.designed.pose.ground_from_sensor
        built = self.built.pose.ground_from_sensor
        roll, pitch, yaw = rpy_from_matrix(rotate(designed.T, built.T).T)
        return rounded(roll), rounded(pitch), rounded(yaw)

    @property
    def distance(self) -> float:
        """How far the built position is from the designed one [m]."""
        return math.hypot(*self.offset)

    @property
    def angle(self) -> float:
        """By how much the built sensor is turned in all [rad]."""
        return _angle(self.designed.pose, self.built.pose)

    @property
    def is_as_designed(self) -> bool:
        """Whether the pose is the designed one, within the rounding of placements."""
        return self.distance <= SAME_M * 2 and self.angle <= SAME_RAD * 4


@dataclass(frozen=True, slots=True)
class Pairing:
    """Pairs of a designed and a built rig. `missing`: Designed sensors that are not built. `extra`:
    Built ones that are not designed."""

    pairs: tuple[BuiltPair, ...]
    missing: tuple[str, ...]
    extra: tuple[str, ...]

    def rig(self, designed: Rig, only: str = "") -> Rig:
        """Return the designed rig at the built poses: of all sensors, or of `only` one."""
        poses = {pair.name: pair.built.pose for pair in self.pairs if not only or pair.name == only}
        return designed.with_poses([poses.get(s.name, s.pose) for s in designed])


def paired(designed: Rig, built: Rig) -> Pairing:
    """Return the pairs of two rigs: by name; of the others the nearest poses first, of the same
    kind as far as there are such. A point `ARM_M` before a sensor tells how far a turn is."""
    rest = {sensor.name: sensor for sensor in built}
    found = {s.name: rest.pop(s.name) for s in designed if s.name in rest}
    left = [sensor for sensor in designed if sensor.name not in found]
    for same_kind in (True, False):
        near = sorted(
            (_apart(one.pose, other.pose), one.name, other.name)
            for one in left
            for other in rest.values()
            if not same_kind or one.kind == other.kind
        )
        for _, name, other in near:
            if name not in found and other in rest:
                found[name] = rest.pop(other)
        left = [sensor for sensor in left if sensor.name not in found]
    pairs = tuple(BuiltPair(s, found[s.name]) for s in designed if s.name in found)
    return Pairing(pairs, tuple(sensor.name for sensor in left), tuple(rest))


def _apart(one: Pose, other: Pose) -> float:
    """Return how far poses are apart: metres, and radians times `ARM_M`."""
    return math.dist(one.position, other.position) + ARM_M * _angle(one, other)


def _angle(one: Pose, other: Pose) -> float:
    """Return the angle between two orientations [rad]."""
    turn = rotate(one.ground_from_sensor.T, other.ground_from_sensor.T)
    # Of the antisymmetric part: exact for small angles, where the trace is not.
    axis = np.array([turn[1, 2] - turn[2, 1], turn[2, 0] - turn[0, 2], turn[0, 1] - turn[1, 0]])
    return rounded(math.atan2(float(np.sqrt((axis**2).sum())), float(np.trace(turn)) - 1.0))


@dataclass(frozen=True, slots=True)
class AsBuilt:
    """A built rig against the designed one.

    `pairing`: Which sensors are meant by which.
    `rows`: Figures of the design, of the whole built rig, and of the design with each single sensor
        as built (`moved`), in this order.
    `moved`: Names of the sensors that are not as designed.
    `fallen`: What the design meets and the built rig does not: requirements and limits.
    `notes`: Messages about the file.
    """

    pairing: Pairing
    rows: tuple[ComparedRow, ...]
    moved: tuple[str, ...]
    fallen: tuple[str, ...]
    notes: tuple[str, ...] = ()

    def costs(self, name: str) -> dict[str, float]:
        """Return by how much each figure of the rig gets worse with one sensor as built, by the
        names of `FIGURES`: positive is worse. Of several rows of a figure the worst one counts."""
        found: dict[str, float] = {}
        for row, k in self._columns(name):
            change = row.differences[k]
            if change is None or not math.isfinite(change):
                continue
            cost = rounded(row.how.signed(change))
            found[row.measure] = max(found.get(row.measure, -math.inf), cost)
        return found

    def is_sure(self, name: str, measure: str) -> bool:
        """Whether a figure gets worse by more than its error tells, with one sensor as built."""
        rows = (row.sense(k) > 0 for row, k in self._columns(name) if row.measure == measure)
        return any(rows)

    def weight(self, name: str) -> float:
        """Return how much one sensor costs: the sum over figures that surely get worse, each in
        its smallest differences that count."""
        costs = self.costs(name)
        return sum(
            cost / FIGURES[key].least for key, cost in costs.items() if self.is_sure(name, key)
        )

    @property
    def worst_first(self) -> tuple[BuiltPair, ...]:
        """The pairs that are off, the most costly first; of equal ones the farthest."""
        off = [pair for pair in self.pairing.pairs if pair.name in self.moved]
        key = {pair.name: (-self.weight(pair.name), -pair.distance, -pair.angle) for pair in off}
        return tuple(sorted(off, key=lambda pair: key[pair.name]))

    @property
    def of_rigs(self) -> tuple[ComparedRow, ...]:
        """The rows of design and whole built rig alone."""
        return tuple(_first_columns(row, WHOLE + 1) for row in self.rows)

    def _columns(self, name: str) -> Iterator[tuple[ComparedRow, int]]:
        if name not in self.moved:
            return
        column = WHOLE + 1 + self.moved.index(name)
        yield from ((row, column) for row in self.rows if row.group in ("rig", "in traffic"))

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "sensors": [self._pair_dict(pair) for pair in self.pairing.pairs],
            "worst_first": [pair.name for pair in self.worst_first],
            "not_built": list(self.pairing.missing),
            "not_designed": list(self.pairing.extra),
            "fallen": list(self.fallen),
            "rows": [row.to_dict() for row in self.of_rigs],
            "notes": list(self.notes),
        }

    def _pair_dict(self, pair: BuiltPair) -> dict[str, Any]:
        return {
            "sensor": pair.name,
            "built_as": pair.built.name,
            "offset_mm": [rounded(MM * v) for v in pair.offset],
            "turn_deg": [rounded(math.degrees(v)) for v in pair.turn],
            "distance_mm": rounded(MM * pair.distance),
            "angle_deg": rounded(math.degrees(pair.angle)),
            "costs": self.costs(pair.name),
        }


def _first_columns(row: ComparedRow, count: int) -> ComparedRow:
    errors = tuple(each[:count] for each in row.errors[:count])
    return ComparedRow(
        row.group, row.name, row.measure, row.values[:count], errors=errors, factor=row.factor
    )


def fallen_verdicts(before: Mapping[str, bool], after: Mapping[str, bool]) -> tuple[str, ...]:
    """Return what was met and no longer is, by name."""
    return tuple(name for name, met in before.items() if met and not after.get(name, False))


def built_table(found: AsBuilt) -> list[Sequence[str]]:
    """Return the sensors that are off as a table: offsets, turns, and costs; * marks what is beyond
    the error."""
    measures = list(dict.fromkeys(row.measure for row in found.rows if row.group == "rig"))
    heads = [FIGURES[key].title for key in measures]
    offsets = [f"{axis} [mm]" for axis in "xyz"]
    turns = [f"{axis} [deg]" for axis in ("roll", "pitch", "yaw")]
    table: list[Sequence[str]] = [["", "built as", *offsets, *turns, *heads]]
    for pair in found.worst_first:
        costs = found.costs(pair.name)
        cells = [_cost_text(found, pair.name, key, costs.get(key)) for key in measures]
        offset = [f"{MM * v:+.1f}" for v in pair.offset]
        turn = [f"{math.degrees(v):+.2f}" for v in pair.turn]
        table.append([pair.name, pair.built.name, *offset, *turn, *cells])
    return table


def pair_text(pair: BuiltPair) -> str:
    """Return how far a sensor is off, in words: "roof: 12.0 mm and 0.40 deg off"."""
    far = f"{MM * pair.distance:.1f} mm"
    return f"{pair.name}: {far} and {math.degrees(pair.angle):.2f} deg off"


def _cost_text(found: AsBuilt, name: str, key: str, cost: float | None) -> str:
    if cost is None:
        return "-"
    row = FIGURES[key]
    change = row.signed(cost) * row.scale
    mark = "*" if found.is_sure(name, key) else " "
    return f"{change:+.{row.decimals}f}{mark}"


def built_sensor_lines(found: AsBuilt) -> list[str]:
    """Return what is told of a built rig beside its table."""
    pairs = found.pairing.pairs
    same = len(pairs) - len(found.moved)
    lines = [f"{same} of {len(pairs)} sensors are as designed"]
    lines += [
        f"{pair.name}: built as {pair.built.name}, the nearest pose"
        for pair in pairs
        if pair.built.name != pair.name
    ]
    lines += [f"{name}: not in the built rig, taken as designed" for name in found.pairing.missing]
    lines += [f"{name}: not in the design, left out" for name in found.pairing.extra]
    lines += [f"no longer met: {name}" for name in found.fallen]
    return [*lines, *found.notes]
