"""The page of a Pareto front: its designs plotted against each other, and a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

from pe_core.search.goals import HIGHER_IS_BETTER, OBJECTIVES

from .document import html_file
from .markup import capitalized, render
from .pictures.charts import four_digits, pareto_plot

DesignRow = Mapping[str, Any]
BELOW = "; the figures are in the table below"


def front_page(data: Mapping[str, Any]) -> bytes:
    """Return the page of a front: of its objectives, or of price and entropy."""
    names = [*data.get("objectives", ("price", "entropy"))]
    designs = [d for d in data["designs"] if all(_figure(d, name) is not None for name in names)]
    front = [design for design in designs if design["on_front"]]
    others = [design for design in designs if not design["on_front"]]
    columns = [*names, *_shared_figures(names, front)]
    values = {name: [_figure(design, name) or 0.0 for design in front] for name in columns}
    best = {name: (max if name in HIGHER_IS_BETTER else min)(values[name]) for name in columns}
    labels = {name: _axis_label(name, str(data.get("currency") or "")) for name in columns}
    with_requirements = any("requirements_met" in design for design in front)
    heads = ["design", *(labels[name].split(",")[0] for name in columns)]
    titles = [capitalized(OBJECTIVES[name][0]) for name in names]
    body = render(
        "front.html",
        labels=titles,
        front=front,
        stopped=data["stopped"],
        notes=data.get("notes", ()),
        plots=[
            pareto_plot(
                [(_figure(d, x) or 0.0, _figure(d, y) or 0.0) for d in front],
                [(_figure(d, x) or 0.0, _figure(d, y) or 0.0) for d in others],
                (labels[x], labels[y]),
                f"{OBJECTIVES[x][0]} against {OBJECTIVES[y][0]}{BELOW}",
            )
            for x, y in combinations(names, 2)
        ],
        heads=[*heads, *["requirements met"] * with_requirements],
        figures=[
            [(four_digits(values[n][k]), values[n][k] == best[n]) for n in columns]
            for k in range(len(front))
        ],
        with_requirements=with_requirements,
    )
    return html_file(f"Pareto front: {', '.join(titles)}", body)


def _shared_figures(names: Sequence[str], front: Sequence[DesignRow]) -> list[str]:
    """Return the figures of all designs that are no objective of the front."""
    figures = [design.get("figures", {}) for design in front]
    shared = set(figures[0]).intersection(*figures) if figures else set()
    return [name for name in OBJECTIVES if name in shared and name not in names]


def _figure(design: DesignRow, name: str) -> float | None:
    value = design.get("figures", design).get(name)
    return None if value is None else float(value)


def _axis_label(name: str, currency: str) -> str:
    label, unit = OBJECTIVES[name]
    unit = unit or (currency if name == "price" else "")
    better = "higher is better" if name in HIGHER_IS_BETTER else "lower is better"
    return f"{label} [{unit}], {better}" if unit else f"{label}, {better}"
