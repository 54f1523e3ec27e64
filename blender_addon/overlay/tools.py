"""What layers work with and share: casts, a simpler body, what rigs see. One thread's own."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

from .. import simple_bodies
from ..engine import graphics, pe, sight
from .wish import PictureWish, SceneSensor

T = TypeVar("T")

KEPT = {"casts": 24, "compared": 2}
"""Things of a sort that are kept, else one: those asked for last."""
MOST_TRIANGLES = 50_000
"""A body of more is simplified for what is drawn: a picture shows no more."""


class Tools:
    """Keeps what is dear to make, by plain keys; never used by two threads at once."""

    def __init__(self) -> None:
        self._kept: dict[str, dict[Hashable, Any]] = {}

    def cast(self, wish: PictureWish, of: SceneSensor) -> graphics.Cast:
        """Return where the beams of a LiDAR end; a few of them while something moves."""
        most = graphics.A_DRAFT if wish.moving else graphics.MOST
        key = of.key, wish.body_key, most
        return self._keep("casts", key, lambda: graphics.cast(of.sensor, self.body(wish), most))

    def body(self, wish: PictureWish) -> pe.Vehicle | None:
        """Return the vehicle, simplified where it has very many triangles."""
        vehicle = wish.vehicle
        return (
            None if vehicle is None else simple_bodies.shared.simplified(vehicle, MOST_TRIANGLES)[0]
        )

    def sight(self, wish: PictureWish) -> sight.Sight:
        """Return what tells what rigs see."""
        key = wish.body_key, wish.prior_key
        return self._keep("sight", key, lambda: self._sight(wish))

    def compared(self, key: Hashable, make: Callable[[], sight.GroundSight]) -> sight.GroundSight:
        """Return the ground as the sensors see it that a difference map compares with."""
        return self._keep("compared", key, make)

    def fitted(
        self, key: Hashable, fit: Callable[[], tuple[float, float]], *, anew: bool
    ) -> tuple[float, float]:
        """Return the range of colours that was fitted last, unless a new one is wanted."""
        if anew:
            self._kept.get("fitted", {}).pop(key, None)
        return self._keep("fitted", key, fit)

    def _sight(self, wish: PictureWish) -> sight.Sight:
        body, targets = self.body(wish), wish.targets
        return sight.Sight(wish.space, wish.prior, body, model=wish.model, targets=targets)

    def _keep(self, sort: str, key: Hashable, make: Callable[[], T]) -> T:
        """Return what is kept under a key, or make it; the one asked for last goes last."""
        kept = self._kept.setdefault(sort, {})
        found = kept.pop(key, None)
        kept[key] = make() if found is None else found
        while len(kept) > KEPT.get(sort, 1):
            del kept[next(iter(kept))]
        return kept[key]
