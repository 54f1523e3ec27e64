"""The jobs of requirements: hold a study to them and its scenarios; look for what would fix it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from pe_core.base.errors import InputError, one_of, shown
from pe_core.motion import DriveBy
from pe_core.scoring.requirements import CheckStep, Verdict, checkable
from pe_core.search import NUMBERED, Reading, dashboard
from pe_core.study.study import Study
from pe_core.study.suggestion import BLIND_SPOT, Suggestion, repairs, with_blind_spot

from .job import Job, Progress, begun


class Checked(NamedTuple):
    """Verdicts of a check; why requirements were left out, and those it was stopped before."""

    verdicts: list[Verdict]
    unchecked: Mapping[str, str]
    missing: tuple[str, ...]
    driven: list[DriveBy]


class CheckJob(Job):
    """Holds the rig of a study to requirements, with mounting errors, to its scenarios and limits.
    `limits` are the figures that have a number to keep; `pe score` has the same. A job
    that is stopped keeps the `verdicts` that it has found, in the order of the requirements; they
    come before their margins, `margins` is how many have theirs. With `fitting`, requirements that
    the rig cannot be held to are left out instead of raising `InputError`: `unchecked` has the
    reason of each by name; limits are left to the dashboard."""

    shown = ("verdicts", "margins", "unchecked", "driven")

    def __init__(self, study: Study, *, fitting: bool = False) -> None:
        super().__init__(study)
        self._fitting = fitting
        self.verdicts: list[Verdict] = []
        self.margins = 0
        self.unchecked: dict[str, str] = {}
        self.driven: list[DriveBy] = []
        self.limits: tuple[Reading, ...] = ()
        self._progress = Progress("checking", 0.0)

    @property
    def checked(self) -> Checked:
        """What is known so far."""
        return Checked(self.verdicts, self.unchecked, self.missing, self.driven)

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of the scenarios and requirements without an answer: the job was stopped before."""
        known = {*self.unchecked, *(verdict.name for verdict in self.verdicts)}
        late = [each.name for each in self.study.scenarios[len(self.driven) :]]
        return *late, *(each.name for each in self.study.requirements if each.name not in known)

    def __iter__(self) -> Iterator[Progress]:
        yield self._progress
        for scenario in self.study.scenarios:
            work = begun(partial(self.study.drive_by, scenario))
            if (driven := (yield from self._awaited(work, lambda: self._progress))) is not None:
                self.driven.append(driven)
        steps = self._steps()
        while step := (
            yield from self._awaited(begun(lambda: next(steps, None)), lambda: self._progress)
        ):
            self._progress = Progress("checking", step.fraction)
            if step.verdict is not None:
                self._note(step.verdict, is_early=step.is_early)
            yield self._progress
        if not (self._fitting or self.stopped):
            yield from self._look_at_limits()
        yield Progress("done", 1.0)

    def _note(self, verdict: Verdict, *, is_early: bool) -> None:
        """Add a verdict, or have it in place of that without its margin."""
        self.margins += not is_early
        names = [each.name for each in self.study.requirements]
        others = [each for each in self.verdicts if each.name != verdict.name]
        self.verdicts = sorted([*others, verdict], key=lambda each: names.index(each.name))

    def _look_at_limits(self) -> Iterator[Progress]:
        """Read the figures that have a limit; only entropy and AP need a score."""
        numbers = self.study.limits.with_number
        if not numbers:
            return
        score = None
        if NUMBERED.intersection(numbers):
            score = yield from self._score(self.study.rig, self._progress)
        figures = yield from self._figures([self.study.rig], self._progress)
        objects = None if score is None else score.objects
        rows = dashboard(
            figures[0] if figures else None,
            None if score is None else score.entropy,
            limits=self.study.limits,
            ap=None if objects is None else objects.ap,
        )
        self.limits = tuple(row for row in rows if row.figure.key in numbers)

    def _steps(self) -> Iterator[CheckStep]:
        """Yield the steps of the check; the first one takes as long as all zones to be placed."""
        study = self.study
        if self._fitting:
            fitting, self.unchecked = checkable(
                study.requirements, study.rig, study.vehicle, study.reference, space=study.space
            )
            study = replace(study, requirements=fitting)
        yield from self._check_steps(study, early=True)


class SuggestJob(Job):
    """Looks for the smallest move, and for one more sensor, that meets what is not met.

    Parameters
    ----------
    study : Study
    names : sequence of str
        Requirements that are to be met; none: all.
    spot : (2,) float, optional
        A place on the ground [m] that is to be visible, instead: `BLIND_SPOT` in `found`.

    Raises
    ------
    InputError
        When there is no such requirement; once it runs, as `Study.checker`.
    """

    def __init__(
        self, study: Study, names: Sequence[str] = (), spot: tuple[float, float] | None = None
    ) -> None:
        known = [each.name for each in study.requirements]
        for name in names:
            if name not in known:
                raise InputError("suggest", "requirement", one_of(known, name), shown(name))
        if spot is not None:
            study = with_blind_spot(study, spot)
            names = (BLIND_SPOT,)
        super().__init__(study)
        self._names = names
        self.found: dict[str, list[Suggestion]] | None = None
        """By requirement that is not met; None where the job was stopped."""

    def __iter__(self) -> Iterator[Progress]:
        self.found = yield from self._beside(
            lambda watch: repairs(self.study, self._names, watch), Progress("suggesting", 0.0)
        )
        yield Progress("done", 1.0)
