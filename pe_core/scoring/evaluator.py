"""The Evaluator: one problem, made ready to score many rigs."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from ..errors import InputError
from ..kinds import PerceptionModel
from ..metric.fusion import Fusion
from ..prior.prior import Prior
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from ..text.values import Number, Whole, vector
from .cases import Cases, together
from .gridded import GridScorer
from .needs import columns_bytes, require_room_for, require_room_for_samples
from .sampled import Judgement, SampledScorer
from .sampling import CENTERED, samples_or_grid
from .score import Glance, Score, Watch
from .shared import shared_densities

WORKERS = Whole(0, 1024, "threads")
SHIFT = Number(0.0, 1.0, below=True)


class Evaluator:
    """Scores rigs in one space, under one prior, on one vehicle.

    Parameters
    ----------
    space : PerceptionSpace
    prior : Prior
    vehicle : Vehicle, optional
        None: nothing hides anything, and no voxel is excluded.
    samples : int
        Score on about this many voxels drawn from the prior; 0: all. The sample is
        fixed: two rigs are compared on the same voxels.
    shift : (3,) float
        Three numbers in [0, 1) that scramble the sample's sequence: others give another sample as
        good.
    model : PerceptionModel, optional
        AP curves and fusion rule; the paper's by default.
    workers : int, optional
        Threads for a grid score; all processors by default. The result does not depend on it.

    Raises
    ------
    InputError
        When the prior has no weight in the space outside the vehicle, or `samples` is too small.
    """

    def __init__(
        self,
        space: PerceptionSpace,
        prior: Prior,
        vehicle: Vehicle | None = None,
        *,
        samples: int = 0,
        shift: tuple[float, float, float] = CENTERED,
        model: PerceptionModel | None = None,
        workers: int | None = None,
    ) -> None:
        samples = samples_or_grid("evaluator", samples)
        if workers is not None:
            workers = WORKERS.checked("evaluator", "workers", workers)
        in_range = vector("evaluator", "shift", shift, 3, SHIFT)
        shift = in_range[0], in_range[1], in_range[2]
        self.space, self.prior, self.vehicle, self.samples = space, prior, vehicle, samples
        self._shift, self._model, self._workers = shift, model, workers
        classes = len(prior.class_names)
        require_room_for_samples(samples, columns_bytes(space, classes))
        require_room_for(space, lambda any_space: columns_bytes(any_space, classes))
        fusion = Fusion(model or PerceptionModel())
        self._scorer: GridScorer | SampledScorer
        if samples == 0:
            densities = prior.densities(space)
            self._scorer = GridScorer(space, densities, vehicle, fusion, workers)
        else:
            densities = self._densities = shared_densities(prior, space)
            self._scorer = SampledScorer(space, densities, vehicle, fusion, samples, shift)

    def __reduce__(self) -> tuple[object, ...]:
        """Another process makes its own from what this one was made from."""
        what = self.space, self.prior, self.vehicle
        return _evaluator_again, (*what, self.samples, self._shift, self._model, self._workers)

    def score(self, rig: Rig, *, draft: bool = False, watch: Watch | None = None) -> Score:
        """Score a rig in full: entropy, coverage, by class, by sensor, ground map.

        Parameters
        ----------
        rig : Rig
        draft : bool
            While a sensor is being moved: which LiDAR beams the vehicle stops is read from a map of
            its top surface, where the sensor stands above it, instead of cast. `Score.draft` says
            so. The next score without it is exact again. Sampled scores only.
        watch : callable, optional
            Called with the share that is done, 0 to 1, now and then while a grid is scored (a
            sample is done too soon); when it returns False, the score is stopped.

        Raises
        ------
        InputError
            When a draft is asked of a grid score.
        ScoreStopped
            When the one who watches said so.
        """
        if isinstance(self._scorer, SampledScorer):
            return self._scorer.score(rig, draft=draft)
        if draft:
            self._drafting()
        return self._scorer.score(rig, watch)

    def entropy(self, rig: Rig, *, draft: bool = False) -> float:
        """Perception entropy of a rig [nats], and nothing else: what an optimizer asks for.

        Parameters
        ----------
        rig : Rig
        draft : bool
            As in `score`, with the same error.
        """
        if draft:
            return self._drafting().entropy(rig, draft=True)
        return self._scorer.entropy(rig)

    def glance(self, rig: Rig, *, draft: bool = False) -> Glance:
        """Score a rig as a whole, not sensor by sensor: what is shown while one is moved.

        Parameters
        ----------
        rig : Rig
        draft : bool
            As in `score`.

        Raises
        ------
        InputError
            When the score is one of the grid.
        """
        if not isinstance(self._scorer, SampledScorer):
            raise InputError("evaluator", "glance", "a sampled score", "a grid score")
        return self._scorer.glance(rig, draft)

    def judge(self, rig: Rig, below: float = inf) -> Judgement:
        """Tell whether a rig's entropy is below a value: what a search asks of its candidates.

        A sampled score often need not ask what the vehicle hides to tell that it is not.

        Parameters
        ----------
        rig : Rig
        below : float
            As a rule the best entropy so far [nats]; inf: only an entropy will do.

        Returns
        -------
        Judgement
            The entropy; or, where that is not below `below`, perhaps a lower bound of it that is
            not below it either. `is_lower_bound` says so: such a number is none to rank by.
        """
        if isinstance(self._scorer, SampledScorer):
            return self._scorer.judge(rig, below)
        return Judgement(self._scorer.entropy(rig), False)

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Perception entropy of each of several rigs [nats].

        On a sample, a sensor that has the same name and pose in several of them is measured once.

        Parameters
        ----------
        rigs : sequence of Rig
            Of the same sensors, at the same or other poses; some may lack some.

        Raises
        ------
        InputError
            When there is no rig.
        """
        if isinstance(self._scorer, SampledScorer):
            return self._scorer.entropies(rigs)
        return [self._scorer.entropy(part) for part in Cases(rigs).parts]

    def judge_together(self, rigs: Sequence[Rig], below: float, worst: bool = False) -> Judgement:
        """As `judge`, of several rigs at once: of the mean of their entropies.

        Parameters
        ----------
        rigs : sequence of Rig
            As in `entropies`, with the same error.
        below : float
            As in `judge`.
        worst : bool
            The highest of the entropies instead of their mean.

        Returns
        -------
        Judgement
            As in `judge`: the mean (or highest) of the rigs' entropies, or of lower bounds of them.
        """
        if isinstance(self._scorer, SampledScorer):
            return self._scorer.judge_together(rigs, below, worst)
        return Judgement(together(self.entropies(rigs), worst), False)

    def _drafting(self) -> SampledScorer:
        if isinstance(self._scorer, SampledScorer):
            return self._scorer
        raise InputError("evaluator", "draft", "a sampled score", "a grid score")


def _evaluator_again(
    space: PerceptionSpace,
    prior: Prior,
    vehicle: Vehicle | None,
    samples: int,
    shift: tuple[float, float, float],
    model: PerceptionModel | None,
    workers: int | None,
) -> Evaluator:
    """Make an evaluator that was pickled: for worker processes."""
    return Evaluator(
        space, prior, vehicle, samples=samples, shift=shift, model=model, workers=workers
    )
