"""Sight: what is visible to rigs, in one space, under one prior, on one vehicle."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, read_only
from ...base.errors import InputError
from ...base.lazy_threads import threads
from ...base.values import rounded
from ...geometry.grids import PerceptionSpace
from ...metric.entropy import H_BLIND, ap_of_entropy, perception_entropy
from ...metric.frames import Frames
from ...metric.fusion import Fusion
from ...prior.prior import ClassDensity, Prior
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import PerceptionModel
from ..checks import require_scene
from ..evaluator import Evaluator
from ..rig_batch import fused_early
from ..sampling import CENTERED, Shift, VoxelSample, draw
from ..score import RigEvaluator, TrafficAp
from ..targets import OBJECTS, ObjectEvaluator, TargetRule, sample_objects
from ..targets.object_metric import LoneObjects
from .blind_ground import (
    SECTOR_HEIGHTS_M,
    SECTOR_RADIUS_M,
    SECTOR_RING_M,
    STEP_M,
    WITHIN_M,
    BlindGround,
    BlindSearch,
    BlindSector,
    area_of,
    blind_ground,
    body_rectangle,
    sector_cells,
    widest_sector,
)
from .ground_cells import GroundCells, widened
from .reach import AP, AT_LEAST_M, BEARINGS, Reach, Spokes, density_of, object_reach
from .surround_view import SurroundView, surround_view
from .visibility import (
    GroundSight,
    VisibleShares,
    VoxelSetCache,
    by_prior,
    ground_sight,
    in_layer,
    layer_at,
    visible_shares,
)

ORIGIN = ((0.0, 0.0), (0.0, 0.0))
SAMPLES = 65_536
"""Number of voxels for the AP by class."""
MIN_AP = 0.5
BEARINGS_SHOWN = 72
"""From which AP an object counts as found, and along how many bearings, unless one says so."""


class Sight:
    """Computes what is visible to rigs in one space, under one prior, on one vehicle.

    A sensor that has not moved since the last call is not measured again. It is thread-safe: one
    thread at a time computes.

    `InputError` when the prior has no weight in the space.

    Parameters
    ----------
    vehicle : Vehicle, optional
        None: nothing occludes.
    model : PerceptionModel, optional
        AP curves and fusion rule; the paper's by default.
    targets : TargetRule, optional
        Whether the study is scored on voxels (default) or objects. For objects, `reach` is that of
        lone objects, as in the score; for voxels, that of the class's voxels.
    frames : Frames, optional
        Frames that `over_frames` is of; one by default.
    samples : int
        Voxels that it is evaluated on; 0: all.
    shift : (3,) float
        Scrambles the samples of voxels and scenes, as of `Evaluator`.
    """

    def __init__(
        self,
        space: PerceptionSpace,
        prior: Prior,
        vehicle: Vehicle | None = None,
        *,
        model: PerceptionModel | None = None,
        targets: TargetRule | None = None,
        frames: Frames | None = None,
        samples: int = 0,
        shift: Shift = CENTERED,
    ) -> None:
        require_scene("sight", space, prior, vehicle)
        self.space = space
        self.prior = prior
        self.vehicle = vehicle
        self.frames = frames or Frames()
        self.targets = targets or TargetRule()
        self._samples = samples
        self._shift = shift
        self._model = model or PerceptionModel()
        self._fusion = Fusion(self._model)
        self._densities: list[ClassDensity] = prior.densities(space)
        self._voxel_sets = VoxelSetCache(space, vehicle, self._fusion)
        self._lock = threads().RLock()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments: another process makes one of its own from them."""
        again = partial(
            type(self),
            self.space,
            self.prior,
            self.vehicle,
            model=self._model,
            targets=self.targets,
            frames=self.frames,
            samples=self._samples,
            shift=self._shift,
        )
        return again, ()

    def ground(
        self, rig: Rig, height: float | None = None, step: float = 1.0, within: float | None = None
    ) -> GroundSight:
        """Return what is visible to the rig at every location on the ground.

        `InputError` when the height is not in the space, the step is not positive or gives too many
        cells, or no cell is within.

        Parameters
        ----------
        height : float, optional
            The height of the layer of voxels that is evaluated [m]. None: averaged over height by
            the prior, as in a score.
        step : float
            Side of a cell [m].
        within : float, optional
            Half the side of the square round the origin that is evaluated [m]; None: all.
        """
        part = None if within is None else widened(ORIGIN, within)
        cells = GroundCells.of(self.space, step, part)
        layer = None if height is None else layer_at(self.space, height)
        with self._lock:
            key = "ground", layer, cells.key
            measured = self._voxel_sets.voxels(
                key,
                lambda: (
                    by_prior(cells, self.space, self._tops, self._densities)
                    if layer is None
                    else in_layer(cells, self.space, self._tops, layer)
                ),
            )
            m = measured.measured(rig)
            return ground_sight(measured.voxels, rig, m, self._fusion, height=height)

    def blind(self, rig: Rig, height: float = 0.0, within: float = WITHIN_M) -> BlindGround:
        """Return the ground round the vehicle where a body is invisible to all sensors.

        The body is an upright cylinder, 0.3 m wide. All figures are conservative: no blind ground
        and no distance is too small, edges are at most three squares too far out, and ground less
        than a voxel beyond `within` may count.

        `InputError` when the height is not in the space, or no square is within, or too many are.

        Parameters
        ----------
        height : float
            Height of the body [m]; 0 or less: flat on the ground.
        within : float
            How far from the rectangle of the vehicle's body the ground is evaluated [m].
        """
        cells = self._cells_round_body(height, within)
        blind = self._blind_of(cells, rig, height)
        body = body_rectangle(self.vehicle)
        return blind_ground(cells, blind, body, float(height), within=float(within))

    def blind_area(self, rig: Rig, height: float = 0.0) -> float:
        """Return the area of `blind` [m2], without its outlines: quicker."""
        cells = self._cells_round_body(height, WITHIN_M)
        return area_of(cells, self._blind_of(cells, rig, height))

    def surround_view(self, rig: Rig, within: float = WITHIN_M) -> SurroundView:
        """Return which camera of the rig shows each square of the ground round the vehicle best.

        What is blind is what `blind` has, at height 0, for the cameras alone.

        `InputError` when the rig has no camera; otherwise as `blind`.
        """
        with self._lock:
            cells = self._cells_round_body(0.0, within)
            return surround_view(self._blind_search(cells, 0.0), rig)

    def blind_sectors(self, rig: Rig) -> tuple[BlindSector, ...]:
        """Return the widest blind sector for bodies of each of `SECTOR_HEIGHTS_M`.

        The body and the safe side are those of `blind`; the space may be smaller than the circle.
        """
        cells = sector_cells()
        ring = SECTOR_RADIUS_M - SECTOR_RING_M, SECTOR_RADIUS_M + SECTOR_RING_M
        found = ((h, self._blind_of(cells, rig, h, ring)) for h in SECTOR_HEIGHTS_M)
        return tuple(widest_sector(blind, height) for height, blind in found)

    def in_traffic(self, rig: Rig) -> TrafficAp | None:
        """Return the expected AP of the prior's objects in traffic.

        None where there is no such figure: the objects have no room in the space, or a sensor has
        an AP curve of its own, which is one of voxels.
        """
        with self._lock:
            try:
                return self._objects_in_traffic.expected_ap(rig)
            except InputError:
                return None

    def over_frames(self, rig: Rig) -> float | None:
        """Return the perception entropy over frames, eqs. T1 and T2 [nats]; None for one frame.

        Voxels are scored once for each process noise that occurs: a class's part is that of its
        own noise.
        """
        if self.frames.frames == 1:
            return None
        with self._lock:
            parts = [
                (names, scorer.summary(rig)) for names, scorer in self._scorers_over_frames.items()
            ]
        if len(parts) == 1:
            return parts[0][1].entropy
        shares = [
            (score.per_class[name].entropy, score.per_class[name].share)
            for names, score in parts
            for name in names
            if name in score.per_class
        ]
        entropies, weights = np.array(shares).T
        return rounded(perception_entropy(entropies, weights))

    @cached_property
    def _scorers_over_frames(self) -> Mapping[tuple[str, ...], RigEvaluator]:
        """Evaluators over frames, by the classes that have their process noise."""
        frames = self.frames
        own = self._model.model
        if self.targets.are_objects:
            model = self._model.with_model(own, frames)
            return {(): self._on_objects(self.targets, model)}
        classes: dict[Frames, tuple[str, ...]] = {}
        for name in self.prior.class_names:
            classes[frames.of_class(name)] = (*classes.get(frames.of_class(name), ()), name)
        return {
            names: Evaluator(
                self.space,
                self.prior,
                self.vehicle,
                samples=self._samples,
                shift=self._shift,
                model=self._model.with_model(own, each),
            )
            for each, names in classes.items()
        }

    def _on_objects(self, targets: TargetRule, model: PerceptionModel) -> ObjectEvaluator:
        return ObjectEvaluator(
            self.space,
            self.prior,
            self.vehicle,
            targets=targets,
            model=model,
            shift=self._shift[0],
            kernel_caches=self._voxel_sets.kernel_cache,
        )

    def _cells_round_body(self, height: float, within: float) -> GroundCells:
        area = widened(body_rectangle(self.vehicle), within)
        cells = GroundCells.of(self.space, STEP_M, area)
        layer_at(self.space, height)  # raises InputError for a height that is not in the space
        return cells

    def _blind_of(
        self, cells: GroundCells, rig: Rig, height: float, ring: tuple[float, float] | None = None
    ) -> NDArray[np.bool_]:
        with self._lock:
            return self._blind_search(cells, height, ring).blind(rig)

    def _blind_search(
        self, cells: GroundCells, height: float, ring: tuple[float, float] | None = None
    ) -> BlindSearch:
        kernels = self._voxel_sets.kernel_cache
        return self._voxel_sets.cached(
            ("blind", float(height), cells.key, ring),
            lambda: BlindSearch.of(
                cells, max(float(height), 0.0), self.vehicle, kernels, ring=ring
            ),
        )

    def reach(
        self, rig: Rig, class_name: str, *, ap: float = MIN_AP, bearings: int = BEARINGS_SHOWN
    ) -> Reach:
        """Return the distance up to which objects of a class are found, in all directions.

        In a study on objects, the reach is that of lone objects in each eighth of the circle, as in
        the score; `bearings` then has no effect.

        `InputError` when the prior has no such class, or a number is out of its range.

        Parameters
        ----------
        class_name : str
            A class of the prior.
        ap : float
            The expected AP from which an object counts as found, 0 to 1.
        """
        min_ap = AP.checked("sight", "ap", ap)
        count = BEARINGS.checked("sight", "bearings", bearings)
        density = density_of(self._densities, class_name)
        with self._lock:
            if self.targets.are_objects:
                return object_reach(self._lone, rig, class_name, min_ap)
            measured = self._voxel_sets.voxels(
                ("reach", class_name, count),
                lambda: Spokes.of(self.space, self._tops, density, count),
            )
            m = measured.measured(rig)
            spokes = measured.voxels
            alone = {
                s.name: read_only(spokes.distance(self._ap(rig, m, [s.name]), min_ap)) for s in rig
            }
            whole = read_only(spokes.distance(self._ap(rig, m, list(m)), min_ap))
            return Reach(
                class_name, min_ap, spokes.bearings, whole, per_sensor=alone, limit=spokes.limit
            )

    def reach_ahead(self, rig: Rig, class_name: str) -> tuple[float, bool]:
        """Return `reach` by voxels straight ahead [m], and whether it ends with the space."""
        density = density_of(self._densities, class_name)
        with self._lock:
            measured = self._voxel_sets.voxels(
                ("ahead", class_name),
                lambda: Spokes.of(self.space, self._tops, density, BEARINGS_SHOWN).ahead,
            )
            m = measured.measured(rig)
            spokes = measured.voxels
            found = float(spokes.distance(self._ap(rig, m, list(m)), MIN_AP)[0])
            return found, bool(0.0 < found >= spokes.limit[0] - AT_LEAST_M)

    def expected_ap(self, rig: Rig) -> dict[str, float]:
        """Return the expected AP of the fused rig by class: the prior's mean over voxels.

        It is computed on a sample of the prior, as a sampled score.

        Returns
        -------
        dict of float
            By class, 0.001 to 1; a class without mass is left out.
        """
        with self._lock:
            measured = self._voxel_sets.voxels("prior", self._sampled)
            m = measured.measured(rig)
            ap = self._ap(rig, m, list(m))
            likely = measured.voxels.classes
            masses = likely.sum(axis=0)
            return {
                name: rounded(float((ap * weights).sum() / mass))
                for name, weights, mass in zip(measured.voxels.names, likely.T, masses, strict=True)
                if mass > 0.0
            }

    def shares(self, rig: Rig) -> VisibleShares:
        """Return the visible shares of the prior, and how much each sensor's failure costs by zone.

        Computed on a sample of the prior, as `expected_ap`.
        """
        with self._lock:
            measured = self._voxel_sets.voxels("prior", self._sampled)
            m = measured.measured(rig)
            return visible_shares(measured.voxels, m, self._rises(rig, m))

    def _sampled(self) -> VoxelSample:
        return draw(self._densities, self.space, SAMPLES, self._tops, shift=self._shift)

    def _ap(self, rig: Rig, m: Mapping[str, NDArray], members: Collection[str]) -> Floats:
        """Return the AP of every voxel with some sensors fused: eqs. 4 to 7, and 5 inverted."""
        entropies, _ = self._fusion.entropies(fused_early(rig, m, members))
        return ap_of_entropy(entropies)

    def _rises(self, rig: Rig, m: Mapping[str, NDArray]) -> dict[str, Floats]:
        """Return how much the entropy of every voxel rises without each sensor [nats], by name."""
        whole, _ = self._fusion.entropies(fused_early(rig, m, list(m)))
        rises = {}
        for name in m:
            rest = [other for other in m if other != name]
            without = self._fusion.entropies(fused_early(rig, m, rest))[0] if rest else H_BLIND
            rises[name] = without - whole
        return rises

    @cached_property
    def _objects_in_traffic(self) -> ObjectEvaluator:
        targets = replace(self.targets, targets=OBJECTS, traffic=True)
        return self._on_objects(targets, self._model)

    @cached_property
    def _lone(self) -> LoneObjects:
        objects = sample_objects(self.prior, self.space, self.vehicle, self.targets)
        return LoneObjects(objects, self.vehicle, self._model)

    @cached_property
    def _tops(self) -> Floats | None:
        return None if self.vehicle is None else self.vehicle.top(self.space)
