"""The Evaluator: one problem, made ready to score many rigs."""

from collections.abc import Sequence
from functools import cached_property, partial

import numpy as np

from ..base.arrays import Floats
from ..base.values import Number, Whole, vector
from ..geometry.grids import PerceptionSpace
from ..metric.fusion import Fusion
from ..prior.prior import Prior
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from ..sensors import PerceptionModel
from .checks import require_scene
from .grid_scorer import GridScorer, columns_bytes, require_room_for, require_room_for_samples
from .sampled_scorer import SampledScorer
from .sampling import CENTERED, SAMPLES_OR_GRID, Shift
from .score import Score, Watch

WORKERS = Whole(0, 1024, "threads")
SHIFT = Number(0.0, 1.0, below=True)


class Evaluator:
    """Scores rigs in one space, under one prior, on one vehicle.

    `InputError` when the prior has no weight in the space outside the vehicle, or `samples` is too
    small.

    Parameters
    ----------
    vehicle : Vehicle, optional
        None: nothing hides anything, and no voxel is excluded.
    samples : int
        Score on about this many voxels drawn from the prior; 0: all. The sample is
        fixed: two rigs are compared on the same voxels.
    shift : (3,) float
        Three numbers in [0, 1) that scramble the sample's sequence: other numbers give another
        sample of the same quality.
    model : PerceptionModel, optional
        AP curves and fusion rule; the paper's by default.
    workers : int, optional
        Threads for a grid score; all processors by default. The result does not depend on it.
    """

    def __init__(
        self,
        space: PerceptionSpace,
        prior: Prior,
        vehicle: Vehicle | None = None,
        *,
        samples: int = 0,
        shift: Shift = CENTERED,
        model: PerceptionModel | None = None,
        workers: int | None = None,
    ) -> None:
        require_scene("evaluator", space, prior, vehicle)
        samples = SAMPLES_OR_GRID.checked("evaluator", "samples", samples)
        if workers is not None:
            workers = WORKERS.checked("evaluator", "workers", workers)
        in_range = vector("evaluator", "shift", shift, count=3, rule=SHIFT)
        shift = in_range[0], in_range[1], in_range[2]
        self.space = space
        self.prior = prior
        self.vehicle = vehicle
        self.samples = samples
        self._shift = shift
        self._model = model
        self._workers = workers
        _ = self._scorer  # made here, so that what is wrong is told here

    @cached_property
    def _scorer(self) -> GridScorer | SampledScorer:
        space = self.space
        classes = len(self.prior.class_names)
        require_room_for_samples(self.samples, columns_bytes(space, classes))
        require_room_for(space, lambda any_space: columns_bytes(any_space, classes))
        fusion = Fusion(self._model or PerceptionModel())
        densities = self.prior.densities(space)
        if self.samples == 0:
            return GridScorer(space, densities, self.vehicle, fusion, workers=self._workers)
        return SampledScorer(
            space, densities, self.vehicle, fusion, samples=self.samples, shift=self._shift
        )

    def __getstate__(self) -> dict[str, object]:
        """Pickle the arguments. Another process makes a scorer of its own from them, once it scores
        a rig: of the evaluators that it is sent it perhaps needs a few."""
        return {name: value for name, value in vars(self).items() if name != "_scorer"}

    @property
    def _like_this(self) -> "partial[Evaluator]":
        """Makes an evaluator of the same problem, of a number of samples."""
        problem = partial(Evaluator, self.space, self.prior, self.vehicle, shift=self._shift)
        return partial(problem, model=self._model, workers=self._workers)

    def on_first(self, samples: int) -> "Evaluator":
        """Return the evaluator on the first voxels of this one's sample.

        `InputError` when there are too few.

        Parameters
        ----------
        samples : int
            How many voxels; of a sample, at most as many as it has.
        """
        return self._like_this(samples=samples)

    def score(self, rig: Rig, *, watch: Watch | None = None) -> Score:
        """Score a rig in full: entropy, coverage, by class, by sensor, ground map.

        `ScoreStopped` when `watch` returned False.

        Parameters
        ----------
        watch : callable, optional
            Called repeatedly with the completed share, 0 to 1. When it returns False, the
            score is stopped.
        """
        return self._scorer.score(rig, watch)

    def entropy(self, rig: Rig) -> float:
        """Return the perception entropy of a rig [nats], without the other figures."""
        return self._scorer.entropy(rig)

    def summary(self, rig: Rig) -> Score:
        """Return the score of a rig without the part by sensor: for one that is being moved."""
        return self._scorer.summary(rig)

    def residuals(self, rigs: Sequence[Rig]) -> Floats:
        """Return by rig what each of R batches of the sample adds to the entropy above its mean,
        (N, R) [nats]: `scoring.score.standard_error` of differences of rows is that of differences
        of entropies. Zeros (N, 1) for the whole grid.

        Parameters
        ----------
        rigs : sequence of Rig
            As of `entropies`.
        """
        if isinstance(self._scorer, GridScorer):
            return np.zeros((len(rigs), 1))
        return self._scorer.residuals(rigs)

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the perception entropy of each of several rigs [nats].

        On a sample, a sensor that has the same name and pose in several of them is measured once.

        `InputError` when there is no rig.

        Parameters
        ----------
        rigs : sequence of Rig
            Rigs of the same sensors, in the same or other poses; sensors may be missing.
        """
        return self._scorer.entropies(rigs)
