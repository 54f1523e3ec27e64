"""The job that compares a built rig with the designed one."""

from collections.abc import Iterator, Sequence

from pe_core.base.errors import InputError
from pe_core.scene.rig import Rig
from pe_core.scoring.score import Score
from pe_core.search import KeyFigures, dashboard
from pe_core.study.study import Study

from ..advice import AsBuilt, compare, compare_figures, fallen_verdicts, paired
from .job import Job, Progress, ProgressSteps

SCORED_SHARE = 0.7  # About which share of the time the scores take
DESIGN = "design"
BUILT = "built"


class BuiltJob(Job):
    """Compares a built rig with a study's own: scores and key figures of both, and of the design
    with each single sensor as built. The models are those of the design.

    `InputError` when no sensor of one is in the other.

    Parameters
    ----------
    study : Study
        The design.
    built : Rig
        As measured, in the ground frame.
    notes : sequence of str
        Messages about its file.
    """

    def __init__(
        self, study: Study, built: Rig, notes: Sequence[str] = (), workers: int | None = None
    ) -> None:
        super().__init__(study, workers)
        self._pairing = paired(study.rig, built)
        if not self._pairing.pairs:
            raise InputError("built rig", "sensors", "at least one of the design", "none")
        self._notes = tuple(notes)
        self.found: AsBuilt | None = None

    @property
    def result(self) -> AsBuilt | None:
        """The comparison; None where the job was stopped."""
        return self.found

    def __iter__(self) -> Iterator[Progress]:
        design = self.study.rig
        moved = [pair.name for pair in self._pairing.pairs if not pair.is_as_designed]
        rigs = [design, self._pairing.rig(design)]
        rigs += [self._pairing.rig(design, only=name) for name in moved]
        names = [DESIGN, BUILT, *(f"{name} as built" for name in moved)]
        scores: dict[str, Score] = {}
        for name, rig in zip(names, rigs, strict=True):
            begin = SCORED_SHARE * len(scores) / len(rigs)
            score = yield from self._score(rig, Progress(f"scoring {name}", begin))
            if score is None:
                return
            scores[name] = score
        figures = yield from self._figures(rigs, Progress("seeing", SCORED_SHARE))
        if figures is None or self.stopped:
            return
        rows = compare(scores)
        if figures:
            rows = (*rows, *compare_figures(dict(zip(names, figures, strict=True))))
        seen_of_both: list[KeyFigures | None] = [*figures[:2]] or [None, None]
        met = []
        for rig, name, seen in zip(rigs[:2], names[:2], seen_of_both, strict=True):
            found = yield from self._met(rig, scores[name], seen)
            met.append(found or {})
        if not self.stopped:
            self.found = AsBuilt(
                self._pairing,
                rows,
                tuple(moved),
                fallen=fallen_verdicts(met[0], met[1]),
                notes=self._notes,
            )
        yield Progress("done", 1.0)

    def _met(
        self, rig: Rig, score: Score, figures: KeyFigures | None
    ) -> ProgressSteps[dict[str, bool]]:
        """Yield progress; return what a rig meets, by name: requirements, and limits."""
        study = self.study.with_rig(rig)
        verdicts = yield from self._verdicts(study, Progress("checking", 0.9), to_the_end=False)
        met = {verdict.name: verdict.met for verdict in verdicts or ()}
        rows = dashboard(figures, score.entropy, limits=self.study.limits)
        met |= {f"limits.{r.figure.key}": bool(r.met) for r in rows if r.met is not None}
        return met
