"""What is reviewed: one study with what it was found to be worth, and what may be asked of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from string import ascii_lowercase
from typing import Any, TypeVar

from .engine import advice, pe, scene, search, studies

T = TypeVar("T")
MOST_TRIANGLES = 200_000
"""Of the vehicle as the page shows it."""
MOST_STUDIES = 6
"""On one page, side by side."""


@dataclass(frozen=True, eq=False)
class Reviewed:
    """A study, and what a section may need of it.

    Attributes
    ----------
    name : str
        As readers call it; any text.
    outcome : Outcome
        Of a job: a score, or a search with the study as it was given and as it was found.
    key : str
        A letter that tells it from the page's other studies: ids of elements end in it.
    picture : bytes or None
        A rendered picture of it, PNG; None: a section draws one.
    command : str
        The command line that makes it again, as it was given; empty where it is not known.
    versions : mapping of str
        Programs besides the engine's that it was made with.
    known : dict
        What was worked out of it `once`: the same study on another page shares it.
    beside : int
        How many studies are on the page.
    """

    name: str
    outcome: pe.Outcome
    key: str = "a"
    picture: bytes | None = None
    command: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    known: dict[str, Any] = field(default_factory=dict, repr=False)
    beside: int = 1

    @property
    def searched(self) -> bool:
        """Whether a search was made: `before` and `after`, `asked` and `found` may differ."""
        return self.outcome.kind == "optimize"

    @property
    def asked(self) -> pe.Study:
        """The study as it was given."""
        return self.outcome.start

    @property
    def found(self) -> pe.Study:
        """The study with the best placement; the one that was given where none was searched for."""
        return self.outcome.study

    @property
    def rig(self) -> pe.Rig:
        """The sensors as they were found."""
        return self.found.rig

    @property
    def before(self) -> pe.Score:
        """Score of the study as it was given; its ground map is there if all voxels were scored."""
        return self.outcome.before

    @property
    def after(self) -> pe.Score:
        """Score of the study as it was found."""
        return self.outcome.after

    @property
    def warnings(self) -> tuple[pe.Advice, ...]:
        """What is odd about the study as it was found."""
        return self.outcome.warnings

    @property
    def robustness(self) -> search.Robustness | None:
        """How far entropies move under mounting errors and failures; None without a search."""
        return self.outcome.robustness

    @property
    def history(self) -> tuple[studies.HistoryRow, ...]:
        """Every placement that became the best, the start first; empty without a search."""
        return self.outcome.history

    @property
    def vehicle(self) -> pe.Vehicle | None:
        """The vehicle that beams are cast at: all its triangles."""
        return self.found.vehicle

    @property
    def shown_vehicle(self) -> tuple[pe.Vehicle | None, float]:
        """The vehicle as the page draws it, and how far its surface moved for that [m]."""
        vehicle = self.vehicle
        if vehicle is None:
            return None, 0.0
        return self.once("vehicle", lambda: scene.simplified(vehicle, MOST_TRIANGLES))

    @property
    def sight(self) -> pe.Sight:
        """What tells the places that rigs of this study see; it remembers what was measured."""
        return self.once("sight", self.found.sight)

    @property
    def outlook(self) -> advice.Outlook:
        """How far and how well the sensors see."""
        return self.once("outlook", lambda: advice.outlook(self.sight, self.rig))

    def once(self, what: str, work: Callable[[], T]) -> T:
        """Return what was worked out under a name, the first time by doing so."""
        if what not in self.known:
            self.known[what] = work()
        found: T = self.known[what]
        return found

    def evaluator(self, samples: int | None = None) -> pe.RigJudge:
        """Return the evaluator of this study; `samples` replaces the study's own."""
        return self.found.evaluator(samples)


def reviewed_together(each: Sequence[Reviewed]) -> tuple[Reviewed, ...]:
    """Return what is reviewed with a key for each on one page.

    Raises
    ------
    InputError
        When there is none, or there are more than a page has room for.
    """
    if not 1 <= len(each) <= MOST_STUDIES:
        raise pe.InputError("review", "studies", f"1 to {MOST_STUDIES}", len(each))
    return tuple(
        replace(one, key=key, beside=len(each))
        for one, key in zip(each, ascii_lowercase, strict=False)
    )
