"""The vehicle of fewer triangles that 3D views draw: made once, shared by all threads that draw.

Simplifying takes seconds for millions of triangles. A thread that asks meanwhile waits.
"""

from __future__ import annotations

import threading

from .engine import graphics, pe

MAX_TRIANGLES = 50_000
"""A vehicle of more is simplified for drawing: a picture shows no more detail."""


class SimplifiedVehicles:
    """The last vehicle that was simplified: two of millions of triangles need not fit in memory."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._made: tuple[pe.Vehicle, pe.Vehicle] | None = None

    def simplified(self, vehicle: pe.Vehicle) -> pe.Vehicle:
        """Return a vehicle of at most `MAX_TRIANGLES`; the same one where it has no more.

        The cache compares objects: pass the same one for the same vehicle.
        """
        if len(vehicle.triangles) <= MAX_TRIANGLES:
            return vehicle
        with self._lock:
            made = self._made
            if made is None or made[0] is not vehicle:
                made = vehicle, graphics.simplified(vehicle, MAX_TRIANGLES, quick=True)[0]
                self._made = made
            return made[1]

    def clear(self) -> None:
        """Drop the vehicle: another file is opened."""
        self._made = None  # work in progress keeps its own: do not wait for it


shared = SimplifiedVehicles()
"""The one cache of the add-on."""
