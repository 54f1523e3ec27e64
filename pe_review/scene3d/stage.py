"""The view's place on the page, and the switches beside it, as HTML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..engine import graphics
from ..markup import escaped
from .packing import css

VIEWS = {
    "quarter": "Reset",
    "above": "Above",
    "front": "Front",
    "rear": "Rear",
    "left": "Left",
    "right": "Right",
}
LAYERS = {"sees": "Field", "stopped": "Stopped", "ground": "Ground"}
TOLD = {"sees": "what it sees", "stopped": "what the vehicle stops", "ground": "its ground"}
AT_FIRST = {"sees", "stopped"}
LABEL = (
    "3-D view of the vehicle and its sensors. Arrow keys turn it, plus and minus change the "
    "distance, 0 resets it."
)
NO_WEBGL = "This browser shows no 3-D view (WebGL is missing or switched off): a still picture."
FEW_PERCENT = 0.001


def stage(data: Mapping[str, Any], still: str) -> str:
    """Return the place of the view: a still picture, replaced where a browser can do better."""
    return (
        f'<div class="v3-still">{still}<p class="note">{NO_WEBGL}</p></div>'
        '<div class="v3-live" hidden>'
        f'<div class="v3-stage" tabindex="0" role="group" aria-label="{LABEL}">'
        '<canvas class="v3-canvas"></canvas><div class="v3-labels"></div>'
        '<p class="v3-caption" hidden><span></span>'
        '<button type="button" data-view="quarter">Back</button></p>'
        '<p class="v3-hint">Tap to turn</p><div class="v3-legend" hidden></div></div>'
        f'<div class="v3-panel">{_panel(data)}</div></div>'
        '<canvas class="v3-paper" aria-hidden="true" width="1" height="1"></canvas>'
        '<div class="v3-paper-words" aria-hidden="true"></div>'
    )


def _panel(data: Mapping[str, Any]) -> str:
    views = "".join(
        f'<button type="button" data-view="{name}">{words}</button>'
        for name, words in VIEWS.items()
    )
    body = (
        '<label class="v3-check"><input type="checkbox" data-body>See through the body</label>'
        if data["vehicle"]
        else ""
    )
    return (
        f'<h3>View</h3><div class="v3-views">{views}</div>'
        f"<h3>Sensors</h3>{_table(data['sensors'])}{body}"
        f"<h3>On the ground</h3>{_maps(data['maps'])}{_key(data)}"
    )


def _table(sensors: Sequence[Mapping[str, Any]]) -> str:
    heads = "".join(f'<th scope="col">{words}</th>' for words in LAYERS.values())
    rows = "".join(_row(number, sensor) for number, sensor in enumerate(sensors))
    all_of = "".join(
        f"<td>{_box(f'all: {TOLD[layer]}', layer, f'data-all={layer}')}</td>" for layer in LAYERS
    )
    every = f'<tr><th scope="row">All</th>{all_of}</tr>' if len(sensors) > 1 else ""
    return (
        '<table class="v3-table"><caption class="hidden">What is shown of each sensor</caption>'
        f'<thead><tr><th scope="col">Look from</th>{heads}</tr></thead>'
        f"<tbody>{every}{rows}</tbody></table>"
    )


def _row(number: int, sensor: Mapping[str, Any]) -> str:
    name = escaped(sensor["name"])
    look = (
        f'<button type="button" data-look="{number}" style="--tint:{sensor["color"]}">'
        f"<i></i><span>{name}</span></button>"
    )
    cells = "".join(f"<td>{_cell(number, sensor, layer)}</td>" for layer in LAYERS)
    return f'<tr><th scope="row">{look}</th>{cells}</tr>'


def _cell(number: int, sensor: Mapping[str, Any], layer: str) -> str:
    own = f'data-sensor="{number}" data-layer="{layer}"'
    there = bool(sensor["layers"].get(layer))
    box = _box(f"{sensor['name']}: {TOLD[layer]}", layer, own) if there else ""
    return box + (_share(sensor["share"]) if layer == "stopped" else "")


def _box(label: str, layer: str, own: str) -> str:
    checked = " checked" if layer in AT_FIRST else ""
    return (
        f'<label><input type="checkbox" {own}{checked} autocomplete="off" '
        f'aria-label="{escaped(label)}"></label>'
    )


def _share(share: float | None) -> str:
    if share is None:
        return ""
    text = "none" if share == 0.0 else "< 0.1 %" if share < FEW_PERCENT else f"{share:.1%}"
    return f"<small>{escaped(text.replace('%', ' %').replace('  ', ' '))}</small>"


def _maps(maps: Sequence[Mapping[str, Any]]) -> str:
    options = "".join(f'<option value="{m["name"]}">{m["label"]}</option>' for m in maps)
    return (
        '<select data-map autocomplete="off" aria-label="Map on the ground">'
        f'<option value="">No map</option>{options}</select>'
    )


def _key(data: Mapping[str, Any]) -> str:
    """What the lines are."""
    first = data["sensors"][0]["color"]
    stopped = css(graphics.PAPER.stopped)
    rows = (
        f'<li><i style="--tint:{first}"></i>in a sensor\'s colour: what it sees</li>'
        f'<li><i class="dashed" style="--tint:{stopped}"></i>stopped by the vehicle</li>'
    )
    return f'<ul class="v3-key">{rows}<li>Grid of 1 m, darker every 5 m.</li></ul>'
