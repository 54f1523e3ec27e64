"""The job that scores a study."""

from collections.abc import Iterator

from pe_core.search import Value

from ..advice import condition_warnings
from .job import Job, Outcome, Progress


class ScoreJob(Job):
    """Scores the rig of a study without changing it."""

    def __iter__(self) -> Iterator[Progress]:
        score = yield from self._score(self.study.rig, Progress("scoring", 0.0))
        if score is None:
            return
        value = Value(0.0, score.entropy)
        warnings = yield from self._warnings(self.study, score, Progress("scoring", 1.0, value))
        seeing = Progress("looking at the ground", 1.0, value)
        figures = yield from self._figures([self.study.rig], seeing)
        verdicts = yield from self._shown_verdicts(self.study, Progress("checking", 1.0, value))
        table = yield from self._conditions(self.study, Progress("conditions", 0.0, value))
        if self.dropped:
            return
        self.outcome = Outcome(
            "score",
            self.study,
            self.study,
            score,
            after=score,
            seconds=self.seconds,
            warnings=(*(warnings or ()), *condition_warnings(table)),
            verdicts=verdicts or (),
            conditions=table,
            figures=(figures[0], figures[0]) if figures else None,
        )
        yield Progress("done", 1.0, value)
