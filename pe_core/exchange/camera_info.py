"""ROS camera intrinsics, camera_info/NAME.yaml: a file a camera, beside its rig's transforms.

Brown and Conrady's distortion is plumb_bob, or rational_polynomial with its denominator; Kannala
and Brandt's is equidistant.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import InputError, shown
from ..kinds.camera import BrownConrady, KannalaBrandt, Lens, Pinhole
from ..text.tables import Table
from ..text.values import numbers
from ..text.yaml_blocks import parse_yaml_blocks
from .carried import CAMERA, CarriedSensor
from .figures import PIXELS
from .files import plain_number, text_of
from .pictures import Picture

FOLDER = "camera_info"
PLUMB_BOB, RATIONAL, EQUIDISTANT = "plumb_bob", "rational_polynomial", "equidistant"
FEWEST = {PLUMB_BOB: (4, 5), RATIONAL: (8,), EQUIDISTANT: (4,)}
"""How many coefficients a model has; further ones may be there if they are 0."""
LENSES: dict[str, type[Lens]] = {
    PLUMB_BOB: BrownConrady,
    RATIONAL: BrownConrady,
    EQUIDISTANT: KannalaBrandt,
    "fisheye": KannalaBrandt,
}
IN_BRACKETS = re.compile(r"\[[^\[\]]*\]")


def info_name(camera: str) -> str:
    """Return the name of a camera's file, from the folder of its rig."""
    return f"{FOLDER}/{camera}.yaml"


def info_files(sensors: Iterable[CarriedSensor]) -> dict[str, bytes]:
    """Return the files of a rig's cameras, by name; pictures are such as OpenCV knows."""
    return {
        info_name(each.name): _text(each.name, each.picture, each.picture.size).encode()
        for each in sensors
        if each.picture is not None and each.picture.size is not None
    }


def _text(name: str, picture: Picture, size: tuple[int, int]) -> str:
    model, coefficients = _distortion(picture.lens)
    k = [value for row in picture.matrix for value in row]
    p = [value for row in picture.matrix for value in (*row, 0.0)]
    unturned = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    lines = [f"image_width: {size[0]}", f"image_height: {size[1]}", f"camera_name: {name}"]
    lines += _matrix("camera_matrix", 3, k)
    lines += [f"distortion_model: {model}"]
    lines += _matrix("distortion_coefficients", 1, coefficients)
    lines += _matrix("rectification_matrix", 3, unturned) + _matrix("projection_matrix", 3, p)
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


def with_info(folder: Path, sensors: Iterable[CarriedSensor]) -> tuple[CarriedSensor, ...]:
    """Return sensors with the pictures that stand beside their rig; such a sensor is a camera."""
    return tuple(_with(folder / info_name(each.name), each) for each in sensors)


def _with(path: Path, each: CarriedSensor) -> CarriedSensor:
    if not path.is_file():
        return each
    return replace(each, kind=CAMERA, picture=read_info(path))


def read_info(path: Path) -> Picture:
    """Return the picture of a camera's file.

    Raises
    ------
    InputError
        When a number is missing, or the model of the distortion is none of those above.
    """
    return picture_of_info(str(path), text_of(path))


def picture_of_info(source: str, text: str) -> Picture:
    """Return the picture of a camera's text, as `read_info` does of its file."""
    lists = IN_BRACKETS.sub(_on_one_line, text)
    top = Table(parse_yaml_blocks(source, lists, lists=True), source)
    size = _pixels(top, "image_width"), _pixels(top, "image_height")
    k = _data(top, "camera_matrix", (9,))
    model = top.text("distortion_model", PLUMB_BOB)
    if model not in LENSES:
        raise top.error("distortion_model", f"one of {', '.join(LENSES)}", shown(model))
    values = _data(top, "distortion_coefficients", FEWEST.get(model, (4,)))
    place = k[0], k[4], k[2], k[5]
    if not any(values) and LENSES[model] is BrownConrady:
        return Picture(Pinhole(*place), size)
    return Picture(LENSES[model](*place, None, *values), size)


def _on_one_line(found: re.Match[str]) -> str:
    """A list that goes over lines on its first one, the others left empty: lines keep numbers."""
    return " ".join(found[0].split()) + "\n" * found[0].count("\n")


def _pixels(top: Table, key: str) -> int:
    return top.whole(key, rule=PIXELS)


def _data(top: Table, key: str, lengths: Sequence[int]) -> list[float]:
    table = top.table(key)
    value: Any = table.raw("data")
    found = numbers(value) if isinstance(value, list) else None
    plain = [] if found is None else [float(v) for v in found.ravel()]
    plain = plain if all(map(math.isfinite, plain)) else []
    if len(plain) not in lengths and (len(plain) < max(lengths) or any(plain[max(lengths) :])):
        expected = f"{' or '.join(map(str, lengths))} numbers"
        raise InputError(table.source, table.field("data"), expected, shown(value))
    return plain[: max(lengths)]
