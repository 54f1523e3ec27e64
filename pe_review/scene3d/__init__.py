"""The 3-D view: vehicle, sensors, what they see and what stops them, to be turned by the reader.

Python packs what is drawn (the engine's `graphics`) into plain data; the scripts beside it show it
with three.js, which is vendored. The page asks nobody for anything.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from ..markup import escaped, picture
from ..pictures.of_reviewed import named_still_of
from ..reviewed import Reviewed
from ..section import Section
from .body import vehicle_data
from .ground import maps_data
from .sensors import sensor_data
from .stage import stage

HERE = Path(__file__).parent
THREE = HERE / "_vendor" / "three.min.js"
SCRIPTS = (
    *("decode", "lines", "areas", "body", "ground", "sensors", "labels", "camera"),
    *("hands", "panel", "paper", "view"),
)
"""One after another they are one program."""

__all__ = ["scene_data", "view3d"]


def view3d(one: Reviewed) -> Section:
    """Return the section."""
    data = scene_data(one)
    html = stage(data, _still(one)) + _left_out(data)
    css = (HERE / "scene3d.css").read_text("utf-8")
    return Section("view", "In three dimensions", html, data, _scripts(), (css,))


def scene_data(one: Reviewed) -> dict[str, Any]:
    """Return all that is drawn of a study, as plain data."""
    scores = one.after.per_sensor
    return {
        "vehicle": vehicle_data(one.vehicle, one.shown_vehicle),
        "sensors": [
            sensor_data(number, sensor, scores.get(sensor.name), one.vehicle)
            for number, sensor in enumerate(one.rig)
        ],
        "maps": maps_data(one.sight, one.rig),
    }


@cache
def _scripts() -> tuple[str, ...]:
    """three.js, and the view's own program."""
    own = "\n".join((HERE / f"{name}.js").read_text("utf-8") for name in SCRIPTS)
    program = f'(() => {{\n"use strict";\nconst T = PE_THREE;\n\n{own}\n}})();'
    return THREE.read_text("utf-8"), program


def _still(one: Reviewed) -> str:
    """The picture for a browser that cannot turn the view."""
    names = ", ".join(sensor.name for sensor in one.rig)
    alt = f"The vehicle with its sensors: {names}"
    return named_still_of(one, alt) if one.picture is None else picture(one.picture, alt)


def _left_out(data: dict[str, Any]) -> str:
    """What is to be said of a vehicle that the page draws with fewer triangles."""
    vehicle = data["vehicle"]
    if vehicle is None or vehicle["shown"] == vehicle["all"]:
        return ""
    return (
        f'<p class="note">The vehicle is drawn with {vehicle["shown"]:,} of its '
        f"{vehicle['all']:,} triangles, nowhere more than {escaped(_millimetres(vehicle['error']))}"
        " off; beams were cast at all of them.</p>"
    )


def _millimetres(metres: float) -> str:
    return f"{max(1000.0 * metres, 0.1):.1f} mm"
