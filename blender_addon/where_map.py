"""The places of one more sensor that were scored last in each scene, for the view and the click.

They are kept here and not in a property: they are not part of the user's work.
"""

from . import signals
from .engine import jobs

maps: dict[str, jobs.PlaceMap] = {}
"""By the scene's name."""


def store(scene_name: str, found: jobs.PlaceMap | None) -> None:
    """Store places, and have them shown; None discards those that are there."""
    if found is not None:
        maps[scene_name] = found
    elif maps.pop(scene_name, None) is None:
        return
    signals.view_changed.emit()


def clear(*_: object) -> None:
    """Discard all places: another file is opened, whose scenes may have the same names."""
    maps.clear()
