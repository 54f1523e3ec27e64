"""Sight: one problem, made ready to tell what many rigs see."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cached_property
from threading import RLock

import numpy as np
from numpy.typing import NDArray

from ..kinds import PerceptionModel
from ..metric.entropy import H_BLIND, ap_of_entropy
from ..metric.fusion import Fusion
from ..prior.prior import ClassDensity, Prior
from ..scene.frozen import frozen
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from ..scoring.sampling import VoxelSample, draw
from ..scoring.score import rounded
from ..scoring.subsets import fused_early
from ..targets import LoneObjects, TargetRule, drawn_objects
from .blind import BlindGround, blind_ground, body_rectangle
from .blind_squares import STEP_M, BlindLook, fine_enough
from .cells import GroundCells, round_a
from .ground import GroundSight, ground_sight
from .look import KnownSightings
from .object_reach import object_reach
from .places import VoxelsByCell, by_prior, in_layer, layer_at
from .reach import AP, BEARINGS, Reach, Spokes, density_of
from .shares import SeenShares, seen_shares

Floats = NDArray[np.float64]

ORIGIN = ((0.0, 0.0), (0.0, 0.0))
SAMPLES = 65_536
"""Voxels that the AP by class is a mean of."""


class Sight:
    """Tells what rigs see in one space, under one prior, on one vehicle.

    A sensor that has not moved since it was last asked about the same places is not measured again.
    One thread at a time: others wait.

    Parameters
    ----------
    space : PerceptionSpace
    prior : Prior
    vehicle : Vehicle, optional
        None: nothing hides anything.
    model : PerceptionModel, optional
        AP curves and fusion rule; the paper's by default.
    targets : TargetRule, optional
        What the study is scored on. On objects, `reach` is that of lone objects, as the score
        tells it; on voxels, the default, that of the class's voxels.

    Raises
    ------
    InputError
        When the prior has no weight in the space.
    """

    def __init__(
        self,
        space: PerceptionSpace,
        prior: Prior,
        vehicle: Vehicle | None = None,
        *,
        model: PerceptionModel | None = None,
        targets: TargetRule | None = None,
    ) -> None:
        self.space, self.prior, self.vehicle = space, prior, vehicle
        self._model, self.targets = model or PerceptionModel(), targets or TargetRule()
        self._fusion = Fusion(self._model)
        self._densities: list[ClassDensity] = prior.densities(space)
        self._looks = KnownSightings(space, vehicle, self._fusion)
        self._is_free = RLock()

    def ground(
        self,
        rig: Rig,
        height: float | None = None,
        step: float = 1.0,
        draft: bool = False,
        within: float | None = None,
    ) -> GroundSight:
        """Tell what the rig sees of every place on the ground.

        Parameters
        ----------
        rig : Rig
        height : float, optional
            Where to look: the layer of voxels that holds this height [m]. None: averaged over
            height by the prior, as a score does.
        step : float
            Side of a place [m].
        draft : bool
            While a sensor is being moved, as in `Evaluator.score`.
        within : float, optional
            Half the side of the square round the origin that is looked at [m]; None: all.

        Raises
        ------
        InputError
            When the height is not in the space, the step is not positive or has too many places, or
            nothing lies within.
        """
        part = None if within is None else round_a(ORIGIN, within)
        cells = GroundCells.of(self.space, step, part)
        layer = None if height is None else layer_at(self.space, height)
        with self._is_free:
            look = self._looks.at(("ground", layer, cells.key), lambda: self._places(layer, cells))
            m, drafted = look.measured(rig, draft)
            return ground_sight(look.places, rig, m, self._fusion, height, drafted)

    def blind(
        self,
        rig: Rig,
        height: float = 0.0,
        within: float = 10.0,
        step: float = STEP_M,
        draft: bool = False,
    ) -> BlindGround:
        """Tell where round the vehicle nothing is seen of what stands on the ground.

        That is an upright cylinder 0.3 m wide. Figures err to the safe side: no blind ground and
        no distance is too small, and edges lie at most three squares too far out.

        Parameters
        ----------
        rig : Rig
        height : float
            How tall that is [m]; 0, and less: flat on the ground.
        within : float
            How far from the rectangle of the vehicle's body to look [m].
        step : float
            Side of the squares that the ground is judged in [m]; those of one wider than 0.1 m
            are cut.
        draft : bool
            As in `ground`.

        Raises
        ------
        InputError
            When the height is not in the space, the step is not positive or has too many places, or
            nothing lies within.
        """
        body = body_rectangle(self.vehicle)
        cells = GroundCells.of(self.space, fine_enough(step), round_a(body, within))
        layer_at(self.space, height)  # refuses a height that is not in the space
        height = float(height)
        with self._is_free:
            look = self._looks.kept(
                ("blind", height, cells.key),
                lambda: BlindLook.of(cells, max(height, 0.0), self.vehicle, self._looks.known),
            )
            blind, drafted = look.blind(rig, draft)
            return blind_ground(cells, blind, body, height, float(within), drafted)

    def reach(
        self,
        rig: Rig,
        class_name: str,
        *,
        ap: float = 0.5,
        bearings: int = 72,
        draft: bool = False,
    ) -> Reach:
        """Tell how far away objects of a class are still found, all round.

        Of a study on objects that is how far lone ones are, in each eighth of the circle, as the
        score tells it; `bearings` and `draft` change nothing then.

        Parameters
        ----------
        rig : Rig
        class_name : str
            A class of the prior.
        ap : float
            What AP is to be expected, 0 to 1.
        bearings : int
        draft : bool
            As in `ground`.

        Raises
        ------
        InputError
            When the prior has no such class, or a number is out of its range.
        """
        least = AP.checked("sight", "ap", ap)
        count = BEARINGS.checked("sight", "bearings", bearings)
        density = density_of(self._densities, class_name)
        with self._is_free:
            if self.targets.are_objects:
                return object_reach(self._lone, rig, class_name, least)
            look = self._looks.at(
                ("reach", class_name, count),
                lambda: Spokes.of(self.space, self._tops, density, count),
            )
            m, drafted = look.measured(rig, draft)
            spokes = look.places
            alone = {
                s.name: frozen(spokes.distance(self._ap(rig, m, [s.name]), least)) for s in rig
            }
            whole = frozen(spokes.distance(self._ap(rig, m, list(m)), least))
            return Reach(class_name, least, spokes.bearings, whole, alone, spokes.limit, drafted)

    def expected_ap(self, rig: Rig, *, draft: bool = False) -> dict[str, float]:
        """Tell the AP that is expected of the fused rig, by class: the prior's mean over voxels.

        On a sample of the prior, as a sampled score.

        Parameters
        ----------
        rig : Rig
        draft : bool
            As in `ground`.

        Returns
        -------
        dict of float
            By class, 0.001 to 1; a class without mass is left out.
        """
        with self._is_free:
            look = self._looks.at("prior", self._drawn)
            m, _ = look.measured(rig, draft)
            ap = self._ap(rig, m, list(m))
            likely = look.places.classes
            masses = likely.sum(axis=0)
            return {
                name: rounded(float((ap * own).sum() / mass))
                for name, own, mass in zip(look.places.names, likely.T, masses, strict=True)
                if mass > 0.0
            }

    def shares(self, rig: Rig, *, draft: bool = False) -> SeenShares:
        """Tell how much of where objects are is seen, and what each sensor's loss costs by zone.

        On a sample of the prior, as `expected_ap`; `draft` as in `ground`.
        """
        with self._is_free:
            look = self._looks.at("prior", self._drawn)
            m, _ = look.measured(rig, draft)
            return seen_shares(look.places, m, self._rises(rig, m))

    @property
    def densities(self) -> tuple[ClassDensity, ...]:
        """The prior on the space, class by class."""
        return tuple(self._densities)

    def _drawn(self) -> VoxelSample:
        return draw(self._densities, self.space, SAMPLES, self._tops)

    def _ap(self, rig: Rig, m: Mapping[str, NDArray], members: Collection[str]) -> Floats:
        """AP of every voxel, of some sensors fused: eqs. 4 to 7, and 5 backwards."""
        entropies, _ = self._fusion.entropies(fused_early(rig, m, members))
        return ap_of_entropy(entropies)

    def _rises(self, rig: Rig, m: Mapping[str, NDArray]) -> dict[str, Floats]:
        """How much the entropy of every voxel rises without each sensor [nats], by name."""
        whole, _ = self._fusion.entropies(fused_early(rig, m, list(m)))
        rises = {}
        for name in m:
            others = [other for other in m if other != name]
            without = self._fusion.entropies(fused_early(rig, m, others))[0] if others else H_BLIND
            rises[name] = without - whole
        return rises

    def _places(self, layer: int | None, cells: GroundCells) -> VoxelsByCell:
        if layer is None:
            return by_prior(cells, self.space, self._tops, self._densities)
        return in_layer(cells, self.space, self._tops, layer)

    @cached_property
    def _lone(self) -> LoneObjects:
        drawn = drawn_objects(self.prior, self.space, self.vehicle, self.targets)
        return LoneObjects(drawn, self.vehicle, self._model)

    @cached_property
    def _tops(self) -> Floats | None:
        return None if self.vehicle is None else self.vehicle.top(self.space)


def expected_ap(
    space: PerceptionSpace,
    prior: Prior,
    rig: Rig,
    vehicle: Vehicle | None = None,
    *,
    model: PerceptionModel | None = None,
) -> dict[str, float]:
    """Tell the AP that is expected of a rig by class: `Sight.expected_ap` asked once."""
    return Sight(space, prior, vehicle, model=model).expected_ap(rig)
