"""The one state of a scene's score: panel, read-out, dashboard and legends read it here.

It says what is shown, whether it is of the scene as it is now, and what it is compared with: every
change is one from the same baseline.
"""

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import NamedTuple

import bpy

from .. import document
from ..choices import BEFORE_MOVE
from ..engine import advice, pe
from ..view import viewport
from . import background_figures
from .state import Baseline, LiveState, live_state

BEFORE_SEARCH = "before the search"
STORED = "as scored"
OUT_OF_DATE = "out of date"
AT_REST = "at rest"
MOVING = "moving"
PENDING = "being scored"
"""Phases of what is shown: the stored result, of the scene as it is or was; a live score of the
idle scene, of one that moves, and of before the last change."""


class ShownScore(NamedTuple):
    """What is shown of a scene's score.

    `now` is the score, `phase` what it is of. `state` is the vehicle's; empty: as drawn. `baseline`
    is what `pair`, the scores before and now on the same sample, and `figures` are compared with:
    without one, `pair` is None and `figures` are at most one. `errors` are standard errors of
    changes that are known besides those of the pair, by the names of `FIGURES`.
    """

    now: pe.Score
    phase: str
    state: str = ""
    baseline: Baseline | None = None
    pair: tuple[pe.Score, pe.Score] | None = None
    figures: tuple[advice.KeyFigures, ...] = ()
    errors: Mapping[str, float] = MappingProxyType({})

    @property
    def entropy(self) -> float:
        """The entropy [nats]."""
        return self.now.entropy

    @property
    def stored(self) -> bool:
        """Whether it is the stored result."""
        return self.phase in (STORED, OUT_OF_DATE)

    @property
    def exact(self) -> bool:
        """Whether it is of the scene as it is now."""
        return self.phase in (STORED, AT_REST)

    @property
    def label(self) -> str:
        """What it is compared with; empty for nothing."""
        return self.baseline.label if self.baseline is not None and self.pair is not None else ""

    def before(self, measure: str) -> float | None:
        """Return a measure of the whole rig ("entropy", "coverage", "ap") at the baseline; None
        without one. A stored score is of more voxels than the pair: the pair's change counts."""
        values = [] if self.pair is None else [getattr(each, measure) for each in self.pair]
        now = getattr(self.now, measure)
        if not values or now is None or None in values:
            return None
        return values[0] if now == values[1] else now - (values[1] - values[0])

    def error(self, measure: str) -> float:
        """Return the standard error of the change of such a measure; 0 without a change."""
        if self.pair is None or measure in self.errors:
            return self.errors.get(measure, 0.0)
        return advice.difference_error(*self.pair, ("rig", "", measure))

    def change_errors(self) -> Mapping[str, float]:
        """Return the standard errors of the changes of all figures that have one, by name."""
        if len(self.figures) < 2:
            return {"entropy": self.error("entropy")}
        errors = self.figures[1].errors_from(self.figures[0])
        return {**errors, **self.errors, "entropy": self.error("entropy")}

    @property
    def signature(self) -> tuple[object, ...]:
        """Plain values that differ where something else is shown."""
        before = self.before("entropy")
        return self.entropy, self.phase, self.state, self.label, before, len(self.figures)


def shown_score(scene: bpy.types.Scene) -> ShownScore | None:
    """Return what is shown of a scene; None while nothing is known.

    That is the live score; or the stored result, where nothing moves and the result is that of the
    scene as it is now: it is of more voxels. After undo and redo there is no live score yet, and
    the stored result came back with the scene. With *Live* off it is the stored result. A stored
    result is never that of another state than as drawn.
    """
    settings = scene.perception_entropy
    state = live_state(scene.name)
    live = state.score if settings.live.on else None
    # While something moves it is not known yet whether a result is stale.
    is_current = not (settings.result_stale or document.shown_state(scene))
    if settings.has_result and (live is None or (is_current and not state.moving)):
        return _stored(scene, state)
    if live is None:
        return None
    phase = AT_REST if state.is_current(live) else MOVING if state.moving else PENDING
    pair = None if live.before is None else (live.before, live.summary)
    figures = tuple(background_figures.figures_of(scene))
    other = document.shown_state(scene)
    return ShownScore(live.summary, phase, other, live.baseline, pair=pair, figures=figures)


def for_drawing(scene: bpy.types.Scene) -> ShownScore | None:
    """Return what is shown, to be drawn: all that draw it are drawn again where it has changed."""
    found = shown_score(scene)
    signature = None if found is None else found.signature
    state = live_state(scene.name)
    if state.drawn != signature:
        state.drawn = signature
        viewport.redraw_soon()
    return found


def _stored(scene: bpy.types.Scene, state: LiveState) -> ShownScore:
    """Return the stored result. A search is compared with its start, a score as the live score."""
    settings = scene.perception_entropy
    result = settings.result
    before, now, figures = _read(result)
    phase = OUT_OF_DATE if settings.result_stale else STORED
    is_search = result.kind == "optimize"
    live = state.score if settings.live.on else None
    if is_search and (live is None or settings.live.against == BEFORE_MOVE):
        return ShownScore(
            now,
            phase,
            baseline=Baseline(BEFORE_SEARCH, None, before),
            pair=(before, now),
            figures=tuple(figures.values()),
            errors=result.change_errors,
        )
    found = tuple(known for which, known in figures.items() if which == "after")
    if live is None or live.before is None or not state.is_current(live):
        return ShownScore(now, phase, figures=found)
    compared = background_figures.figures_of(scene)[:-1] if found else []
    return ShownScore(
        now,
        phase,
        baseline=live.baseline,
        pair=(live.before, live.summary),
        figures=(*compared, *found),
    )


@lru_cache(maxsize=4)
def _read(result: document.Result) -> tuple[pe.Score, pe.Score, Mapping[str, advice.KeyFigures]]:
    """Return the scores of a result, before and after a search, of a score twice the same; and its
    key figures, by "before" and "after"."""
    figures: dict[str, advice.KeyFigures] = {
        which: advice.KeyFigures.from_dict(result.figures[which])
        for which in ("before", "after")
        if which in result.figures
    }
    before, after = (document.score_from_dict(data) for data in (result.before, result.after))
    return before, after, figures
