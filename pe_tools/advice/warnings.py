"""Warnings about a rig, its vehicle, its conditions and its AP curves; sensors that see nothing."""

from collections.abc import Iterable
from dataclasses import dataclass

from pe_core.geometry.grids import PerceptionSpace
from pe_core.prior.prior import Prior
from pe_core.scene.rig import Rig, Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.score import Score
from pe_core.sensors import kind_of
from pe_core.sensors.lidar import ALL
from pe_core.study.condition_table import ConditionTable
from pe_core.study.study import Study
from pe_tools.wording import joined, percent

from .advice import Advice
from .mount_checks import SensorAtBody, odd_mounting, odd_place, odd_together
from .vehicle_checks import Bodywork, odd_vehicle

MOSTLY = 0.5
"""A sensor is mostly hidden if the vehicle blocks more than this share of its beams or picture."""
NOTHING_THERE = "no object is expected where it looks"


def warnings(
    rig: Iterable[Sensor],
    vehicle: Vehicle | None,
    space: PerceptionSpace,
    prior: Prior,
    score: Score | None = None,
) -> tuple[Advice, ...]:
    """Return warnings about probable mistakes: of the vehicle, then of the sensors in their order.
    `score` is the rig's: beams that it has counted as occluded are not cast again."""
    body = None if vehicle is None else Bodywork(vehicle)
    found = [] if body is None else [*odd_vehicle(body)]
    sensors = tuple(rig)
    if any(getattr(sensor.model, "returns", ALL) != ALL for sensor in sensors):
        found.append(Advice(None, "returns", {}))
    found += odd_together(sensors)
    for sensor in sensors:
        found += odd_place(sensor, space)
        if body is not None:
            sensor_score = None if score is None else score.per_sensor.get(sensor.name)
            found += odd_mounting(SensorAtBody(sensor, body, sensor_score))
    return tuple(found)


def condition_warnings(table: ConditionTable | None) -> tuple[Advice, ...]:
    """Return the warnings about a table of conditions; none without a table."""
    if table is None:
        return ()
    found = []
    for state, depths in table.below_ground.items():
        part, depth = next(iter(depths.items()))
        values = {"state": state, "depth": depth, "parts": len(depths)}
        found.append(Advice(None, "below_ground", values, part))
    told = set()
    for row in table.rows:
        for sensor, parts in (row.covered or {}).items():
            part, share = max(parts.items(), key=lambda each: each[1])
            if (key := (row.state, sensor)) not in told:
                told.add(key)
                values = {"state": row.state, "share": share}
                found.append(Advice(sensor, "covered", values, part))
    return tuple(found)


def curve_warnings(study: Study) -> tuple[Advice, ...]:
    """Return warnings where AP is not the paper's: range terms of curves."""
    found = []
    model = study.model
    ranged = [f"[ap.{kind}]" for kind, curve in model.curves.items() if curve.c]
    ranged += [f"[ap.objects.{k}.{n}]" for k, own in model.objects.items() for n in own if own[n].c]
    ranged += [f"that of {s.name!r}" for s in study.rig if s.curve and s.curve.c]
    if ranged:
        found.append(Advice(None, "range_term", {"curves": ranged}))
    return tuple(found)


def curve_note(studies: Iterable[Study]) -> str:
    """Return these warnings as lines, once for several studies; empty where none has one."""
    return "\n".join(dict.fromkeys(each.line for s in studies for each in curve_warnings(s)))


@dataclass(frozen=True, slots=True)
class HiddenSensor:
    """A sensor that sees no place where objects are expected, or is mostly hidden by the vehicle.
    `dead` is whether it sees none of the evaluated voxels or objects, `exact` whether all voxels
    were evaluated, not a sample. `lost` is the share of its beams, or of its picture, that the
    vehicle blocks, 0 to 1; 0 for kinds that do not count beams. `why` is the reason as a phrase:
    "inside the body", "86% of its picture occluded"."""

    name: str
    dead: bool
    exact: bool
    lost: float
    why: str


def hidden_sensors(
    rig: Rig, score: Score, warnings: Iterable[Advice] = ()
) -> tuple[HiddenSensor, ...]:
    """Return the sensors of a scored rig that are dead or mostly hidden, the dead ones first.
    `warnings` about this rig tell which sensors are inside the body."""
    inside = {warning.subject for warning in warnings if warning.code == "inside"}
    hidden = []
    for sensor in rig:
        part = score.per_sensor.get(sensor.name)
        if part is None:
            continue
        lost = part.occluded / part.beams if part.beams else 0.0
        dead = part.coverage == 0.0
        enclosed = sensor.name in inside
        if dead or enclosed or lost > MOSTLY:
            why = [
                *(["inside the body"] if enclosed else []),
                *([f"{percent(lost)} of its {kind_of(sensor).occlusion_text}"] if lost else []),
            ]
            phrase = ", ".join(why) or NOTHING_THERE
            hidden.append(HiddenSensor(sensor.name, dead, not score.stderr, lost, why=phrase))
    return tuple(sorted(hidden, key=lambda sensor: not sensor.dead))


def hidden_words(found: Iterable[HiddenSensor]) -> tuple[str, ...]:
    """Return one line about sensors that see nothing, and one about those mostly hidden."""
    sensors = list(found)
    dead = [f"{sensor.name} ({sensor.why})" for sensor in sensors if sensor.dead]
    mostly = [f"{sensor.name} ({sensor.why})" for sensor in sensors if not sensor.dead]
    nothing = "nothing" if all(sensor.exact for sensor in sensors) else "nothing, or next to it"
    lines = []
    if dead:
        lines.append(f"{joined(dead)} {'sees' if len(dead) == 1 else 'see'} {nothing}")
    if mostly:
        lines.append(f"{joined(mostly)} {'is' if len(mostly) == 1 else 'are'} mostly occluded")
    return tuple(lines)
