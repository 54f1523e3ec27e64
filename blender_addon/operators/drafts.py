"""What a sensor would add where it is held: a score on a small sample, made beside the window."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..engine import pe
from ..worker import hand

TOPIC = "place"
SAMPLES = 16_384


@dataclass(frozen=True, slots=True)
class Gain:
    """Entropy [nats] and coverage without a sensor, None where there is no other, and with it."""

    before: float | None
    after: float
    coverage: float

    def __str__(self) -> str:
        """Return it in a line."""
        seen = f"coverage {self.coverage:.1%}"
        if self.before is None:
            return f"{self.after:.3f} nats, {seen}"
        change = self.after - self.before
        return f"{self.before:.3f} to {self.after:.3f} nats ({change:+.3f}), {seen}"


class Drafts:
    """Scores one sensor here and there beside those of a study.

    Parameters
    ----------
    study : pe.Study
        Its rig holds the sensor that is placed, under `name`.
    tell : callable
        Called with a line once there is one, in Blender's own turn.
    """

    def __init__(self, study: pe.Study, name: str, tell: Callable[[str], None]) -> None:
        self._study, self._name, self._tell = study, name, tell
        self._others = [each for each in study.rig if each.name != name]
        self._evaluator: pe.RigJudge | None = None
        self._before: float | None = None

    def ask(self, pose: pe.Pose) -> None:
        """Have the sensor scored there; the latest wish counts."""
        hand.ask(TOPIC, lambda: self.gain(pose), self._show, self._fail)

    def gain(self, pose: pe.Pose) -> Gain:
        """Return what the sensor is worth there; the rest is measured the first time alone."""
        if self._evaluator is None:
            self._evaluator = self._study.evaluator(samples=SAMPLES)
            if self._others:
                self._before = self._evaluator.entropy(pe.Rig(self._others))
        own = self._study.rig[self._name]
        moved = own.moved(pose)
        score = self._evaluator.score(pe.Rig([*self._others, moved]), draft=True)
        return Gain(self._before, score.entropy, score.coverage)

    def end(self) -> None:
        """Forget what was asked."""
        hand.drop(TOPIC)

    def _show(self, gain: Gain) -> None:
        self._tell(str(gain))

    def _fail(self, error: Exception) -> None:
        if not isinstance(error, pe.InputError | MemoryError):
            raise error
        self._tell(f"no score: {error}")
