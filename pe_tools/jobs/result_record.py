"""What result.json holds, declared once: the data, its reader's schema, and the answer of `pe score
--json` are of these classes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pe_core.base.setting import AtTimes, Part
from pe_core.scene.rig import Rig
from pe_core.scoring.requirements import VerdictRow
from pe_core.scoring.score import ObjectScore, Score
from pe_core.search import KeyFigures, ReadingRow
from pe_core.study import Study

from ..advice import Advice

BeforeOrAfter = Literal["before", "after"]
"""Of the given study, and of the result; the same for a score."""
OpenTable = Mapping[str, Any]
"""A part of a result whose keys may change with any version."""


@dataclass(frozen=True, slots=True)
class SensorPlacement:
    """Where a sensor is, in the ground frame: position [m]; roll, pitch and yaw [deg].
    `distances`: from edges of the vehicle, where its position is told from these."""

    position: tuple[float, float, float]
    rotation: tuple[float, float, float]
    distances: Annotated[tuple[str, ...] | None, AtTimes] = None


PlacedSensors = Mapping[str, SensorPlacement]
"""By the name of the sensor."""


def placements(rig: Rig, study: Study | None = None) -> PlacedSensors:
    """Return where every sensor of a rig is; with its study also from edges of the vehicle."""
    placed = {}
    for each in rig:
        told = None if study is None else study.distances(each) or None
        pose = each.pose
        placed[each.name] = SensorPlacement(pose.position, pose.rotation_deg, told)
    return placed


@dataclass(frozen=True, slots=True)
class RunMetadata:
    """How long a run took, and the versions of the programs; of a page, the command."""

    seconds: float
    versions: Mapping[str, str]
    command: Annotated[str | None, AtTimes] = None


@dataclass(frozen=True, slots=True)
class InputsRecord:
    """The study as it was given, and what it was read from."""

    study: OpenTable
    study_sha256: str
    vehicle: str | None
    vehicle_triangles: int


@dataclass(frozen=True, slots=True)
class FrontRecord:
    """A Pareto front of designs: front.json. `designs` are all, `front` the names of the best."""

    schema: int
    kind: Literal["front"]
    seed: int
    currency: str
    objectives: tuple[str, ...]
    looked_at: int
    searched: int
    all_designs_looked_at: bool
    stopped: bool
    front: tuple[str, ...]
    designs: tuple[OpenTable, ...]
    refused: Any
    notes: Any
    inputs: OpenTable
    run: RunMetadata


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultRecord:
    """A result of perception entropy: result.json."""

    schema: int
    kind: Literal["score", "optimize"]
    seed: int
    entropy: Annotated[float, Part(about="Of the result [nats]; lower is better")]
    coverage: Annotated[float, Part(about="Of the result, 0 to 1")]
    before: Score
    after: Score
    placements: Mapping[BeforeOrAfter, PlacedSensors]
    mounts: OpenTable
    robustness: Annotated[OpenTable | None, AtTimes] = None
    requirements: Annotated[tuple[VerdictRow, ...] | None, AtTimes] = None
    conditions: Annotated[OpenTable | None, AtTimes] = None
    method: str | None
    level_samples: tuple[int, ...]
    objective: Annotated[str | None, AtTimes] = None
    expected_ap: Annotated[Mapping[BeforeOrAfter, ObjectScore] | None, AtTimes] = None
    value: Annotated[Mapping[BeforeOrAfter, float | None] | None, AtTimes] = None
    figures: Annotated[Mapping[BeforeOrAfter, KeyFigures] | None, AtTimes] = None
    dashboard: tuple[ReadingRow, ...]
    gain: Annotated[str | None, AtTimes] = None
    cost: Annotated[str | None, AtTimes] = None
    change_stderr: Annotated[Mapping[str, float] | None, AtTimes] = None
    ap_model: str
    returns: str
    flatness: OpenTable | None
    rounding: OpenTable | None
    consensus: OpenTable | None
    starts: tuple[OpenTable, ...]
    stop_reason: str | None
    seed_scatter: float | None
    evaluations: int
    stopped: bool
    warnings: tuple[Advice, ...]
    history: tuple[OpenTable, ...]
    study_sha256: Annotated[str, Part(about="Of the study with the rig of the result")]
    inputs: InputsRecord
    run: RunMetadata
