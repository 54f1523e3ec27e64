"""What is known of the live score, one state a scene: plain data, dropped with the file.

A state is made when its scene is first asked for. It holds no object of Blender's.
"""

from collections.abc import Hashable
from dataclasses import dataclass, field

from ..engine import advice, pe
from ..processes.engine_calls import Problem, ScoreRequest


@dataclass(slots=True, eq=False)
class Baseline:
    """What a live score is compared with, in words ("before this move"), its sensors and score.
    `rig` is None where the vehicle was another one, `summary` until it has been computed on the
    sample of the live score."""

    label: str
    rig: pe.Rig | None
    summary: pe.Score | None = None


@dataclass(frozen=True)
class FinishedScore:
    """A study, its score in full, and the signature of the scene that it was read from."""

    signature: str
    study: pe.Study
    score: pe.Score


@dataclass(frozen=True)
class LiveScore:
    """The score of a request, which is the one of this `number` of its scene. `exact`: the scene is
    idle."""

    summary: pe.Score
    baseline: Baseline | None
    exact: bool
    request: ScoreRequest
    number: int = 0

    @property
    def before(self) -> pe.Score | None:
        """The score of the baseline, once it is known."""
        return None if self.baseline is None else self.baseline.summary


@dataclass(slots=True)
class LiveState:
    """What is known of the live score of one scene."""

    finished: FinishedScore | None = None
    """The last score that was finished in this session, its ground map included."""
    score: LiveScore | None = None
    exact: LiveScore | None = None
    """The latest score, and the latest one of the idle scene."""
    note: str = ""
    """Why there is no newer score, in one line; empty when there is one, or soon will be."""
    requests: int = 0
    last_read: ScoreRequest | None = None
    """What the scene was when it was read last; None while *Live* is off."""
    moving: bool = False
    """Whether something moves: from an update that moves it until the scene is idle."""
    operator: int = 0
    """Number of the operator that moves sensors with the mouse; 0 when there is none."""
    before_move: Baseline | None = None
    """The sensors before the last move."""
    chosen: tuple[tuple[Hashable, ...], Baseline] | None = None
    """The variant that the settings choose, and what it was made from."""
    figures: Problem | None = None
    shown_figures: list[advice.KeyFigures] = field(default_factory=list)
    """The problem whose key figures are wanted, and those that were shown last."""
    drawn: Hashable = None
    """Signature of what panel and read-out were last drawn with."""
    prior: tuple[Hashable, pe.Prior] | None = None
    """The prior that was read last, and its key: a file of boxes takes long to read."""

    def next_request(self) -> int:
        """Return the number of a new request: the scene no longer is as it was read before."""
        self.requests += 1
        return self.requests

    def put(self, score: LiveScore) -> None:
        """Store a new score; the note of why there was none goes."""
        self.score = score
        self.note = ""
        if score.exact:
            self.exact = score

    def is_current(self, score: LiveScore) -> bool:
        """Whether a score is of the idle scene as it is now."""
        return score.exact and score.number == self.requests

    def switch_off(self) -> None:
        """Drop what the live score found; finished scores stay."""
        self.score = self.exact = self.last_read = self.before_move = None
        self.moving = False
        self.figures = None
        self.shown_figures = []
        self.note = ""


states: dict[str, LiveState] = {}
"""By the scene's name."""


def live_state(scene_name: str) -> LiveState:
    """Return the state of a scene; a new one where there is none."""
    return states.setdefault(scene_name, LiveState())
