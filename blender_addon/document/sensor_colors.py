"""Colours of a scene's sensors: each new sensor gets a tint of its kind, and keeps it."""

from collections.abc import Sequence

from bpy.types import Object, Scene

from ..engine import catalog, graphics
from .apply_variant import inactive_sensors
from .mirroring import is_copy
from .result import rename_figures
from .rig import color_of


def assign_colors(scene: Scene, sensors: Sequence[Object]) -> None:
    """Give each sensor without a colour, and each copy of another, a tint that no other has.

    A renamed sensor keeps its colour, and its figures in the last result. One whose model is of
    another kind now gets a tint of that kind, unless its colour was chosen by hand. Sensors of an
    asset library have none.
    """
    everyone = [*sensors, *inactive_sensors(scene).values()]
    for obj in sensors:
        settings = obj.perception_entropy
        entry = catalog.entries().get(settings.model)
        if entry is None or obj.asset_data is not None:
            continue
        own = None if is_copy(settings.color_of, obj, sensors) else color_of(obj)
        if own is None or graphics.is_foreign_tint(entry.kind, own):
            taken = (color_of(other) for other in everyone if other != obj)
            settings.color = graphics.rgb_of(graphics.free_tint(entry.kind, filter(None, taken)))
        elif settings.color_of != obj.name:
            rename_figures(scene, settings.color_of, obj.name)
            settings.color_of = obj.name
