"""An objective of one's own: a function of a rig that a search minimises in place of entropy."""

from collections.abc import Callable
from dataclasses import dataclass

from pe_core.base.errors import InputError
from pe_core.scene.rig import Rig
from pe_core.search import Objective, as_objective
from pe_core.search.figures import FIGURES
from pe_core.study.study import ENTROPY, EXPECTED_AP, Study

from .searched_figure import SearchedFigure

TAKEN = frozenset({*FIGURES, EXPECTED_AP, "evaluation", "evaluations", "round", "placements"})
"""Names with another meaning in the files of a result."""


@dataclass(frozen=True, slots=True)
class OwnFigure(SearchedFigure):
    """The figure of an objective of one's own."""

    def amount(self, figure: str) -> str:
        """Return a figure in a sentence: "0.32 by cables"."""
        return f"{figure} by {self.label}"


def own_figure(given: Callable[[Rig], float] | Objective) -> OwnFigure:
    """Return the figure of an objective of one's own. `InputError` where its name has another
    meaning in the files of a result."""
    named = given.figure if isinstance(given, Objective) else given
    name = getattr(named, "__name__", type(named).__name__)
    if name in TAKEN:
        expected = "a name of its own"
        raise InputError("optimize", "objective", expected, f"a function called {name!r}")
    return OwnFigure(name, name)


def own_objective(study: Study, given: Callable[[Rig], float] | Objective) -> Objective:
    """Return an objective of one's own for the search of a study. `InputError` where the study
    would change its own objective: by expected AP, a tolerance, or conditions."""
    search = study.search
    changes = {
        f'objective = "{search.objective}"': search.objective != ENTROPY,
        "a tolerance": search.tolerance.is_on,
        "conditions": bool(search.conditions),
    }
    for found, is_on in changes.items():
        if is_on:
            expected = "a search by entropy alone, in place of which the function is minimised"
            raise InputError("optimize", "objective", expected, found)
    return as_objective(given)


@dataclass(frozen=True, slots=True)
class OwnValues:
    """What an objective of one's own is for the start and the result of a search."""

    figure: SearchedFigure
    before: float
    after: float
