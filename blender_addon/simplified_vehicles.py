"""Vehicles of fewer triangles for previews: made once, shared by all threads that draw or score.

Simplifying takes seconds for millions of triangles. A thread that asks meanwhile waits. One of
still fewer triangles is made from the one that is there.
"""

from __future__ import annotations

import threading

from .engine import graphics, pe

MAX_VEHICLES = 1
"""Vehicles that are kept: two of millions of triangles need not fit in memory."""


class SimplifiedVehicles:
    """Simplified vehicles by the original, and by the number of triangles that was wanted."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._made: list[tuple[pe.Vehicle, dict[int, tuple[pe.Vehicle, float]]]] = []

    def simplified(self, vehicle: pe.Vehicle, triangles: int) -> tuple[pe.Vehicle, float]:
        """Return a vehicle of at most so many triangles, and how far its surface moved [m].

        Parameters
        ----------
        vehicle : Vehicle
            The cache compares objects: pass the same one for the same vehicle.
        triangles : int

        Returns
        -------
        vehicle : Vehicle
            The same one where it has no more triangles.
        error_m : float
            No point of either surface is farther from the other one than this [m].
        """
        if len(vehicle.triangles) <= triangles:
            return vehicle, 0.0
        with self._lock:
            made = self._made_of(vehicle)
            if triangles not in made:
                larger = [size for size in made if size > triangles]
                base, moved = made[min(larger)] if larger else (vehicle, 0.0)
                simplified, error = graphics.simplified(base, triangles, quick=True)
                made[triangles] = simplified, moved + error
            return made[triangles]

    def clear(self) -> None:
        """Drop everything: another file is opened."""
        self._made = []  # work in progress keeps its own: do not wait for it

    def _made_of(self, vehicle: pe.Vehicle) -> dict[int, tuple[pe.Vehicle, float]]:
        found = next((made for of, made in self._made if of is vehicle), None)
        if found is None:
            found = {}
            self._made = [*self._made, (vehicle, found)][-MAX_VEHICLES:]
        return found


shared = SimplifiedVehicles()
"""The one cache of the add-on."""
