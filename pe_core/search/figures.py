"""Figures: what a rig is decided by, a row a figure.

Scores, the dashboard of the panel, the live read-out, comparisons, limits, fronts and pages follow
from the rows of `FIGURES`.
"""

import copyreg
import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from functools import partial

from ..base.values import Number, Whole, shown_share
from ..scoring.sight.blind_ground import shown_end, shown_reach
from .build_figures import BUILD_FIGURES
from .figure import REQUIREMENTS as REQUIREMENTS
from .figure import Figure
from .rig_view import RigView

ENTROPY = "entropy"
COVERAGE = "coverage"
AP = "ap"
BLIND_GROUND = "blind_ground"
BLIND_SECTOR = "blind_sector"
REACH = "reach"
TRAFFIC_AP = "traffic_ap"
PRICE = "price"
WORST_LOSS = "worst_loss"
MARGIN = "margin"
BLIND_ZONES = "blind_zones"
SCENARIO_MARGIN = "scenario_margin"
AP_RINGS = {"ap_near": "near", "ap_mid": "mid", "ap_far": "far", TRAFFIC_AP: ""}
"""Figures that are expected AP in traffic, and their rings; empty: all distances."""
UNSEEN = "where no sensor sees what is"
IN_TRAFFIC = "Expected AP of objects in traffic"


def _ring(name: str) -> Callable[[RigView], Sequence[float]]:
    def values(view: RigView) -> Sequence[float]:
        found = view.traffic
        if found is None or not name:
            return [] if found is None else [found.ap]
        return [found.rings[name][0]] if name in found.rings else []

    return values


def _blind_in_zones(view: RigView) -> Sequence[float]:
    zones = [verdict.blind_m2 or 0.0 for verdict in view.verdicts]
    return [sum(zones)] if zones else []


_Ap = partial(
    Figure, unit="", higher=True, cost=lambda ap: 1.0 - ap, rule=Number(0.0, cap=1.0), least=0.0005
)
_SIGHT = (
    Figure(
        BLIND_GROUND,
        "Blind ground",
        "m2",
        f"Ground within 10 m {UNSEEN} 0.5 m tall",
        decimals=1,
        of=lambda view: (view.blind_m2,),
        rule=Number(0.0, unit="m2"),
        shown=shown_end,
        short="Ground",
    ),
    Figure(
        BLIND_SECTOR,
        "Blind sector",
        "deg",
        f"Sector at 20 m {UNSEEN} 0.5 to 1.5 m tall",
        decimals=1,
        of=lambda view: [sector.width for sector in view.sectors],
        cost=math.ceil,  # closer ones are alike
        rule=Whole(0, 360, unit="deg"),
        shown=shown_end,
        least=1.0,  # its edges are known to half a degree each
        short="Sector",
    ),
    Figure(
        REACH,
        "Reach",
        "m",
        "How far ahead each class is found (AP 0.5): the shortest",
        decimals=0,
        higher=True,
        of=lambda view: [metres for metres, _ in view.reach.values()],
        rule=Number(0.0, unit="m"),
        shown=shown_reach,
        is_cut=lambda figures: bool(figures.reach) and min(figures.reach.values())[1],
    ),
    _Ap("ap_near", "AP near", about=f"{IN_TRAFFIC} nearer than 10 m", of=_ring("near")),
    _Ap("ap_mid", "AP middle", about=f"{IN_TRAFFIC}, 10 to 40 m", of=_ring("mid"), short="AP mid"),
    _Ap("ap_far", "AP far", about=f"{IN_TRAFFIC} beyond 40 m", of=_ring("far")),
    _Ap(
        TRAFFIC_AP,
        "AP in traffic",
        about=f"{IN_TRAFFIC}, at all distances",
        of=_ring(""),
        decimals=3,
        short="AP all",
    ),
)
_Scored = partial(Figure, is_seen=False)
_SCORE = (
    _Scored(
        REQUIREMENTS,
        "Requirements",
        "met",
        "Requirements that are met",
        decimals=0,
        higher=True,
        short="Verdicts",
    ),
    _Scored(
        ENTROPY,
        "Entropy",
        "nats",
        "Perception entropy",
        decimals=3,
        of=lambda view: view.entropy,
        rule=Number(-99.0, cap=1e6),
        least=0.005,  # 0.2 % of a detector's standard deviation
    ),
    _Ap(
        AP,
        "Expected AP",
        about="Expected AP of the scored objects",
        decimals=3,
        of=lambda view: view.ap,
        is_seen=False,
        needs='metric.targets = "objects", or objective = "expected_ap"',
    ),
    _Scored(
        COVERAGE,
        "Coverage",
        "%",
        "Share of where objects are that is seen",
        decimals=1,
        higher=True,
        shown=shown_share,
        least=0.0005,
        scale=100.0,
    ),
    _Scored(
        SCENARIO_MARGIN,
        "Margin of scenarios",
        "s",
        "Time left when what moves is confirmed; none: never confirmed",
        decimals=1,
        higher=True,
    ),
    _Scored(
        WORST_LOSS,
        "Worst loss",
        "nats",
        "Rise of entropy without the best sensor",
        decimals=3,
        of=lambda view: view.losses,
        needs="a rig of at least two sensors",
    ),
    _Scored(
        MARGIN,
        "Worst margin",
        "m",
        "Smallest margin of all requirements",
        higher=True,
        of=lambda view: [verdict.counted_margin for verdict in view.verdicts],
        needs=REQUIREMENTS,
    ),
    _Scored(
        BLIND_ZONES,
        "Blind in zones",
        "m2",
        "Blind ground in the zones of requirements",
        of=_blind_in_zones,
        needs=REQUIREMENTS,
    ),
)
FIGURES: dict[str, Figure] = {row.key: row for row in (*_SIGHT, *_SCORE)} | BUILD_FIGURES
"""What a rig is decided by, by name."""


def figure_of(name: str, currency: str = "") -> Figure:
    """Return the row of a figure, of a price with its currency; of a function from Python, one with
    its name."""
    if name in FIGURES:
        row = FIGURES[name]
        return replace(row, unit=currency) if name == PRICE else row
    label = name.replace("_", " ")
    return _Scored(name, f"{label[:1].upper()}{label[1:]}", "", label)


def _as_name(row: Figure) -> tuple[Callable[..., Figure], tuple[str, ...]]:
    """Return how a process gets the row of another one: by its name, as functions are no data."""
    return figure_of, (row.key, row.unit) if row.key == PRICE else (row.key,)


copyreg.pickle(Figure, _as_name)


def on_dashboard() -> list[Figure]:
    """Return what every rig is decided by: what it sees, verdicts, and the entropy last."""
    seen = [row for row in FIGURES.values() if row.is_seen]
    return [*seen, FIGURES[REQUIREMENTS], FIGURES[ENTROPY]]


class FigureNames(Collection[str]):
    """The names of those rows of `FIGURES` that pass a test, in their order."""

    def __init__(self, test: Callable[[Figure], bool]) -> None:
        self._test = test

    def __iter__(self) -> Iterator[str]:
        return (key for key, row in FIGURES.items() if self._test(row))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, name: object) -> bool:
        return any(name == key for key in self)


SHOWN = FigureNames(
    lambda row: row.is_seen or row.key in BUILD_FIGURES or row.key in (REQUIREMENTS, ENTROPY)
)
"""Figures that a score can show, and computes where it does."""
KEPT = FigureNames(lambda row: row.is_seen)
"""Figures that a search may keep."""
ON_FRONT = FigureNames(lambda row: row.of is not None or row.key in BUILD_FIGURES)
"""Figures that a search can trade off."""
