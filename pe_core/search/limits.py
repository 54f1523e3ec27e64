"""Limits: what is good enough, by figure. The dashboard, `pe check`, searches and fronts read them.

A limit that is kept holds in a search. What can be built, and what a rig sees, is then a
constraint: a placement beyond it is infeasible. A limit on what the search improves ends it when it
is reached.
"""

from dataclasses import make_dataclass
from typing import TYPE_CHECKING, Any

from ..base.setting import setting
from .figures import AP, ENTROPY, FIGURES, REQUIREMENTS
from .limit import FigureLimits, Limit, LimitRule

NUMBERED = frozenset({ENTROPY, AP})
"""Figures that a search does not keep as they are at its start: it improves them."""
LIMITED = tuple(key for key, row in FIGURES.items() if row.rule is not None or key == REQUIREMENTS)
"""Figures that may have a limit."""


def _field(key: str) -> tuple[str, Any, Any]:
    row = FIGURES[key]
    about = f"{row.about}: at {'least' if row.higher else 'most'}"
    return key, Limit | None, setting(None, LimitRule(row.rule, key in NUMBERED), about)


if TYPE_CHECKING:

    class Limits(FigureLimits):
        """Limits by the names of `FIGURES`."""

        def __init__(self, **limits: Any) -> None: ...

else:
    Limits = make_dataclass(
        "Limits",
        map(_field, LIMITED),
        bases=(FigureLimits,),
        namespace={"__module__": __name__, "__doc__": FigureLimits.__doc__},
        frozen=True,
        slots=True,
    )
