"""What a job found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..advice import Advice
from ..scene.sensors import Rig
from ..scoring.score import Score
from ..search import JudgedRig, Robustness
from .study import Study


@dataclass(frozen=True, slots=True)
class HistoryRow:
    """A placement that became the best: when, how good, in which round, and where."""

    evaluation: int
    round: int
    entropy: float
    rig: Rig


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a job found.

    Attributes
    ----------
    kind : {"score", "optimize"}
    start, study : Study
        As it was given, and with the best placement.
    before, after : Score
        Scores of the two; the same one when only a score was asked for, or nothing better was
        found.
    history : tuple of HistoryRow
        Every placement that became the best, the start first.
    evaluations : int
        Rigs judged by the search.
    stopped : bool
        Whether the search was cut short.
    seconds : float
    warnings : tuple of Advice
        What is odd about `study`.
    inputs : dict
        What a search that went on was given at its beginning: `start` may call files otherwise.
    judged : tuple of JudgedRig
        What the search was told: one that was stopped goes on from there.
    robustness : Robustness or None
        Of a search: how far the entropy of start and end moves under mounting errors and failures.
    """

    kind: str
    start: Study
    study: Study
    before: Score
    after: Score
    history: tuple[HistoryRow, ...] = ()
    evaluations: int = 0
    stopped: bool = False
    seconds: float = 0.0
    warnings: tuple[Advice, ...] = ()
    inputs: dict[str, Any] | None = None
    judged: tuple[JudgedRig, ...] = ()
    robustness: Robustness | None = None
