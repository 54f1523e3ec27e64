"""NVIDIA DriveWorks' rig.json. Angles are in degrees. The origin is the middle of the rear axle,
projected to the ground."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.errors import InputError, shown
from pe_core.base.setting import OneOf
from pe_core.base.table_reader import Table, dump_json
from pe_core.base.values import FINITE, Number, vector
from pe_core.geometry.poses import METRES, Pose
from pe_core.sensors.camera import BrownConrady, FTheta, Pinhole

from . import foreign_values as values
from .foreign_values import Export, ForeignNumbers, json_of, json_rows, plain_number, pose_from
from .frames import composed, shifted
from .lens_pictures import Picture
from .merging import merge_rows
from .portable import ORIGIN, ForeignRig, MergeTarget, PortableRig, PortableSensor
from .portable_kinds import CAMERA, LIDAR

FILE = "rig.json"
POSE_KEY = "nominalSensor2Rig_FLU"
ROTATION_KEY = "roll-pitch-yaw"
POSITION_KEY = "t"
TURN_CORRECTION = "correction_sensor_R_FLU"
SHIFT_CORRECTION = "correction_rig_T"
PROTOCOLS = {CAMERA: "camera.gmsl", LIDAR: "lidar.virtual"}
"""Protocols to write, by kind. When reading, the word before the dot is the kind."""
UNKNOWN = ("", "virtual")  # Protocols from which the kind of a sensor does not follow
FIGURES = ("properties", "parameter")
PINHOLE = "pinhole"
F_THETA = "ftheta"
FOCAL_KEYS = ("fx", "fy")
MIDDLE = ("cx", "cy")
SIZE = ("width", "height")
DISTORTION = "distortion"
RADIAL = ("k1", "k2", "k3")
POLYNOMIALS = ("polynomial", "bw-poly")
FORWARD = "angle-to-pixeldistance"
BACKWARD = "pixeldistance-to-angle"
MAX_POWER = 6  # Maximum number of coefficients of a polynomial, the constant included
PLACES = 2000  # Number of radii at which the inverse of a polynomial is fitted
NOTICED_PX = 0.1
TURNED = "its polynomial from pixels to angles is turned round to within {:.1f} px"
GENTLEST = 1e-9  # Minimum linear coefficient [rad/px or px/rad]; a smaller one describes no lens
GENTLE = 1.0
"""A polynomial without a stated direction maps pixels to angles if its slope is below this."""


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return the rig file, and messages on sensor kinds that DriveWorks does not have."""
    document: Any = {"rig": {"sensors": []}, "version": 2}
    if into is not None:
        document = into.document
    rows = document["rig"]["sensors"]
    merge_rows(rows, sensors, into, _row, pose_keys=(POSE_KEY,), figure_keys=FIGURES)
    for sensor in sensors:
        if sensor.entry is not None and not sensor.is_unmoved:  # its pose includes the corrections
            for key in (TURN_CORRECTION, SHIFT_CORRECTION):
                sensor.entry.pop(key, None)
    lines = [f"{s.name}: DriveWorks has no {s.kind}" for s in sensors if s.kind not in PROTOCOLS]
    return {FILE: dump_json(document).encode()}, lines


def _row(sensor: PortableSensor) -> dict[str, Any]:
    properties = {} if sensor.picture is None else write_properties(sensor.picture)
    return {
        "name": sensor.name,
        "protocol": PROTOCOLS.get(sensor.kind or "", "virtual"),
        "parameter": f"model={sensor.model}",
        POSE_KEY: {
            ROTATION_KEY: list(sensor.pose.rotation_deg),
            POSITION_KEY: list(sensor.pose.position),
        },
        "properties": properties,
    }


def read(path: Path) -> ForeignRig:
    """Read the sensors of a rig, one of which has a pose. A sensor without a pose (CAN, GPS) takes
    its kind from its protocol."""
    document = json_of(path)
    rig = Table(document, str(path)).at("rig", {})
    rows = json_rows(path, rig.raw("sensors"), "rig.sensors")
    if not any(POSE_KEY in row for row in rows):
        raise InputError(path, "rig.sensors", f"sensors with {POSE_KEY}", "none")
    return ForeignRig(tuple(_sensor(path, row) for row in rows), document=document)


