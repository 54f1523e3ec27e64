"""ROS camera intrinsics: one file camera_info/NAME.yaml per camera, beside the transforms.

ROS calls the Brown-Conrady distortion plumb_bob, or rational_polynomial if it has a denominator.
It calls the Kannala-Brandt distortion equidistant.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.table_reader import Table
from pe_core.base.values import numbers
from pe_core.sensors.camera import BrownConrady, KannalaBrandt, Lens, Pinhole
from pe_tools.exchange.yaml_text import parse_yaml_blocks

from .foreign_values import PIXELS, plain_number, text_of
from .lens_pictures import Picture
from .portable import PortableSensor
from .portable_kinds import CAMERA

FOLDER = "camera_info"
PLUMB_BOB, RATIONAL, EQUIDISTANT = "plumb_bob", "rational_polynomial", "equidistant"
FEWEST = {PLUMB_BOB: (4, 5), RATIONAL: (8,), EQUIDISTANT: (4,)}
"""Allowed numbers of coefficients by distortion model. Further coefficients must be 0."""
LENSES: dict[str, type[Lens]] = {
    PLUMB_BOB: BrownConrady,
    RATIONAL: BrownConrady,
    EQUIDISTANT: KannalaBrandt,
    "fisheye": KannalaBrandt,
}
IN_BRACKETS = re.compile(r"\[[^\[\]]*\]")


def info_name(camera: str) -> str:
    """Return the path of a camera's file, relative to the folder of the rig."""
    return f"{FOLDER}/{camera}.yaml"


def info_files(sensors: Iterable[PortableSensor]) -> dict[str, bytes]:
    """Return the camera_info files of a rig by name. Lenses must be models of OpenCV."""
    return {
        info_name(sensor.name): _text(sensor.name, sensor.picture, sensor.picture.size).encode()
        for sensor in sensors
        if sensor.picture is not None and sensor.picture.size is not None
    }


def _text(name: str, picture: Picture, size: tuple[int, int]) -> str:
    model, coefficients = _distortion(picture.lens)
    k = [value for row in picture.matrix for value in row]
    p = [value for row in picture.matrix for value in (*row, 0.0)]
    identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    lines = [f"image_width: {size[0]}", f"image_height: {size[1]}", f"camera_name: {name}"]
    lines += _matrix("camera_matrix", 3, k)
    lines += [f"distortion_model: {model}"]
    lines += _matrix("distortion_coefficients", 1, coefficients)
    lines += _matrix("rectification_matrix", 3, identity) + _matrix("projection_matrix", 3, p)
    return "\n".join(lines) + "\n"


def _matrix(key: str, rows: int, values: Sequence[float]) -> list[str]:
    data = ", ".join(plain_number(value) for value in values)
    return [f"{key}:", f"  rows: {rows}", f"  cols: {len(values) // rows}", f"  data: [{data}]"]


def _distortion(lens: Lens) -> tuple[str, list[float]]:
    values = [float(getattr(lens, key)) for key in lens.coefficients]
    if isinstance(lens, KannalaBrandt):
        return EQUIDISTANT, values
    if not any(values[5:]):
        return PLUMB_BOB, (values or [0.0] * 5)[:5]
    return RATIONAL, values


def with_info(folder: Path, sensors: Iterable[PortableSensor]) -> tuple[PortableSensor, ...]:
    """Return sensors with the intrinsics in `folder`; a sensor with intrinsics is a camera."""
    return tuple(_with(folder / info_name(sensor.name), sensor) for sensor in sensors)


def _with(path: Path, sensor: PortableSensor) -> PortableSensor:
    if not path.is_file():
        return sensor
    return replace(sensor, kind=CAMERA, picture=read_info(path))


def read_info(path: Path) -> Picture:
    """Return the intrinsics in a camera_info file.

    Raises
    ------
    InputError
        When a number is missing, or the distortion model is none of `LENSES`.
    """
    return picture_of_info(str(path), text_of(path))


def picture_of_info(source: str, text: str) -> Picture:
    """Return the intrinsics in the text of a camera_info file; see `read_info`."""
    lists = IN_BRACKETS.sub(_on_one_line, text)
    top = Table(parse_yaml_blocks(source, lists, lists=True), source)
    size = _pixels(top, "image_width"), _pixels(top, "image_height")
    k = _data(top, "camera_matrix", (9,))
    model = top.text("distortion_model", PLUMB_BOB)
    if model not in LENSES:
        raise top.error("distortion_model", f"one of {', '.join(LENSES)}", shown(model))
    values = _data(top, "distortion_coefficients", FEWEST.get(model, (4,)))
    intrinsics = k[0], k[4], k[2], k[5]
    if not any(values) and LENSES[model] is BrownConrady:
        return Picture(Pinhole(*intrinsics), size)
    return Picture(LENSES[model](*intrinsics, None, *values), size)


def _on_one_line(match: re.Match[str]) -> str:
    """Join a list that spans several lines. Empty lines follow, so line numbers stay correct."""
    return " ".join(match[0].split()) + "\n" * match[0].count("\n")


def _pixels(top: Table, key: str) -> int:
    return top.whole(key, rule=PIXELS)


def _data(top: Table, key: str, lengths: Sequence[int]) -> list[float]:
    table = top.table(key)
    value: Any = table.raw("data")
    values = numbers(value) if isinstance(value, list) else None
    coefficients = [] if values is None else [float(v) for v in values.ravel()]
    coefficients = coefficients if all(map(math.isfinite, coefficients)) else []
    if len(coefficients) not in lengths and (
        len(coefficients) < max(lengths) or any(coefficients[max(lengths) :])
    ):
        expected = f"{' or '.join(map(str, lengths))} numbers"
        raise InputError(table.source, table.field("data"), expected, shown(value))
    return coefficients[: max(lengths)]
