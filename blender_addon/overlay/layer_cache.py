"""Caches of the layers: shapes that are shown, and results that are expensive to compute.

Plain data, no scene and no GPU. `shown` belongs to the main thread, a `LayerCache` to one thread.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from ..engine import graphics, pe, requirements, sight, text
from ..processes import engine_calls
from .request import SceneSensor, ViewRequest

Sight = sight.Sight  # a cache has a method `sight`
GroundSight = sight.GroundSight
T = TypeVar("T")
MAX_TRIANGLES = 50_000
"""A vehicle of more is simplified for drawing: a picture shows no more detail."""
MAX_KEPT = {"casts": 24, "compared": 2, "evaluators": 3, "scale": 16}
"""How many results of a sort are kept, those used last; otherwise one."""


@dataclass(frozen=True, slots=True, eq=False)
class ShownLayer:
    """A shape, and a key of its inputs; `rough`: it is approximate."""

    key: Hashable
    shape: graphics.LayerShape
    rough: bool


shown: dict[tuple[str, str], Mapping[str, ShownLayer]] = {}
"""The shapes that the 3D views draw, by scene and layer, then by the sensor's name."""


def shown_of(scene: str, layer: str) -> Mapping[str, ShownLayer]:
    """Return the shapes of a layer in a scene, by the sensor's name."""
    return shown.get((scene, layer), {})


class LayerCache:
    """Caches expensive results by plain keys; never used by two threads at once."""

    def __init__(self) -> None:
        self._kept: dict[str, text.RecentCache[Any]] = {}
        self._met: dict[Hashable, tuple[dict[str, bool], dict[str, bool]]] = {}

    def cast(self, request: ViewRequest, of: SceneSensor) -> graphics.Cast:
        """Return where the beams of a LiDAR end; of a few beams while something moves."""
        most = graphics.PREVIEW_BEAMS if request.moving else graphics.MAX_BEAMS
        key = of.key, request.body_key, most
        return self._keep("casts", key, lambda: graphics.cast(of.sensor, self.body(request), most))

    def body(self, request: ViewRequest) -> pe.Vehicle | None:
        """Return the vehicle, simplified where it has very many triangles."""
        vehicle = request.vehicle
        if vehicle is None or len(vehicle.triangles) <= MAX_TRIANGLES:
            return vehicle
        # it takes seconds for millions
        key = request.body_key
        few = MAX_TRIANGLES
        return self._keep("body", key, lambda: graphics.simplified(vehicle, few, quick=True)[0])

    def sight(self, request: ViewRequest) -> Sight:
        """Return the `Sight` that computes the visibility of rigs."""
        key = request.body_key, request.prior_key
        return self._keep("sight", key, lambda: self._sight(request))

    def checker(
        self, request: ViewRequest
    ) -> tuple[requirements.RequirementChecker, Mapping[str, str]]:
        """Return what holds rigs to the requirements, and why others cannot be placed, by name."""
        key = request.requirements_key, request.body_key, request.reference, request.prior_key
        return self._keep("checker", key, lambda: _checker(request))

    def evaluator(
        self, request: ViewRequest, sample: Hashable, make: Callable[[], pe.RigEvaluator]
    ) -> pe.RigEvaluator:
        """Return what scores rigs on a sample."""
        return self._keep("evaluators", (request.body_key, request.prior_key, sample), make)

    def surfaces(self, request: ViewRequest) -> dict[Any, Any]:
        """Return the surfaces of mounts of the vehicle that are known, to be added to."""
        return self._keep("surfaces", request.body_key, dict)

    def met_before(
        self, request: ViewRequest, verdicts: Sequence[requirements.Verdict]
    ) -> Mapping[str, bool]:
        """Return whether each requirement was met before the last move; note what is met now."""
        key = request.requirements_key
        before, now = self._met.get(key, ({}, {}))
        if request.moving:
            return now
        found = {verdict.name: verdict.met for verdict in verdicts}
        if found != now:
            before = now
            now = found
        self._met = {key: (before, now)}
        return before

    def compared(self, key: Hashable, make: Callable[[], GroundSight]) -> GroundSight:
        """Return the ground map that a difference map compares with."""
        return self._keep("compared", key, make)

    def fitted(
        self, key: Hashable, fit: Callable[[], tuple[float, float]], *, anew: bool, scored: bool
    ) -> tuple[float, float]:
        """Return the cached range of colours; with `anew`, a newly fitted one. The range that was
        first needed once there was a score is kept: later scores are then shown in the same
        colours."""
        if scored:
            return self._keep("scale", key, fit)
        if anew:
            self._kept.pop("fitted", None)
        return self._keep("fitted", key, fit)

    def _sight(self, request: ViewRequest) -> Sight:
        body = self.body(request)
        targets = request.targets
        assert request.space is not None and request.prior is not None  # no key without them
        return Sight(request.space, request.prior, body, model=request.model, targets=targets)

    def _keep(self, sort: str, key: Hashable, make: Callable[[], T]) -> T:
        """Return the cached value of a key, or make it; the least recently used one is dropped."""
        most = MAX_KEPT.get(sort, 1)
        found: T = self._kept.setdefault(sort, text.RecentCache(most)).made(key, make)
        return found


def _checker(request: ViewRequest) -> tuple[requirements.RequirementChecker, dict[str, str]]:
    rig = pe.Rig([each.sensor for each in request.counted])
    placed, unplaced = requirements.checkable(
        request.requirements, rig, request.vehicle, request.reference, space=request.space
    )
    return engine_calls.checker(
        placed, request.vehicle, request.model, request.reference, space=request.space
    ), unplaced
