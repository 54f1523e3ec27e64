"""Signals of changes, from what is set to what draws or scores it; neither knows the other.

Blender's own message bus tells nothing of properties inside a group, and nothing of what a script
sets: so each property emits a signal itself, by its update callback.
"""

from collections.abc import Callable

Listener = Callable[[], None]


class Signal:
    """An event that can be emitted; its listeners are called in the order of their connection."""

    def __init__(self) -> None:
        self.listeners: tuple[Listener, ...] = ()

    def connect(self, listener: Listener) -> None:
        """Call a function at each emit; once, however often it is connected."""
        if listener not in self.listeners:
            self.listeners += (listener,)

    def disconnect(self, listener: Listener) -> None:
        """Call a function no longer; do nothing if it is not connected."""
        self.listeners = tuple(each for each in self.listeners if each != listener)

    def emit(self) -> None:
        """Call all listeners."""
        for listener in self.listeners:
            listener()


study_changed = Signal()
"""Something changed that the score depends on: sensors, vehicle, prior, focus."""
view_changed = Signal()  # Something changed that only the 3D view and the panels show

moving = Signal()
"""A sensor or the vehicle is moving: emitted by a timer, a moment after each move."""
idle = Signal()  # Nothing has moved for a moment: emitted once after the last move

live_toggled = Signal()  # The live score was switched on or off
live_score_changed = Signal()
"""A scene has a new live score, or a new note why there is none."""
