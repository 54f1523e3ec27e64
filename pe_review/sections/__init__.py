"""The page's sections, in its order: a row each."""

from __future__ import annotations

from collections.abc import Callable

from ..reviewed import Reviewed
from ..section import Section
from .head import head

SECTIONS: tuple[Callable[[Reviewed], Section], ...] = ()
"""What every study has; of several they stand side by side. One whose html is empty is left out."""
TOGETHER: tuple[Callable[[tuple[Reviewed, ...]], Section], ...] = (head,)
"""What is told of all studies at once, above them; of a single one, too."""

__all__ = ["SECTIONS", "TOGETHER"]
