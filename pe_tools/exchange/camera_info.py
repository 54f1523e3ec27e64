"""Camera intrinsics of ROS: one file camera_info/NAME.yaml per camera, beside the file of the rig.
ROS calls the Brown-Conrady distortion plumb_bob, or rational_polynomial if it has a denominator. It
calls the Kannala-Brandt distortion equidistant."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.table_reader import Table
from pe_core.base.values import numbers
from pe_core.sensors.camera import BrownConrady, KannalaBrandt, Lens, Pinhole
from pe_tools.formats.yaml_text import parse_yaml

from . import foreign_values as values
from .lens_pictures import Picture
from .portable import PortableRig, PortableSensor
from .portable_kinds import CAMERA, camera_of

FOLDER = "camera_info"
PLUMB_BOB = "plumb_bob"
RATIONAL = "rational_polynomial"
EQUIDISTANT = "equidistant"
FEWEST = {PLUMB_BOB: (4, 5), RATIONAL: (8,), EQUIDISTANT: (4,)}
"""Allowed numbers of coefficients by distortion model. Further coefficients must be 0."""
LENSES: dict[str, type[Lens]] = {
    PLUMB_BOB: BrownConrady,
    RATIONAL: BrownConrady,
    EQUIDISTANT: KannalaBrandt,
    "fisheye": KannalaBrandt,
}


def info_name(camera: str) -> str:
    """Return the path of a camera's file, relative to the folder of the rig."""
    return f"{FOLDER}/{camera}.yaml"


def info_files(sensors: Iterable[PortableSensor]) -> dict[str, str]:
    """Return the texts of the camera_info files of a rig by name; lenses are models of OpenCV."""
    return {
        info_name(sensor.name): _text(sensor.name, sensor.picture, sensor.picture.size)
        for sensor in sensors
        if sensor.picture is not None and sensor.picture.size is not None
    }


def _text(name: str, picture: Picture, size: tuple[int, int]) -> str:
    lens = picture.lens
    width, height = size
    model = EQUIDISTANT
    bent = [float(getattr(lens, key)) for key in lens.coefficients]
    if not isinstance(lens, KannalaBrandt):
        model = RATIONAL if any(bent[5:]) else PLUMB_BOB
        bent = bent if model == RATIONAL else (bent or [0.0] * 5)[:5]
    k = [value for row in picture.matrix for value in row]
    p = [value for row in picture.matrix for value in (*row, 0.0)]
    identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    lines = [f"image_width: {width}", f"image_height: {height}", f"camera_name: {name}"]
    lines += _matrix("camera_matrix", 3, k)
    lines += [f"distortion_model: {model}"]
    lines += _matrix("distortion_coefficients", 1, bent)
    lines += _matrix("rectification_matrix", 3, identity) + _matrix("projection_matrix", 3, p)
    return "\n".join(lines) + "\n"


def _matrix(key: str, rows: int, data: Sequence[float]) -> list[str]:
    texts = ", ".join(map(values.plain_number, data))
    cols = len(data) // rows
    return [f"{key}:", f"  rows: {rows}", f"  cols: {cols}", f"  data: [{texts}]"]


def with_info(folder: Path, sensors: Iterable[PortableSensor]) -> PortableRig:
    """Return sensors with the intrinsics in `folder`; a sensor with intrinsics is a camera."""
    result = []
    for sensor in sensors:
        path = folder / info_name(sensor.name)
        if path.is_file():
            picture, note = read_info(str(path), values.text_of(path))
            told = "; ".join(filter(None, [sensor.told, note]))
            sensor = replace(sensor, kind=CAMERA, picture=picture, told=told)
        result.append(sensor)
    return tuple(result)


def read_info(source: str, text: str) -> tuple[Picture | None, str]:
    """Return the intrinsics in the text of a camera_info file, and a message (may be empty). If the
    file is damaged, or its lens is not known or is that of no camera, they are None and the message
    says why."""
    try:
        picture = picture_of_info(source, text)
        camera_of(source, picture)
        return picture, ""
    except InputError as error:
        return None, f"its lens is left out: {error.at(f'{FOLDER}/{Path(source).name}')}"


def picture_of_info(source: str, text: str) -> Picture:
    """Return the intrinsics in the text of a camera_info file. A number that is missing, or a
    distortion model that is none of `LENSES`, raises `InputError`."""
    top = Table(parse_yaml(source, text), source)
    size = (
        top.whole("image_width", rule=values.PIXELS),
        top.whole("image_height", rule=values.PIXELS),
    )
    k = _data(top.at("camera_matrix", {}), (9,))
    model = top.text("distortion_model", PLUMB_BOB)
    if model not in LENSES:
        raise top.error(one_of(LENSES, model), shown(model), "distortion_model")
    bent = _data(top.at("distortion_coefficients", {}), FEWEST.get(model, (4,)))
    fx = k[0]
    fy = k[4]
    cx = k[2]
    cy = k[5]
    if not any(bent) and LENSES[model] is BrownConrady:
        return Picture(Pinhole(fx, fy, cx, cy), size)
    lens = LENSES[model]
    bends = dict(zip(lens.coefficients, bent, strict=False))
    return Picture(lens(fx, fy, cx, cy, **bends), size)


def _data(table: Table, lengths: Sequence[int]) -> list[float]:
    """Return the finite numbers of a matrix; beyond the greatest length there may be zeros."""
    value = table.raw("data")
    most = max(lengths)
    found = numbers(value) if isinstance(value, list) else None
    data = [] if found is None or not np.isfinite(found).all() else found.ravel().tolist()
    if len(data) not in lengths and (len(data) < most or any(data[most:])):
        expected = f"{' or '.join(map(str, lengths))} numbers"
        raise InputError(table.source, table.field("data"), expected, shown(value))
    return data[:most]
