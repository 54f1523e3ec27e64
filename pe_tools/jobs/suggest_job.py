"""The job that looks for what would mend requirements that are not met, or a blind place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pe_core.base.errors import InputError, one_of, shown
from pe_core.study.study import Study
from pe_core.study.suggestion import BLIND_SPOT, Suggestion, mended, with_blind_spot

from .job import Job, Progress


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
            study, names = with_blind_spot(study, *spot), (BLIND_SPOT,)
        super().__init__(study)
        self._names = names
        self.found: dict[str, list[Suggestion]] | None = None
        """By requirement that is not met; None where the job was stopped."""

    def __iter__(self) -> Iterator[Progress]:
        self.found = yield from self._beside(
            lambda watch: mended(self.study, self._names, watch), Progress("suggesting", 0.0)
        )
        yield Progress("done", 1.0)
