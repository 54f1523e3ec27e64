"""What a figure of a rig is: its name, its unit, which way is better, how it reads."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from ..base.values import Number, Whole, rounded

if TYPE_CHECKING:
    from .rig_view import RigView

REQUIREMENTS = "requirements"
NO_FIGURE = "-"
LOWER = "lower is better"
HIGHER = "higher is better"


def reciprocal(value: float) -> float:
    """Return a positive cost that falls as a value rises."""
    return 1.0 / (1.0 + max(value, 0.0))


class KnownFigures(Protocol):
    """What is known of a rig: its figures by name, and how far ahead each class is found."""

    @property
    def values(self) -> Mapping[str, float]:
        """The figures that are known, by the names of `FIGURES`."""

    @property
    def reach(self) -> Mapping[str, tuple[float, bool]]:
        """By class how far ahead it is found [m], and whether the space ends there."""


def never(_figures: KnownFigures) -> bool:
    """Return False: the space ends none of the figures."""
    return False


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure that a rig is decided by.

    Parameters
    ----------
    about : str
        The meaning, in a sentence without the last full stop.
    decimals : int
        Of its text.
    higher : bool
        Whether a higher value is better. Of several values the worst one counts.
    of : callable, optional
        Gives its values for a `RigView`. None: a search cannot trade it off against others.
    cost : callable, optional
        Gives a positive cost of a value, lower is better; by default the value itself, or its
        `reciprocal`.
    rule : Number or Whole, optional
        Of what may be wanted; None: nothing may be.
    shown : callable
        Rounds a value to the safe side.
    is_cut : callable
        Whether the space ends there: the true figure may be better.
    least : float
        The smallest difference that counts.
    scale : float
        A value is told multiplied by this: 100 for percent.
    is_seen : bool
        Whether a rig's sight tells it, and not its score, its verdicts or its build.
    needs : str
        What a study has that has the figure.
    short : str
        Its label where there is little room; empty: the same.
    """

    key: str
    label: str
    unit: str
    about: str
    decimals: int = 2
    higher: bool = False
    of: Callable[[RigView], Sequence[float]] | None = None
    cost: Callable[[float], float] | None = None
    rule: Number | Whole | None = None
    shown: Callable[[float], float] = float
    is_cut: Callable[[KnownFigures], bool] = never
    least: float = 0.05
    scale: float = 1.0
    is_seen: bool = True
    needs: str = ""
    short: str = ""

    @property
    def name(self) -> str:
        """Its label within a sentence."""
        return (
            self.label if self.label.startswith("AP") else self.label[:1].lower() + self.label[1:]
        )

    @property
    def better(self) -> str:
        """Which way is better, in words."""
        return HIGHER if self.higher else LOWER

    @property
    def title(self) -> str:
        """Label and unit: "Blind ground [m2]"."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    @property
    def heading(self) -> str:
        """Title and meaning: "Blind ground [m2], lower is better"."""
        return f"{self.title}, {self.better}"

    def values(self, view: RigView) -> Sequence[float]:
        """Return its values for a rig; none where it is not known."""
        return () if self.of is None else self.of(view)

    def worst(self, values: Sequence[float]) -> float | None:
        """Return the value that counts; None where there is none."""
        return (min if self.higher else max)(values) if values else None

    def best(self, values: Sequence[float]) -> float:
        """Return the best of some values."""
        return (max if self.higher else min)(values)

    def value(self, figures: KnownFigures | None) -> float | None:
        """Return the figure of a rig; None where it is not known."""
        return None if figures is None else figures.values.get(self.key)

    def signed(self, value: float) -> float:
        """Return a value of which a lower one is better: it, or minus it."""
        return -value if self.higher else value

    def costs(self, view: RigView) -> tuple[float, ...]:
        """Return its values as costs, lower is better; a figure that is not known is the worst."""
        return tuple(self.cost_of(value) for value in self.values(view) or (0.0,))

    def cost_of(self, value: float) -> float:
        """Return the cost of a value."""
        if self.cost is not None:
            return rounded(self.cost(value))
        return rounded(reciprocal(value) if self.higher else float(value))

    def is_met(self, value: float, wanted: float) -> bool:
        """Whether a value is as wanted, or better."""
        return self.cost_of(value) <= self.cost_of(wanted)

    def begin(self, value: float) -> float:
        """Return a round number that a value meets: what is wanted begins with it."""
        scale = 10 ** min(self.decimals, 2)
        round_off = math.floor if self.higher else math.ceil
        return (
            round_off(value * scale) / scale if isinstance(self.rule, Number) else math.ceil(value)
        )

    def told(self, value: float) -> float:
        """Return a value as it is told: on the safe side, in the unit, with its decimals."""
        return round(self.scale * self.shown(value), self.decimals) + 0.0  # no -0.0

    def text(self, value: float | None, is_cut: bool = False) -> str:
        """Return a value with its unit: what is blind is rounded up, a reach down."""
        if value is None:
            return NO_FIGURE
        return f"{self.number(value)} {self.unit}".strip() + " and more" * is_cut

    def number(self, value: float) -> str:
        """Return a value as `text` has it, without its unit."""
        return f"{self.told(value):,.{self.decimals}f}"
