"""The page's sections, in its order: a row each."""

from __future__ import annotations

from collections.abc import Callable

from ..reviewed import Reviewed
from ..scene3d import view3d
from ..section import Section
from .again import again
from .failing import failing
from .head import head
from .maps import maps
from .objects import objects
from .parts import parts
from .search import searching
from .sensors import sensors
from .told import told
from .versus import versus

TOGETHER: tuple[Callable[[tuple[Reviewed, ...]], Section], ...] = (head, versus)
"""What is told of all studies at once, above them; of a single one, too."""
SECTIONS: tuple[Callable[[Reviewed], Section], ...] = (
    *(view3d, maps, parts, objects, sensors, failing, searching, told, again),
)
"""What every study has; of several they stand side by side. One whose html is empty is left out."""

__all__ = ["SECTIONS", "TOGETHER"]
