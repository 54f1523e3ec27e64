"""The page of a Pareto front: its designs plotted against each other (SVG), and a table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pe_core.search.goals import HIGHER_IS_BETTER, OBJECTIVES

from .. import jobs
from .document import HERE, STYLES, policy
from .markup import MINUS, Markup, capitalized, escaped, table

SIZE, LEFT, RIGHT, TOP, BOTTOM = 330, 62, 14, 12, 44
MAX_TICKS = 4
"""Steps of an axis at most."""
STYLE = """
.fronts { display: grid; grid-template-columns: repeat(auto-fill, minmax(18rem, 1fr)); gap: 1rem; }
.fronts figure { margin: 0; }
.fronts svg { width: 100%; height: auto; }
.fronts text { font-size: 12px; fill: var(--soft); }
.fronts .label { fill: var(--ink); }
.fronts .number { fill: var(--paper); font-weight: 650; font-size: 11px; }
.fronts circle { fill: var(--accent); }
.fronts .beaten { fill: var(--paper); stroke: var(--was); }
.fronts line { stroke: var(--line); }
.best { font-weight: 650; color: var(--accent); }
"""
DesignRow = Mapping[str, Any]
ToPixel = Callable[[float], float]


def write_front_page(data: Mapping[str, Any], folder: Path) -> None:
    """Write the page beside a front.

    Parameters
    ----------
    data : mapping
        Content of front.json.
    folder : path

    Raises
    ------
    InputError
        When the folder has such a file that this program did not write.
    """
    with jobs.FileSet(folder) as files:
        files.add(jobs.FRONT_PAGE, front_page(data).encode("utf-8"))


def front_page(data: Mapping[str, Any]) -> str:
    """Return the page of a front: of its objectives, or of price and entropy."""
    names = [*data.get("objectives", ("price", "entropy"))]
    designs = [design for design in data["designs"] if _has_figures(design, names)]
    front = [design for design in designs if design["on_front"]]
    others = [design for design in designs if not design["on_front"]]
    sheets = [f"\n{(HERE / name).read_text('utf-8')}\n" for name in STYLES] + [f"\n{STYLE}\n"]
    labels = [capitalized(OBJECTIVES[name][0]) for name in names]
    title = f"Pareto front: {', '.join(labels)}"
    currency = str(data.get("currency") or "")
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy(sheets, [])}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escaped(title)}</title>",
            *(f"<style>{sheet}</style>" for sheet in sheets),
            '</head>\n<body class="single">',
            f'<header class="masthead"><p class="kicker">Pareto front</p>'
            f"<h1>{escaped(', '.join(labels))}</h1></header>",
            '<main id="page"><section>',
            f"<p>{_lead(data, front)}</p>",
            *(f"<p>{escaped(note)}</p>" for note in data.get("notes", ())),
            f'<div class="fronts">{"".join(_plots(names, front, others, currency))}</div>',
            "</section><section><h2>The designs</h2>",
            _table([*names, *_beside(names, front)], front, currency),
            _placements(front),
            "</section></main></body>\n</html>\n",
        ]
    )


def _beside(names: Sequence[str], front: Sequence[DesignRow]) -> list[str]:
    """Return the figures of all designs that are no objective of the front."""
    figures = [design.get("figures", {}) for design in front]
    shared = set(figures[0]).intersection(*figures) if figures else set()
    return [name for name in OBJECTIVES if name in shared and name not in names]


def _has_figures(design: DesignRow, names: Sequence[str]) -> bool:
    return all(_figure(design, name) is not None for name in names)


def _figure(design: DesignRow, name: str) -> float | None:
    value = design.get("figures", design).get(name)
    return None if value is None else float(value)


def _lead(data: Mapping[str, Any], front: Sequence[DesignRow]) -> str:
    count = len(front)
    stopped = " It was stopped early." if data["stopped"] else ""
    return (
        f"{count} designs are on the front: no other design is better in one objective without "
        f"being worse in another. Numbers in the plots are those of the rows in the table.{stopped}"
    )


def _axis_label(name: str, currency: str) -> str:
    label, unit = OBJECTIVES[name]
    unit = unit or (currency if name == "price" else "")
    better = "higher is better" if name in HIGHER_IS_BETTER else "lower is better"
    return f"{label} [{unit}], {better}" if unit else f"{label}, {better}"


def _plots(
    names: Sequence[str], front: Sequence[DesignRow], others: Sequence[DesignRow], currency: str
) -> Iterator[str]:
    """Yield a plot of each pair of objectives."""
    for k, x in enumerate(names):
        for y in names[k + 1 :]:
            yield _plot(x, y, front, others, currency)


def _plot(
    x: str, y: str, front: Sequence[DesignRow], others: Sequence[DesignRow], currency: str
) -> str:
    points = [(_figure(d, x) or 0.0, _figure(d, y) or 0.0) for d in (*others, *front)]
    x_ticks, y_ticks = (round_ticks([p[k] for p in points]) for k in (0, 1))

    def to_x(value: float) -> float:
        share = (value - x_ticks[0]) / (x_ticks[-1] - x_ticks[0])
        return LEFT + share * (SIZE - LEFT - RIGHT)

    def to_y(value: float) -> float:
        share = (value - y_ticks[0]) / (y_ticks[-1] - y_ticks[0])
        return SIZE - BOTTOM - share * (SIZE - TOP - BOTTOM)

    inside = []
    for tick in x_ticks:
        at, text = to_x(tick), shown(tick)
        inside.append(f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{TOP}" y2="{SIZE - BOTTOM}"/>')
        inside.append(
            f'<text x="{at:.1f}" y="{SIZE - BOTTOM + 16}" text-anchor="middle">{text}</text>'
        )
    for tick in y_ticks:
        at, text = to_y(tick), shown(tick)
        inside.append(f'<line x1="{LEFT}" x2="{SIZE - RIGHT}" y1="{at:.1f}" y2="{at:.1f}"/>')
        inside.append(f'<text x="{LEFT - 6}" y="{at + 4:.1f}" text-anchor="end">{text}</text>')
    for a, b in points[: len(others)]:
        inside.append(f'<circle class="beaten" cx="{to_x(a):.1f}" cy="{to_y(b):.1f}" r="4"/>')
    for number, (a, b) in enumerate(points[len(others) :], 1):
        cx, cy = to_x(a), to_y(b)
        inside.append(f'<circle cx="{cx:.1f}" cy="{cy:.1f}" r="9"/>')
        inside.append(
            f'<text class="number" x="{cx:.1f}" y="{cy + 4:.1f}" text-anchor="middle">'
            f"{number}</text>"
        )
    label = _axis_label(x, currency)
    inside.append(
        f'<text class="label" x="{(LEFT + SIZE - RIGHT) / 2:.0f}" y="{SIZE - 8}" '
        f'text-anchor="middle">{escaped(label)}</text>'
    )
    middle = (TOP + SIZE - BOTTOM) / 2
    inside.append(
        f'<text class="label" x="14" y="{middle:.0f}" text-anchor="middle" '
        f'transform="rotate(-90 14 {middle:.0f})">{escaped(_axis_label(y, currency))}</text>'
    )
    alt = f"{OBJECTIVES[x][0]} against {OBJECTIVES[y][0]}; the figures are in the table below"
    return (
        f'<figure role="img" aria-label="{escaped(alt)}"><svg viewBox="0 0 {SIZE} {SIZE}" '
        f'xmlns="http://www.w3.org/2000/svg" aria-hidden="true">{"".join(inside)}</svg></figure>'
    )


def round_ticks(values: Sequence[float]) -> list[float]:
    """Return a few round numbers, the first below all values and the last above."""
    low, high = min(values), max(values)
    width = (high - low) or max(abs(high), 1.0) * 0.1
    unit = 10.0**-12
    while True:
        for step in (unit, 2.0 * unit, 5.0 * unit):
            if width / step <= MAX_TICKS:
                first = int(low // step) - (low % step == 0.0)
                last = first
                while last * step <= high:
                    last += 1
                return [k * step for k in range(first, last + 1)]
        unit *= 10.0


def shown(value: float) -> str:
    """Return a figure of the axis or the table with four digits."""
    text = f"{value:,.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    return ("0" if float(text.replace(",", "")) == 0.0 else text).replace("-", MINUS)


def _table(names: Sequence[str], front: Sequence[DesignRow], currency: str) -> str:
    heads = ["design", *(_axis_label(name, currency).split(",")[0] for name in names)]
    asked = any("requirements_met" in design for design in front)
    best = {
        name: (max if name in HIGHER_IS_BETTER else min)(_figure(d, name) or 0.0 for d in front)
        for name in names
    }
    rows: list[list[object]] = []
    for design in front:
        cells: list[object] = [f"{len(rows) + 1}. {design['name']}"]
        for name in names:
            value = _figure(design, name) or 0.0
            css = "best" if value == best[name] else ""
            cells.append(Markup(f'<span class="{css}">{escaped(shown(value))}</span>'))
        rows.append([*cells, *([design.get("requirements_met", "")] if asked else [])])
    title = "Designs of the front; the best value of each objective is marked"
    return table(title, [*heads, *(["requirements met"] if asked else [])], rows)


def _placements(front: Sequence[DesignRow]) -> str:
    """Return a table of the sensors' poses, by design."""
    rows: list[list[object]] = []
    for design in front:
        rows.append([str(design["name"])])
        for name, pose in design["placements"].items():
            at, turn = ([f"{v:.2f}" for v in pose[key]] for key in ("position", "rotation"))
            rows.append([name, ", ".join(at), ", ".join(turn)])
    heads = ("sensor", "x, y, z [m]", "roll, pitch, yaw [deg]")
    inside = table("Where the sensors are", heads, rows)
    return f"<details><summary>Where the sensors are</summary>{inside}</details>"
