"""The best placement so far of the searches that run, by scene: views show it as ghosts."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..engine import pe

searches: "dict[str, tuple[pe.Sensor, ...]]" = {}
"""Sensors of the best placement by the scene's name; none while that is the start."""


def best(scene: str) -> "tuple[pe.Sensor, ...]":
    """Return the sensors of the best placement of a scene's search; none without one."""
    return searches.get(scene, ())
