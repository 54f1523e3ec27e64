"""The objectives of a Pareto front: their figures for a rig, and scalar values made of them."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from pe_core.base.errors import InputError
from pe_core.base.values import rounded
from pe_core.scene.rig import Rig
from pe_core.scoring import RigEvaluator
from pe_core.scoring.score import Score
from pe_core.search import objective_of
from pe_core.search.build_figures import SUMS, BuildFigure
from pe_core.search.figures import AP, ENTROPY, FIGURES, ON_FRONT, figure_of
from pe_core.search.rig_view import RigView, Scorers
from pe_core.study.study import Study

AUGMENTED = 0.05
"""Weight of the sum beside the maximum: it drops placements that are only weakly efficient."""
TIE = 1e-3  # Weight of the other objectives while the best value of one is looked for
FrontValues = Mapping[str, float]
FunctionsByName = Mapping[str, Callable[[Rig], float]]  # Functions from Python, by name


def objectives_of(
    given: Sequence[str | Callable[[Rig], float]],
) -> tuple[tuple[str, ...], FunctionsByName]:
    """Return the names of objectives, and those that are functions. `InputError` unless they are
    two or more, each once, functions by a name of their own, and one depends on the placement."""
    names = [getattr(e, "__name__", type(e).__name__) if callable(e) else str(e) for e in given]
    own = {name: each for name, each in zip(names, given, strict=True) if callable(each)}
    free = {name for name in names if (name in ON_FRONT) != (name in own)}
    if not free - set(SUMS) or len(free) < max(2, len(names)):
        expected = f"two or more of {', '.join(ON_FRONT)}, or functions; not sums alone"
        raise InputError("optimize", "front.objectives", expected, ", ".join(names))
    return tuple(names), own


class FrontFigures:
    """Computes the objectives of rigs of one study, all but sums; a rig is evaluated once.
    `evaluator` is that of the search; `in_traffic` evaluates the AP of a study that goes by it."""

    def __init__(
        self,
        study: Study,
        names: Sequence[str],
        evaluator: RigEvaluator,
        in_traffic: RigEvaluator | None = None,
        own: FunctionsByName | None = None,
    ) -> None:
        self._given = study, tuple(names), evaluator, in_traffic, own
        self._in_traffic = in_traffic
        self.names = tuple(names)
        self._own = own or {}
        self._sight = study.sight()
        search = study.search
        checker = study.checker()
        self._scorers = Scorers(
            objective_of(evaluator, search.tolerance, search.seed).figure,
            voxels=evaluator,
            objects=in_traffic or evaluator,
            verdicts=lambda rig: study.verdicts(rig, checker),
        )
        self._known: dict[tuple[object, ...], dict[str, float]] = {}

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments: a worker has figures of its own from them."""
        return FrontFigures, self._given

    def __call__(self, rig: Rig) -> FrontValues:
        """Return the objectives of a rig by name, each in its own unit."""
        key = tuple((s.name, s.model.name, s.pose.position, s.pose.rpy) for s in rig)
        if key not in self._known:
            view = RigView(self._sight, rig, self._scorers)
            self._known[key] = {name: rounded(self._value(name, view)) for name in self.names}
        return self._known[key]

    def costs(self, rig: Rig) -> list[float]:
        """Return the objectives of a rig as values to minimise."""
        return [figure_of(name).signed(value) for name, value in self(rig).items()]

    def scored(self, rig: Rig, score: Score) -> FrontValues:
        """Return the objectives with entropy and AP of a score on all voxels of the study."""
        figures = dict(self(rig))
        if ENTROPY in figures:
            figures[ENTROPY] = score.entropy
        if AP in figures and score.objects is not None and self._in_traffic is None:
            figures[AP] = score.objects.ap
        return figures

    def _value(self, name: str, view: RigView) -> float:
        if name in self._own:
            return self._own[name](view.rig)
        row = FIGURES[name]
        field = f"front.objectives: {name}"
        if isinstance(row, BuildFigure):
            row.required(view.placement, "optimize", field)
        found = row.worst(row.values(view))
        if found is None:
            expected = f"a study with {row.needs or f'a known {row.name}'}"
            raise InputError("optimize", field, expected, "none")
        return found


class ScalarValue:
    """One value of several objectives, as a search minimises it. The augmented weighted Chebyshev
    norm of the distance from the ideal point (Steuer and Choo, "An interactive weighted Tchebycheff
    procedure", 1983): each placement of the Pareto front is the best one for some weights, also
    where the front is not convex. `ideal` and `span` are the best value of each objective, and how
    far its values are apart on the front so far."""

    def __init__(
        self,
        figures: FrontFigures,
        weights: Sequence[float],
        ideal: Sequence[float],
        span: Sequence[float],
    ) -> None:
        self._figures = figures
        self._weights = weights
        self._ideal = ideal
        self._span = span

    def shared_parts(self) -> tuple[object, ...]:
        """Return what workers are sent once: the figures. Weights are other ones at each point."""
        return (self._figures,)

    def scalar(self, costs: Sequence[float]) -> float:
        """Return the value of costs."""
        off = [(c - i) / s for c, i, s in zip(costs, self._ideal, self._span, strict=True)]
        weighted = max(w * o for w, o in zip(self._weights, off, strict=True))
        alone = sum(w > 0.0 for w in self._weights) == 1
        return rounded(weighted + (TIE if alone else AUGMENTED) * sum(off) / len(off))

    def __call__(self, rig: Rig) -> float:
        """Return the value of a rig."""
        return self.scalar(self._figures.costs(rig))


def weights_of(count: int, objectives: int) -> list[tuple[float, ...]]:
    """Return weights: first each objective alone, then evenly over all of them together. Even
    weights are a rank-1 lattice on the unit cube, mapped to the simplex by the spacings of its
    sorted coordinates."""
    if objectives == 1:
        return [(1.0,)]
    alone = [tuple(float(k == n) for k in range(objectives)) for n in range(objectives)]
    together = max(0, count - objectives)
    golden = (math.sqrt(5.0) - 1.0) / 2.0
    mixed = []
    for number in range(together):
        cuts = [((number + 0.5) / together)] + [
            (number * golden ** (k + 1) + 0.5) % 1.0 for k in range(objectives - 2)
        ]
        edges = [0.0, *sorted(cuts), 1.0]
        mixed.append(tuple(b - a for a, b in pairwise(edges)))
    return [*alone, *mixed]


def spread(costs: Sequence[Sequence[float]], count: int) -> list[int]:
    """Return the indices of at most `count` costs, far from each other, the extremes first."""
    if len(costs) <= count:
        return list(range(len(costs)))
    low = [min(column) for column in zip(*costs, strict=True)]
    width = [max(c) - lo or 1.0 for c, lo in zip(zip(*costs, strict=True), low, strict=True)]
    scaled = [[(v - lo) / w for v, lo, w in zip(c, low, width, strict=True)] for c in costs]
    chosen = list(
        dict.fromkeys(
            min(range(len(costs)), key=lambda k: c[k])
            for c in [[row[n] for row in scaled] for n in range(len(low))]
        )
    )[:count]
    while len(chosen) < count:
        far = max(
            (k for k in range(len(costs)) if k not in chosen),
            key=lambda k: min(math.dist(scaled[k], scaled[j]) for j in chosen),
        )
        chosen.append(far)
    return sorted(chosen)
