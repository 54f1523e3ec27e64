"""Bodies of fewer triangles for previews: made once, shared by all threads that draw or score.

Making one takes seconds for millions of triangles. Who asks while one is being made waits, and a
smaller one is made of the one that is there.
"""

from __future__ import annotations

import threading

from .engine import geometry, pe

MOST_BODIES = 1
"""Bodies that are kept: two of millions of triangles need not fit in memory."""


class SimpleBodies:
    """Simplified bodies by the vehicle that they are of, and by how many triangles were wanted."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._made: list[tuple[pe.Vehicle, dict[int, tuple[pe.Vehicle, float]]]] = []

    def simplified(self, vehicle: pe.Vehicle, triangles: int) -> tuple[pe.Vehicle, float]:
        """Return a vehicle of so many triangles or fewer, and how far its surface moved [m].

        Parameters
        ----------
        vehicle : Vehicle
            The same object as long as it is the same body: it is known by that.
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
                found, error = geometry.simplified(base, triangles, quick=True)
                made[triangles] = found, moved + error
            return made[triangles]

    def clear(self) -> None:
        """Forget everything, as another file is about to be shown."""
        self._made = []  # work under way keeps its own: nobody waits for it here

    def _made_of(self, vehicle: pe.Vehicle) -> dict[int, tuple[pe.Vehicle, float]]:
        found = next((made for of, made in self._made if of is vehicle), None)
        if found is None:
            found = {}
            self._made = [*self._made, (vehicle, found)][-MOST_BODIES:]
        return found


shared = SimpleBodies()
"""The one that all parts of the add-on share."""