def _corrected(path: Path, row: Table, nominal: Pose) -> Pose:
    """Return a nominal pose with the corrections of the calibration applied. The rotation is in the
    sensor's axes, the translation in the rig's axes: R = R_nominal R_correction, t = t_nominal +
    t_correction."""
    shift = row.raw(SHIFT_CORRECTION, None)
    turn = row.raw(TURN_CORRECTION, None)
    if shift is None and turn is None:
        return nominal
    angles = [0.0, 0.0, 0.0] if turn is None else row.at(TURN_CORRECTION, {}).raw(ROTATION_KEY)
    field = row.field(TURN_CORRECTION)
    correction = pose_from(path, field, (0.0, 0.0, 0.0), angles, degrees=True)
    moved = (0.0, 0.0, 0.0) if shift is None else shift
    offset = vector(path, row.field(SHIFT_CORRECTION), moved, count=3, rule=METRES)
    return shifted(composed(nominal, correction), offset)


def _sensor(path: Path, row: Table) -> PortableSensor:
    protocol = row.text("protocol", "").partition(".")[0]
    if POSE_KEY not in row:
        return PortableSensor(row.text("name"), ORIGIN, protocol or "other", entry=row.table)
    pose = row.at(POSE_KEY, {})
    position = pose.raw(POSITION_KEY)
    angles = pose.raw(ROTATION_KEY)
    kind = None if protocol in UNKNOWN else protocol
    _, _, model = row.text("parameter", "").partition("model=")
    placed = _corrected(path, row, pose_from(path, pose.path, position, angles, degrees=True))
    picture, note = read_properties(row.at("properties", {})) if kind == CAMERA else (None, "")
    return PortableSensor(
        row.text("name"),
        placed,
        kind,
        model.split(",")[0] or None,
        picture=picture,
        told=note,
        entry=row.table,
    )


def write_properties(picture: Picture) -> dict[str, str]:
    """Return the properties of a camera's intrinsics; DriveWorks stores them as text."""
    width, height = picture.size or (0, 0)
    cx, cy = picture.center
    common = {"width": str(width), "height": str(height)}
    common |= {"cx": plain_number(cx), "cy": plain_number(cy)}
    lens = picture.lens
    if not isinstance(lens, FTheta):
        focal = {"fx": plain_number(picture.fx), "fy": plain_number(picture.fy)}
        bent = {}
        if isinstance(lens, BrownConrady):
            bent = {DISTORTION: values.spaced([getattr(lens, key) for key in RADIAL])}
        return {"Model": PINHOLE, **common, **focal, **bent}
    polynomial = [0.0, *(lens.fx * getattr(lens, key) for key in lens.coefficients)]
    linear_terms = {"linear-c": "1.0", "linear-d": "0.0", "linear-e": "0.0"}
    polynomial_texts = {
        "polynomial": values.spaced(polynomial[:MAX_POWER]),
        "polynomial-type": FORWARD,
    }
    return {"Model": F_THETA, **common, **polynomial_texts, **linear_terms}


