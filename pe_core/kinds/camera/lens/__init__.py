"""Lenses: how a camera's picture is projected, a module a model."""

from .brown_conrady import BrownConrady
from .f_theta import FTheta
from .kannala_brandt import KannalaBrandt
from .lens import Lens
from .pinhole import Pinhole

LENSES: dict[str, type[Lens]] = {
    each.model: each for each in (Pinhole, BrownConrady, KannalaBrandt, FTheta)
}
"""By the name that studies have."""

__all__ = ["LENSES", "BrownConrady", "FTheta", "KannalaBrandt", "Lens", "Pinhole"]
