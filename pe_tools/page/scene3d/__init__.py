"""The interactive 3-D view: vehicle, sensors, their fields of view, and ground maps.

Python writes the geometry (of the engine's `graphics`) as plain data; the scripts in this folder
render it with three.js, which is vendored: the page loads nothing from elsewhere.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import sensors as kinds

from ... import graphics
from ..markup import escaped, percent
from ..pictures.sensor_views import sensor_view
from ..report_context import ReportContext, Section
from .packed_data import css_color, housing_data, maps_data, packed_primitives, vehicle_data

HERE = Path(__file__).parent
THREE = HERE / "_vendor" / "three.min.js"
SCRIPTS = (
    *("decode", "lines", "areas", "body", "ground", "sensors", "labels", "viewpoints"),
    *("user_input", "panel", "print", "view"),
)
"""The view's scripts, concatenated to one program in this order."""
VIEWS = {
    "quarter": "Reset",
    "above": "Above",
    "front": "Front",
    "rear": "Rear",
    "left": "Left",
    "right": "Right",
}
LAYERS = {"fov": "View", "occluded": "Occluded", "ground": "Ground"}
"""Layers of a sensor by key, with the heading of their column."""
LAYER_TEXT = {
    "fov": "field of view",
    "occluded": "occluded by the vehicle",
    "ground": "footprint on the ground",
}
TEXTS = {
    "look_from": "Look from {name}",
    "from": "From {name}",
    "from_middle": "From {name}, the middle of its view",
}
"""Texts of the view's program; {name} is a sensor's name."""
INITIAL_LAYERS = {"fov", "occluded"}
LABEL = (
    "3-D view of the vehicle and its sensors. Arrow keys turn it, plus and minus change the "
    "distance, 0 resets it."
)
NO_WEBGL = (
    "This browser has no WebGL, which the 3-D view needs. The vehicle with its sensors is in the "
    '<a href="#summary">picture at the top</a>.'
)

__all__ = ["scene_data", "view3d"]


def view3d(context: ReportContext) -> Section:
    """Return the section with the 3-D view."""
    data = scene_data(context)
    html = view_html(data) + _simplified_note(data)
    css = (HERE / "scene3d.css").read_text("utf-8")
    return Section("view", "3-D view", html, data, _scripts(), (css,))


def scene_data(context: ReportContext) -> dict[str, Any]:
    """Return everything that the view shows of a study, as plain data."""
    scores = context.after.per_sensor
    colors = graphics.sensor_colors_on_paper(context.rig)
    return {
        "vehicle": vehicle_data(context.vehicle, context.display_vehicle),
        "sensors": [
            sensor_data(sensor, colors[sensor.name], scores.get(sensor.name), context.vehicle)
            for sensor in context.rig
        ],
        "maps": maps_data(context.sight, context.rig),
        "texts": TEXTS,
    }


@cache
def _scripts() -> tuple[str, ...]:
    """Return three.js, and the view's own program."""
    scripts = "\n".join((HERE / f"{name}.js").read_text("utf-8") for name in SCRIPTS)
    program = f'(() => {{\n"use strict";\nconst T = PE_THREE;\n\n{scripts}\n}})();'
    return THREE.read_text("utf-8"), program


def _simplified_note(data: dict[str, Any]) -> str:
    """Return a note on the simplification of the vehicle; empty if it is complete."""
    vehicle = data["vehicle"]
    if vehicle is None or vehicle["shown"] == vehicle["all"]:
        return ""
    error_mm = max(1000.0 * vehicle["error"], 0.1)
    return (
        f'<p class="note">The vehicle is drawn with {vehicle["shown"]:,} of its '
        f"{vehicle['all']:,} triangles; its surface deviates by at most {error_mm:.1f} mm. Rays "
        "were cast at all triangles.</p>"
    )


def view_html(data: Mapping[str, Any]) -> str:
    """Return the HTML of the view, and a note that the script replaces if WebGL works."""
    return (
        f'<p class="v3-still note">{NO_WEBGL}</p>'
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
        f'<button type="button" data-view="{name}">{text}</button>' for name, text in VIEWS.items()
    )
    body = (
        '<label class="v3-check"><input type="checkbox" data-body>See through the body</label>'
        if data["vehicle"]
        else ""
    )
    return (
        f'<h3>View</h3><div class="v3-views">{views}</div>'
        f"<h3>Sensors</h3>{_table(data['sensors'])}{body}"
        f"<h3>Ground map</h3>{_maps(data['maps'])}{_key(data)}"
    )


