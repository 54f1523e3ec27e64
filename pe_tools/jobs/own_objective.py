"""An objective of one's own: a function of a rig that a search minimises in place of entropy."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.scene.rig import Rig
from pe_core.search import Objective, as_objective
from pe_core.search.figures import FIGURES
from pe_core.study.requirement_search import INFEASIBLE
from pe_core.study.study import ENTROPY, EXPECTED_AP, Study

from .searched_figure import SearchedFigure

LINEAR_UP_TO = INFEASIBLE / 2.0
"""Up to this figure a search minimises the figure itself, beyond it a bounded function of it."""
TAKEN = frozenset({*FIGURES, EXPECTED_AP, "evaluation", "evaluations", "round", "placements"})
"""Names with another meaning in the files of a result."""


@dataclass(frozen=True, slots=True)
class OwnFigure(SearchedFigure):
    """The figure of an objective of one's own. A search minimises a function of it that rises with
    it and stays below `INFEASIBLE`, because larger values are those of broken constraints."""

    def to_value(self, figure: float) -> float:
        """Return the value that a search minimises; of an infinite figure, infinity."""
        if figure <= LINEAR_UP_TO or math.isinf(figure):
            return figure
        bounded = INFEASIBLE - LINEAR_UP_TO * LINEAR_UP_TO / figure
        return min(bounded, math.nextafter(INFEASIBLE, 0.0))

    def to_figure(self, value: float) -> float:
        """Return the figure of a value; a value of broken constraints stays as it is."""
        if value <= LINEAR_UP_TO or value >= INFEASIBLE:
            return value
        return LINEAR_UP_TO * LINEAR_UP_TO / (INFEASIBLE - value)

    def amount(self, figure: str) -> str:
        """Return a figure in a sentence: "0.32 by cables"."""
        return f"{figure} by {self.label}"


class OwnObjective:
    """An objective of one's own, as a search minimises it.

    Parameters
    ----------
    given : callable, or an object with a method ``entropy``
        Takes a `Rig` and returns a number; lower is better.

    Raises
    ------
    InputError
        It is neither, or its name has another meaning in the files of a result.
    """

    def __init__(self, given: Any) -> None:
        self._objective = as_objective(given)
        name = getattr(given, "__name__", type(given).__name__)
        if name in TAKEN:
            expected = "a name of its own"
            raise InputError("optimize", "objective", expected, f"a function called {name!r}")
        self.figure = OwnFigure(name, name.replace("_", " "), 1.0)

    def figure_of(self, rig: Rig) -> float:
        """Return the number that is given for a rig; `InputError` where it is none."""
        found = self._objective.entropy(rig)
        if math.isnan(found):
            raise InputError("objective", "value", "a number for each rig", shown(found))
        return float(found)

    def entropy(self, rig: Rig) -> float:
        """Return the value of a rig that a search minimises."""
        return self.figure.to_value(self.figure_of(rig))


def own_objective(study: Study, given: Callable[[Rig], float] | Objective) -> OwnObjective:
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
    return OwnObjective(given)


@dataclass(frozen=True, slots=True)
class OwnValues:
    """What an objective of one's own is for the start and the result of a search."""

    figure: SearchedFigure
    before: float
    after: float
