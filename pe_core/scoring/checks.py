"""What all evaluators check before they begin."""

from typing import Any

from ..base.errors import require_kind
from ..geometry.grids import PerceptionSpace
from ..prior.prior import Prior
from ..scene.vehicle import Vehicle


def require_scene(source: str, space: Any, prior: Any, vehicle: Any) -> None:
    """Raise `InputError` unless these are a space, a prior, and a vehicle or None."""
    require_kind(source, "space", space, PerceptionSpace)
    require_kind(source, "prior", prior, Prior)
    if vehicle is not None:
        require_kind(source, "vehicle", vehicle, Vehicle)
