"""The plot of a Pareto front: price against entropy, its designs numbered and named beside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from .style import BLUE, GREY, finished, save, style
from .words import one_line

SIZE_IN, LINE_IN, KEY_IN = (10.4, 4.4), 0.21, 0.9
"""Size of the picture; what a line of the key takes of its height, and what is round the key."""
LONGEST = 80
"""Characters of a name in the key."""
ROOM = 0.08
"""Free space round the designs, as a share of what they span."""


@style
def draw_front(path: Path, data: Mapping[str, Any]) -> None:
    """Draw a front from the data of its front.json."""
    front = [row for row in data["designs"] if row["on_front"]]
    others = [row for row in data["designs"] if not row["on_front"]]
    height = max(SIZE_IN[1], KEY_IN + LINE_IN * len(front))
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(SIZE_IN[0], height), width_ratios=(1.15, 1), layout="constrained"
    )
    _plot(left, front, others)
    unit = f" [{one_line(data['currency'])}]" if data["currency"] else ""
    left.set(xlabel=f"price{unit}", ylabel="perception entropy [nats], lower is better")
    _key(right, front)
    save(figure, path)


def _plot(axes: Axes, front: Sequence[Mapping[str, Any]], others: Sequence[Any]) -> None:
    prices, entropies = ([row[key] for row in front] for key in ("price", "entropy"))
    axes.step(prices, entropies, where="post", color=BLUE, lw=1.2, alpha=0.5, zorder=1)
    if others:
        x, y = ([row[key] for row in others] for key in ("price", "entropy"))
        axes.scatter(x, y, s=18, facecolors="white", edgecolors=GREY, lw=0.8, zorder=2)
    axes.scatter(prices, entropies, s=110, color=BLUE, zorder=3)
    for number, (price, entropy) in enumerate(zip(prices, entropies, strict=True), 1):
        axes.text(
            price,
            entropy,
            str(number),
            color="white",
            size=8.5,
            zorder=4,
            ha="center",
            va="center_baseline",
        )
    axes.margins(ROOM)
    axes.grid(color="#eeeeee", lw=0.8)
    axes.set_axisbelow(True)
    finished(axes)


def _key(axes: Axes, front: Sequence[Mapping[str, Any]]) -> None:
    """Name the designs in the order of their numbers, with what they cost."""
    axes.axis("off")
    for number, row in enumerate(front, 1):
        name = one_line(row["name"], LONGEST)
        at = 1.0 - (number - 0.5) / max(len(front), 12)
        axes.text(0.04, at, str(number), color=BLUE, weight="bold", size=8, ha="right", va="center")
        axes.text(0.07, at, name, va="center", size=8)
