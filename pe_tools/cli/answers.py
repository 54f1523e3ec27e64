"""What verbs print with ``--json``, a class a form: the data, and the schemas that `pe --help
--json` and docs/schemas give, are of these declarations. What is `OpenTable` or `OpenRows` may
change with any version."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pe_core.base.setting import AtTimes, Part
from pe_core.scoring.requirements import VerdictRow
from pe_core.scoring.score import Score
from pe_core.search import KeyFigures, ReadingRow

from ..advice import Advice
from ..jobs import OpenTable, PlacedSensors

OpenRows = tuple[OpenTable, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FilesAnswer:
    """Files that a verb wrote, or with ``--to line`` the rig as a line of text."""

    written: tuple[str, ...] = ()
    line: Annotated[str | None, AtTimes] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RigsAnswer:
    """Known rigs and templates, listed; with a name all of one."""

    rigs: OpenRows


@dataclass(frozen=True, slots=True)
class ChangedKey:
    """A key of a study that was changed; `before` is null where it had no value."""

    key: str
    before: Any
    after: Any


@dataclass(frozen=True, slots=True)
class KeysAnswer:
    """What `pe set` changed in a file."""

    study: str
    changes: tuple[ChangedKey, ...]


@dataclass(frozen=True, slots=True)
class CatalogRow:
    """A sensor of the catalogue."""

    name: str
    kind: str
    source: str


@dataclass(frozen=True, slots=True)
class CatalogAnswer:
    """The catalogue."""

    sensors: tuple[CatalogRow, ...]


@dataclass(frozen=True, slots=True)
class SensorAnswer:
    """A sensor of the catalogue: its table as a study may have it, and its data sheet in lines."""

    entry: Annotated[CatalogRow, Part(inline=True)]
    table: OpenTable
    sheet: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CurveRow:
    """AP = a ln m + b of whole objects of a class, by a detector's model."""

    model: str
    kind: str
    of_class: Annotated[str, Part(key="class")]
    a: float
    b: float
    source: str


@dataclass(frozen=True, slots=True)
class CurvesAnswer:
    """The AP curves of whole objects."""

    curves: tuple[CurveRow, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainAnswer:
    """A score in words; or what is asked with ``--at``: a place, or a body there; or with
    ``--sensor`` where a sensor gains most; and with ``--from`` how far it is from edges of the
    vehicle, or the names of these by the axis that is measured from them."""

    score: Annotated[Score | None, AtTimes] = None
    outlook: Annotated[OpenTable, Part(inline=True)]
    sensors: Annotated[OpenRows | None, AtTimes] = None
    words: Annotated[tuple[str, ...] | None, AtTimes] = None
    warnings: Annotated[tuple[Advice, ...] | None, AtTimes] = None
    place: Annotated[OpenTable | None, AtTimes] = None
    body: Annotated[OpenTable | None, AtTimes] = None
    suggestions: Annotated[OpenRows | None, AtTimes] = None
    steepest: Annotated[OpenTable | None, AtTimes] = None
    distances: Annotated[tuple[str, ...] | None, AtTimes] = None
    edges: Annotated[Mapping[str, tuple[str, ...]] | None, AtTimes] = None


@dataclass(frozen=True, slots=True)
class CheckAnswer:
    """A study held to its requirements, scenarios and limits. `met`: how many requirements are;
    `unchecked`: why others have no verdict; `suggestions`: by requirement, what would fix it."""

    met: int
    requirements: tuple[VerdictRow, ...]
    unchecked: Mapping[str, str]
    suggestions: Mapping[str, OpenRows]
    scenarios: OpenRows
    limits: tuple[ReadingRow, ...]


@dataclass(frozen=True, slots=True)
class PresetsAnswer:
    """Requirement presets, and the shipped scenarios by name."""

    requirements: OpenRows
    scenarios: Mapping[str, OpenTable]


@dataclass(frozen=True, slots=True)
class CompareAnswer:
    """Studies beside each other, by name. OpenRows have a value for each, in their order."""

    scores: Mapping[str, Score]
    figures: Mapping[str, KeyFigures]
    rows: OpenRows
    same_vehicle: bool
    notes: tuple[str, ...]
    words: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class WhereAnswer:
    """One more sensor all over the surface: `base` is the figure without it, `error` the standard
    error of a change. Of a place: its value, its change, and what forbids it."""

    model: str
    figure: str
    base: float
    error: float | None
    places: OpenRows


@dataclass(frozen=True, slots=True, kw_only=True)
class BuiltAnswer:
    """A built rig against the designed one: how far each sensor is off, what that costs, what is no
    longer met."""

    as_built: OpenTable


@dataclass(frozen=True, slots=True, kw_only=True)
class RegionAnswer:
    """The free region of a sensor: `allowed_loss` and `base` of the figure, the area of the patch
    and of the whole mount, the median `standard_error` of a loss, how far each way is free, the
    patch as triangles [m], and all evaluated places with their losses."""

    sensor: str
    figure: str
    unit: str
    allowed_loss: float
    base: float
    mount: str
    area_m2: float
    mount_area_m2: float
    standard_error: float
    evaluated_on: str
    others_searched_again: bool
    not_held: tuple[str, ...]
    ways: OpenRows
    patch: Any
    places: OpenRows


@dataclass(frozen=True, slots=True)
class SweepAnswer:
    """The runs of a sweep, a row each, as in sweep.json."""

    kind: str
    version: str
    runs: OpenRows


@dataclass(frozen=True, slots=True)
class SessionState:
    """The study of a session: its name, its vehicle, and where its sensors are."""

    study: str
    vehicle: str | None
    sensors: PlacedSensors


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplyError:
    """Why a request was refused: the whole `text`, and its parts, which may be empty."""

    text: str
    source: str
    field: str
    expected: str
    found: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ServeReply:
    """One line of a session: the `id` and the verb of its request, the exit status that the verb
    would have, lines that it would print on stderr, and its answer or why there is none."""

    id: Any
    do: str | None
    status: int
    notes: tuple[str, ...] = ()
    answer: Annotated[Any, AtTimes] = None
    error: Annotated[ReplyError | None, AtTimes] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class VerifyAnswer:
    """The engine held to its golden cases, as in verify.json. `digests`: of all files of the engine
    (`code`), of all values to the last bit (`results`); `bases`: where right values are from."""

    passed: int
    failed: int
    versions: Mapping[str, str]
    machine: OpenTable
    digests: Mapping[str, str]
    bases: Mapping[str, str]
    cases: OpenRows
    known_defects: OpenRows
    seconds: float