def read_properties(properties: Table) -> tuple[Picture | None, str]:
    """Return a camera's intrinsics, and a note on the accuracy of the conversion (may be empty).
    The intrinsics are None if properties are missing or belong to another lens model."""
    if not all(key in properties for key in (*MIDDLE, *SIZE)):
        return None, ""

    def number(key: str, rule: Number = FINITE) -> float:
        return values.figure(properties.source, properties.field(key), properties.raw(key), rule)

    cx, cy = (number(key, values.PRINCIPAL_POINT) for key in MIDDLE)
    width, height = (
        values.whole_figure(properties.source, properties.field(key), properties.raw(key))
        for key in SIZE
    )
    key = next((name for name in POLYNOMIALS if name in properties), None)
    if key is not None:
        coefficients = _rising(properties, key)
        max_radius = math.hypot(max(cx, width - cx), max(cy, height - cy))
        for name, default in (("linear-c", 1.0), ("linear-d", 0.0), ("linear-e", 0.0)):
            value = number(name) if name in properties else default
            if abs(value - default) > 0.01:  # one polynomial serves both axes
                raise properties.error(f"{default:g}, within 0.01", f"{value:g}", name)
        note = ""
        forward = coefficients
        direction = properties.text("polynomial-type", "", rule=OneOf(("", FORWARD, BACKWARD)))
        if not direction and key == POLYNOMIALS[0] and coefficients[1] >= GENTLE:
            direction = FORWARD
        if direction != FORWARD:
            forward, error_px = _turned_round(coefficients, max_radius)
            note = TURNED.format(error_px) if error_px > NOTICED_PX else ""
        bends = dict(zip(FTheta.coefficients, forward[1:], strict=False))
        return Picture(FTheta(1.0, 1.0, cx, cy, **bends), (width, height)), note
    if not all(key in properties for key in FOCAL_KEYS):
        return None, ""
    fx, fy = (number(name, values.FOCAL) for name in FOCAL_KEYS)
    k1, k2, k3 = _distortion(properties)
    if not any((k1, k2, k3)):
        return Picture(Pinhole(fx, fy, cx, cy), (width, height)), ""
    lens = BrownConrady(fx, fy, cx, cy, fov=None, k1=k1, k2=k2, k3=k3)
    return Picture(lens, (width, height)), ""


def _distortion(properties: Table) -> list[float]:
    """Return k1, k2, k3 of a pinhole; zeros if the file has none. They map undistorted to distorted
    coordinates by 1 + k1 r^2 + k2 r^4 + k3 r^6 (DriveWorks, dwPinholeCameraConfig)."""
    if DISTORTION in properties:
        text = properties.raw(DISTORTION)
        field = properties.field(DISTORTION)
        return values.figures(properties.source, field, text, 3, rule=values.COEFFICIENT)
    figures = ForeignNumbers(
        properties.source, lambda key: properties.raw(key, None), properties.field
    )
    return [figures.number(key, values.COEFFICIENT) or 0.0 for key in RADIAL]


def _rising(properties: Table, key: str) -> list[float]:
    """Return the coefficients of a polynomial, in ascending order; the constant is 0."""
    value = properties.raw(key)
    expected = f"2 to {MAX_POWER + 1} numbers, the first of them 0 and the second above 0"
    if not isinstance(value, str) or not 2 <= len(value.split()) <= MAX_POWER + 1:
        raise properties.error(expected, shown(value), key)
    coefficients = values.figures(
        properties.source, properties.field(key), value, count=None, rule=values.COEFFICIENT
    )
    if coefficients[0] != 0.0 or coefficients[1] < GENTLEST:
        raise properties.error(expected, shown(value), key)
    return coefficients


def _turned_round(coefficients: list[float], max_radius: float) -> tuple[list[float], float]:
    """Return the polynomial from angles to radii of one from radii to angles, and its error [px].
    It is a least-squares fit up to `max_radius` [px], as far as the angle rises with the radius."""
    radius = np.linspace(0.0, max_radius, PLACES + 1)[1:]
    theta = np.polyval(coefficients[::-1], radius)
    is_rising = np.diff(theta, prepend=0.0) > 0.0
    count = len(radius) if is_rising.all() else int(np.argmin(is_rising))
    theta = theta[:count]
    radius = radius[:count]
    scale = theta[-1] if count else 1.0
    powers = np.stack([(theta / scale) ** n for n in range(1, MAX_POWER + 1)], axis=1)
    solution = np.linalg.lstsq(powers, radius, rcond=None)[0]
    error_px = float(np.abs(powers @ solution - radius).max()) if count else 0.0
    return [0.0, *(float(v) / scale**n for n, v in enumerate(solution, start=1))], error_px
