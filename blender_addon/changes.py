"""Word of a change, from what is set to those who draw or judge it; neither knows the other.

Blender's own message bus tells nothing of properties inside a group, and nothing of what a script
sets: so each property says it itself, by its update callback.
"""

from __future__ import annotations

from collections.abc import Callable

Listener = Callable[[], None]


class Signal:
    """Something that can be told, and those who listen."""

    def __init__(self) -> None:
        self._listeners: list[Listener] = []

    def connect(self, listener: Listener) -> None:
        """Call a function whenever it is told; once, however often that is asked for."""
        if listener not in self._listeners:
            self._listeners.append(listener)

    def disconnect(self, listener: Listener) -> None:
        """Call it no more; do nothing if it was not called before."""
        if listener in self._listeners:
            self._listeners.remove(listener)

    def tell(self) -> None:
        """Call all listeners, in the order in which they came."""
        for listener in tuple(self._listeners):
            listener()

    @property
    def listeners(self) -> tuple[Listener, ...]:
        """Those who listen now."""
        return tuple(self._listeners)


study = Signal()
"""What changes the score: sensors, vehicle, prior, focus. What is drawn may change with it."""
picture = Signal()
"""What changes the picture in the 3D view alone."""

moved = Signal()
"""A sensor or the vehicle is moving: told a moment after, from a timer, as long as that lasts."""
rested = Signal()
"""What was moved rests: told once, a moment after the last move."""

live = Signal()
"""The live score was switched on or off."""
reading = Signal()
"""The live score says something new, of any scene."""
