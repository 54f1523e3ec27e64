"""What a search minimises: a figure of a rig, under constraints.

Values are tuples, which order themselves. A placement that keeps all constraints is better than
each one that breaks some; of those that do, the one with the least violation is the best. Their
figures do not matter and are not computed.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, NamedTuple, Protocol

from ..base.errors import InputError, shown
from ..base.setting import Part
from ..base.values import Number, real, rounded
from ..scene.rig import Rig

NOT_NEGATIVE = Number(0.0, infinite=True)
ABOVE_MINUS_INF = Number(above=True, infinite=True)


class Value(NamedTuple):
    """The value of a placement in a search; the lower one of two is better.

    `violation`: By how much it breaks constraints; 0 where it keeps all of them.
    `objective`: The figure that the search minimises; inf where a constraint is broken.
    """

    violation: Annotated[float, Part(rule=NOT_NEGATIVE)]
    objective: Annotated[float, Part(rule=ABOVE_MINUS_INF)]

    @property
    def is_feasible(self) -> bool:
        """Whether all constraints are kept."""
        return self.violation == 0.0

    def worse_by(self, amount: float) -> "Value":
        """Return a value that is so much higher in what tells it from others."""
        if self.is_feasible:
            return Value(0.0, self.objective + amount)
        return Value(self.violation + amount, self.objective)

    def rise_from(self, other: "Value") -> float:
        """Return how much higher this value is than another: its objective, or its violation where
        both break constraints; plus or minus inf where one of them does."""
        if self.is_feasible and other.is_feasible:
            return self.objective - other.objective
        if self.is_feasible or other.is_feasible:
            return math.inf if self > other else -math.inf
        return self.violation - other.violation


NO_VALUE = Value(math.inf, math.inf)
"""Above all values: of a candidate that is not below the cutoff; the cutoff of all others."""


class Leader(NamedTuple):
    """A placement that candidates race against, and its value by the same objective."""

    rig: Rig
    value: Value


class FeasibilityRule(Protocol):
    """What a placement keeps, or breaks by its violation."""

    def violation(self, rig: Rig, enough: float = math.inf) -> float:
        """Return how far a rig breaks it; 0: it is kept. What comes to `enough` may be less than
        all of it."""


class Objective:
    """What a search minimises: a figure of a rig, under constraints.

    Parameters
    ----------
    figure : callable
        Takes a `Rig` and returns a number, the same for the same rig; lower is better. A method
        ``below``, of a rig and a number, may return inf sooner where the figure is not below that.
        A method ``loses``, of a rig, a leader and a number, tells early whether the figure of the
        rig is surely higher than that of the leader, by more than the number.
        A method ``shared_parts`` returns what workers are sent once, if that is not all of it.
    constraints : sequence of FeasibilityRule
    """

    def __init__(
        self, figure: Callable[[Rig], float], constraints: Sequence[FeasibilityRule] = ()
    ) -> None:
        self.figure = figure
        self._constraints = tuple(constraints)

    def under(self, constraints: Sequence[FeasibilityRule]) -> "Objective":
        """Return the objective under further constraints."""
        return Objective(self.figure, (*self._constraints, *constraints))

    def value(self, rig: Rig) -> Value:
        """Return the value of a placement; `InputError` where its figure is no number."""
        return self.below(rig, NO_VALUE)

    def below(self, rig: Rig, cutoff: Value, leader: Leader | None = None) -> Value:
        """Return the value of a placement where it is below a cutoff; otherwise `NO_VALUE`. A
        placement whose figure is not below is not held to the constraints, which takes longer; one
        that surely is not, as a race against the leader shows, has no figure computed."""
        if cutoff.is_feasible:
            if leader is not None and self._loses(rig, cutoff, leader):
                return NO_VALUE
            found = self._figure_below(rig, cutoff.objective)
            kept = found < cutoff.objective and not self.violation(rig, 0.0)
            return Value(0.0, found) if kept else NO_VALUE
        violation = self.violation(rig, cutoff.violation)
        value = Value(violation, math.inf) if violation else Value(0.0, self._number(rig))
        return value if value < cutoff else NO_VALUE

    def violation(self, rig: Rig, enough: float = math.inf) -> float:
        """Return the sum of the violations of all constraints; 0 where all are kept.
        Where it comes to `enough`, further ones are not computed."""
        return violation_sum((each.violation(rig, enough) for each in self._constraints), enough)

    def shared_parts(self) -> tuple[object, ...]:
        """Return what a worker is sent once; the rest comes with each candidate."""
        own: Callable[[], tuple[object, ...]] | None = getattr(self.figure, "shared_parts", None)
        whole = (getattr(self.figure, "__self__", self.figure),)  # of a method, its object
        return (*(whole if own is None else own()), *self._constraints)

    def _loses(self, rig: Rig, cutoff: Value, leader: Leader) -> bool:
        """Whether a race shows that the figure of a rig is not below the cutoff."""
        loses: Callable[[Rig, Rig, float], bool] | None = getattr(self.figure, "loses", None)
        spare = cutoff.objective - leader.value.objective
        return loses is not None and loses(rig, leader.rig, spare)

    def _figure_below(self, rig: Rig, cutoff: float) -> float:
        below: Callable[[Rig, float], float] | None = getattr(self.figure, "below", None)
        return self._number(rig) if below is None else below(rig, cutoff)

    def _number(self, rig: Rig) -> float:
        value = real(found := self.figure(rig))
        if math.isnan(value):
            raise InputError("objective", "value", "a number for each rig", shown(found))
        return value


def violation_sum(violations: Iterable[float], enough: float) -> float:
    """Return the sum of violations; where it comes to `enough`, further ones are not computed."""
    total = 0.0
    for each in violations:
        total += each
        if (found := rounded(total)) and found >= enough:
            break
    return rounded(total)
