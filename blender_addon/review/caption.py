"""What the picture says in words: text alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..engine import pe

MOST_ROWS = 6
MOST_PARTS = 3
HEADINGS = ("Sensor", "Model", "x, y, z [m]", "Pitch", "Yaw", "Beams stopped by the vehicle")
START_HEADING = "Start: x, y, z [m], pitch"


@dataclass(frozen=True, slots=True)
class Caption:
    """Headline, the line below it, and a table of sensors (headings first)."""

    headline: str
    detail: str
    table: tuple[tuple[str, ...], ...]


def caption_of(study: pe.Study, outcome: pe.Outcome) -> Caption:
    """Return what to say about an outcome; `study` holds the rig that is shown."""
    before, after = outcome.before, outcome.after
    entropy, coverage = f"{after.entropy:.3f}", f"{after.coverage:.1%}"
    if outcome.kind == "optimize":
        entropy = f"{before.entropy:.3f} → {entropy}"
        coverage = f"{before.coverage:.1%} → {coverage}"
    error = f", ± {max(after.stderr, 1e-3):.3f}" if after.stderr else ""
    detail = f"nats{error}; lower is better        coverage {coverage}"
    return Caption(f"Perception entropy  {entropy}", detail, _table(study, outcome))


def position(pose: pe.Pose) -> str:
    """Return a place in metres, to the centimetre: "-0.43, 0.00, 1.80"."""
    return ", ".join(_number(value, 2) for value in pose.position)


def angle(degrees: float) -> str:
    """Return an angle to the tenth of a degree: "-2.5°"."""
    return f"{_number(abs(degrees) if degrees == -180.0 else degrees, 1)}°"


def stopped(score: pe.SensorScore | None) -> str:
    """Return how many beams the vehicle stops, and which parts do: "0.5 % (hood, body)"."""
    if score is None or not score.beams:
        return "–"
    parts = sorted(score.stopped_by, key=lambda part: -score.stopped_by[part])
    named = ", ".join(parts[:MOST_PARTS]) + (", ..." if len(parts) > MOST_PARTS else "")
    return f"{score.stopped / score.beams:.1%}" + (f" ({named})" if named else "")


def _table(study: pe.Study, outcome: pe.Outcome) -> tuple[tuple[str, ...], ...]:
    moved = outcome.kind == "optimize"
    rows = [HEADINGS + ((START_HEADING,) if moved else ())]
    for sensor in study.rig.sensors[:MOST_ROWS]:
        _, pitch, yaw = sensor.pose.rotation_deg
        row = (sensor.name, sensor.model.name, position(sensor.pose), angle(pitch), angle(yaw))
        row += (stopped(outcome.after.per_sensor.get(sensor.name)),)
        rows.append(row + ((_start(outcome, sensor.name),) if moved else ()))
    if len(study.rig) > MOST_ROWS:
        rows.append((f"and {len(study.rig) - MOST_ROWS} more",))
    return tuple(rows)


def _start(outcome: pe.Outcome, name: str) -> str:
    pose = outcome.start.rig[name].pose
    return f"{position(pose)}, {angle(pose.rotation_deg[1])}"


def _number(value: float, decimals: int) -> str:
    """A number with a true minus sign, and no minus before zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")
