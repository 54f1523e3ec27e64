"""Outputs that packages beside the engine write, as they take a library."""

from __future__ import annotations

from ..exchange import Written
from ..exchange.elsewhere import brought_function
from .footprints import ground_plan
from .request import OutputRequest

DXF, RECORDING = "footprints.dxf", "scene.rrd"


def write_dxf(wanted: OutputRequest) -> tuple[Written, list[str]]:
    """Return the plan from above as DXF, and lines on what is not in it."""
    dxf_bytes = brought_function("dxf", "DXF")
    plan, lines = ground_plan(wanted)
    return {DXF: dxf_bytes(plan)}, lines


def write_recording(wanted: OutputRequest) -> tuple[Written, list[str]]:
    """Return the scene as a recording of Rerun's, and lines on what is not in it."""
    data, lines = brought_function("rerun", "Rerun")(wanted)
    return {RECORDING: data}, lines
