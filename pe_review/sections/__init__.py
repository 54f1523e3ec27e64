"""The page's sections, in its order: a row each."""

from __future__ import annotations

from collections.abc import Callable

from ..reviewed import Reviewed
from ..scene3d import view3d
from ..section import Section
from .again import again
from .basis import basis
from .bill import bill
from .failing import failing
from .head import head
from .maps import maps
from .objects import objects
from .parts import parts
from .plan import plan
from .search import searching
from .sensors import sensors
from .told import told
from .versus import versus

TOGETHER: tuple[Callable[[tuple[Reviewed, ...]], Section], ...] = (head, versus, bill)
"""What is told of all studies at once, above them; of a single one, too."""
SECTIONS: tuple[Callable[[Reviewed], Section], ...] = (
    *(view3d, plan, maps, parts, objects, sensors, failing, searching, told, again),
)
"""What every study has; of several they stand side by side. One whose html is empty is left out."""

LAST: tuple[Callable[[tuple[Reviewed, ...]], Section], ...] = (basis,)
"""What is told of all studies at once, below them."""

__all__ = ["LAST", "SECTIONS", "TOGETHER"]
