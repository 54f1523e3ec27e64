"""Autoware's vehicle_info.param.yaml: where the axles are, in the words of its vehicle packages."""

from __future__ import annotations

from pathlib import Path

from ..scene.reference import Reference
from ..text.tables import Table
from ..text.yaml_blocks import parse_yaml_blocks
from .files import named_numbers, text_of

NODES, PARAMETERS = "/**", "ros__parameters"
KEYS = ("wheel_radius", "wheel_base", "front_overhang", "rear_overhang")


def read_vehicle_info(path: str | Path) -> Reference:
    """Return the reference of a vehicle: our origin is below the middle of its length.

    Raises
    ------
    InputError
        When the file cannot be read, or a number is missing or impossible.
    """
    path = Path(path)
    top = Table(parse_yaml_blocks(str(path), text_of(path)), str(path))
    nodes = top.table(NODES) if NODES in top else top
    radius, base, front, rear = named_numbers(nodes.table(PARAMETERS), KEYS)
    middle = (rear + base + front) / 2.0
    return Reference(rear - middle, radius, base, front, rear)
