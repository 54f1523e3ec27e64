"""What the review page shows: studies with their results, and the head of the page."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from pathlib import Path
from string import ascii_lowercase
from typing import Any, TypeVar

import pe_core as pe
from pe_core.scoring.sight import GroundSight

from .. import advice, graphics, jobs

T = TypeVar("T")
MAX_TRIANGLES = 200_000  # Of the vehicle in pictures on the page; rays are cast at all triangles
MAP_STEP_M = 1.0
MAX_STUDIES = 6  # On one page, side by side
TODAY = "today"
"""Date that stands for the day of the run. Without it the same study gives the same bytes."""
MAX_LETTERS = 200


@dataclass(frozen=True, eq=False)
class ReportContext:
    """One study, its results, and the values that sections derive from them. `name`: name of the
    study as readers see it; any text. `outcome`: of a score, or of a search with the study before
    and after it. `key`: A letter that identifies the study on its page: ids of elements end in it.
    `command`: command line that reproduces the results; empty if unknown. `versions`: versions of
    programs besides the engine's, by name. `cache`: derived values by name, filled by `cached`;
    pages that show the same study share it. `folder`: folder of the page, where films of its
    scenarios may be. `study_count`: number of studies on the page. `regions`: free regions of
    sensors of `study`. `built`: the comparison with a built rig."""

    name: str
    outcome: jobs.Outcome
    key: str = "a"
    command: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    cache: dict[str, Any] = field(default_factory=dict, repr=False)
    folder: Path | None = None
    study_count: int = 1
    regions: tuple[advice.FreeRegion, ...] = ()
    built: advice.AsBuilt | None = None

    @property
    def was_searched(self) -> bool:
        """Whether the outcome is that of a search: `start` and `study` may then differ."""
        return self.outcome.kind == "optimize"

    @property
    def start(self) -> pe.Study:
        """The study as it was given."""
        return self.outcome.start

    @property
    def study(self) -> pe.Study:
        """The study with the best placement; without a search the study as it was given."""
        return self.outcome.study

    @property
    def rig(self) -> pe.Rig:
        """The sensors of `study`."""
        return self.study.rig

    @property
    def after(self) -> pe.Score:
        """Score of `study`."""
        return self.outcome.after

    @property
    def vehicle(self) -> pe.Vehicle | None:
        """The vehicle at which rays are cast, with all its triangles."""
        return self.study.vehicle

    @property
    def display_vehicle(self) -> tuple[pe.Vehicle | None, float]:
        """The vehicle as the page draws it, and how far simplification moved its surface [m]."""
        vehicle = self.vehicle
        if vehicle is None:
            return None, 0.0
        return self.cached("vehicle", lambda: graphics.simplified(vehicle, MAX_TRIANGLES))

    @property
    def sight(self) -> pe.Sight:
        """Evaluates which locations a rig of this study sees; it caches its measurements."""
        return self.cached("sight", self.study.sight)

    @property
    def ground(self) -> GroundSight:
        """What the sensors see of the ground, in cells of a metre."""
        return self.cached("ground", lambda: self.sight.ground(self.rig, step=MAP_STEP_M))

    @property
    def outlook(self) -> advice.Outlook:
        """How far and how well the sensors see."""
        return self.cached("outlook", lambda: advice.outlook(self.sight, self.rig))

    def cached(self, what: str, compute: Callable[[], T]) -> T:
        """Return the cached value of a name; compute it at the first call."""
        if what not in self.cache:
            self.cache[what] = compute()
        value: T = self.cache[what]
        return value


def keyed_contexts(contexts: Sequence[ReportContext]) -> tuple[ReportContext, ...]:
    """Return the studies of one page, each with a key of its own; `InputError` for none, or for
    more than `MAX_STUDIES`."""
    if not 1 <= len(contexts) <= MAX_STUDIES:
        raise pe.InputError("review", "studies", f"1 to {MAX_STUDIES}", len(contexts))
    return tuple(
        replace(context, key=key, study_count=len(contexts))
        for context, key in zip(contexts, ascii_lowercase, strict=False)
    )


@dataclass(frozen=True, slots=True)
class About:
    """Title, author, date and revision at the head of the page; empty ones are left out. The
    `title` is a heading in place of the studies' names, which then stand below it. The `date` is
    any text ("2026-05-04", "May 2026"); "today" is the day of the run. A text of more than 200
    letters raises `InputError`."""

    title: str = ""
    author: str = ""
    date: str = ""
    revision: str = ""

    def __post_init__(self) -> None:
        for name in ("title", "author", "date", "revision"):
            text = " ".join(str(getattr(self, name)).split())
            if len(text) > MAX_LETTERS:
                expected = f"{MAX_LETTERS} letters at most"
                raise pe.InputError("review", name, expected, f"{len(text)}")
            object.__setattr__(self, name, text)
        if self.date.lower() == TODAY:
            object.__setattr__(self, "date", date.today().isoformat())

    @property
    def parts(self) -> tuple[str, ...]:
        """Author, date and revision, those that are given."""
        revision = f"Revision {self.revision}" if self.revision else ""
        return tuple(filter(None, (self.author, self.date, revision)))