def _table(sensors: Sequence[Mapping[str, Any]]) -> str:
    heads = "".join(f'<th scope="col">{text}</th>' for text in LAYERS.values())
    rows = "".join(_row(number, sensor) for number, sensor in enumerate(sensors))
    all_of = "".join(
        f"<td>{_box(f'all: {LAYER_TEXT[layer]}', layer, f'data-all={layer}')}</td>"
        for layer in LAYERS
    )
    all_row = f'<tr><th scope="row">All</th>{all_of}</tr>' if len(sensors) > 1 else ""
    return (
        '<table class="v3-table"><caption class="hidden">Layers of each sensor</caption>'
        f'<thead><tr><th scope="col">Look from</th>{heads}</tr></thead>'
        f"<tbody>{all_row}{rows}</tbody></table>"
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
    target = f'data-sensor="{number}" data-layer="{layer}"'
    label = f"{sensor['name']}: {LAYER_TEXT[layer]}"
    box = _box(label, layer, target) if sensor["layers"].get(layer) else ""
    return box + (_share(sensor["share"]) if layer == "occluded" else "")


def _box(label: str, layer: str, target: str) -> str:
    checked = " checked" if layer in INITIAL_LAYERS else ""
    return (
        f'<label><input type="checkbox" {target}{checked} autocomplete="off" '
        f'aria-label="{escaped(label)}"></label>'
    )


def _share(share: float | None) -> str:
    if share is None:
        return ""
    text = "none" if share == 0.0 else "< 0.1%" if share < 0.001 else percent(share, 1)
    return f"<small>{escaped(text)}</small>"


def _maps(maps: Sequence[Mapping[str, Any]]) -> str:
    options = "".join(f'<option value="{m["name"]}">{m["label"]}</option>' for m in maps)
    return (
        '<select data-map autocomplete="off" aria-label="Map on the ground">'
        f'<option value="">none</option>{options}</select>'
    )


def _key(data: Mapping[str, Any]) -> str:
    """Return the key of the lines."""
    first = data["sensors"][0]["color"]
    occluded = css_color(graphics.PAPER.stopped)
    rows = (
        f'<li><i style="--tint:{first}"></i>in a sensor\'s colour: its field of view</li>'
        f'<li><i class="dashed" style="--tint:{occluded}"></i>occluded by the vehicle</li>'
    )
    return f'<ul class="v3-key">{rows}<li>Grid of 1 m, darker every 5 m.</li></ul>'


MAX_BEAMS = 60_000
"""Beams that are cast of one sensor; a selection of them is drawn."""
BEAMS_EACH, BEAM_M, VIEW_M, FOOT_M = 180, 7.0, 2.5, 20.0
"""Beams drawn of a sensor and their length; length of a field of view; reach of its footprint."""
MAX_RINGS = 10
PALETTE = graphics.PAPER
OCCLUDED = graphics.with_alpha(PALETTE.stopped, 0.9)
BEAM, RING, EDGE, SIDE = 0.5, 0.8, 0.9, 0.12
"""Opacity of a sensor's colour in beams, rings, and edges and sides of its field of view."""
NOTHING = graphics.Primitives.empty()


def sensor_data(
    sensor: pe.Sensor, color: graphics.Rgb, score: Any, vehicle: pe.Vehicle | None
) -> dict[str, Any]:
    """Return a sensor in its colour; `score` is its `SensorScore` or None."""
    drawing = graphics.drawing_of(sensor.kind)
    layers = _beam_layers if drawing.beams else _view_layers
    field = sensor_view(sensor.kind).image_field(sensor.model)
    return {
        "name": sensor.name,
        "kind": kinds.kind_of(sensor.model).label,
        "model": sensor.model.name,
        "color": css_color(graphics.with_alpha(color, 1.0)),
        "at": list(sensor.pose.position),
        "turned": list(sensor.pose.rotation_deg),
        "axes": sensor.pose.ground_from_sensor.tolist(),
        "field": None if field is None else list(field),
        "drawn_as": "beams" if drawing.beams else "view",
        "share": score.occluded / score.beams if score and score.beams else None,
        "housing": housing_data(sensor.model.name),
        "layers": layers(sensor, vehicle, color),
    }


def _beam_layers(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, color: tuple[float, ...]
) -> dict[str, Any]:
    """Return free beams, occluded beams, and rings where channels meet the ground."""
    beams_cast = graphics.cast(sensor, vehicle, MAX_BEAMS)
    choice = graphics.BeamChoice(BEAMS_EACH, graphics.ChannelMode.FEW)
    beams = graphics.shown_beams(beams_cast, choice)
    colors = np.where(beams.stopped[:, None], OCCLUDED, graphics.with_alpha(color, BEAM))
    around = None if vehicle is None else vehicle.bounds
    rows = _rings(beams_cast)
    ring_colors = np.tile(graphics.with_alpha(color, RING), (len(rows), 1))
    rings = graphics.ground_rings(beams_cast, rows, ring_colors)
    return {
        "fov": _layer(graphics.free_lines(sensor, beams, BEAM_M, colors, around)),
        "occluded": _layer(graphics.stopped_lines(sensor, beams, colors)),
        "ground": _layer(rings),
    }


def _view_layers(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, color: tuple[float, ...]
) -> dict[str, Any]:
    """Return the field of view, what the vehicle occludes of it, and its footprint."""
    drawing = graphics.drawing_of(sensor.kind)
    sketch = drawing.sketch(sensor, vehicle, graphics.BeamChoice(1))
    edge, side = graphics.with_alpha(color, EDGE), graphics.with_alpha(color, SIDE)
    palette = replace(PALETTE, camera=edge, camera_face=side, other=edge)
    layers = {"fov": _layer(sketch.lines(VIEW_M, palette), sketch.faces(VIEW_M, palette))}
    if drawing.footprint is None:
        return layers
    outline = drawing.footprint(sensor, FOOT_M)
    around = graphics.footprint_lines(outline, edge)
    layers["occluded"] = _layer(graphics.hidden_lines(sensor, vehicle, OCCLUDED))
    layers["ground"] = _layer(around, graphics.footprint_faces(outline, side))
    return layers


def _rings(beams: graphics.Cast) -> np.ndarray:
    """Return an even selection of the channels that meet the ground near enough to be drawn."""
    near = graphics.ground_distance(beams.sensor, beams.directions) < graphics.RING_FAR_M
    meets = near.reshape(len(beams.rows), -1).any(axis=1)
    rows = beams.rows[meets]
    return rows[np.unique(np.linspace(0, len(rows) - 1, min(MAX_RINGS, len(rows))).astype(int))]


def _layer(lines: graphics.Primitives, faces: graphics.Primitives = NOTHING) -> dict[str, Any]:
    return {
        **({"lines": packed_primitives(lines)} if len(lines.points) else {}),
        **({"faces": packed_primitives(faces)} if len(faces.points) else {}),
    }
