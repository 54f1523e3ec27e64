"""OpenUSD as text: the rig over its vehicle, with what its score found (see `usd`).

Below ``/Vehicle`` are ``Body``, a reference to the vehicle's mesh in a layer of its own, a sensor's
frame for each sensor with the prim of NVIDIA's or USD's schema in it, and the render products.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats, Ints
from pe_core.base.values import degrees_in_file
from pe_core.scene.vehicle import Vehicle
from pe_core.sensors.camera import BrownConrady, KannalaBrandt
from pe_core.version import __version__

from .foreign_values import MAX_BEAMS, Export, require_at_most
from .frames import legal_frame
from .portable import Emitters, MergeTarget, PortableRig, PortableSensor, SceneFacts, named_apart
from .portable_kinds import CAMERA, LIDAR, RADAR, ULTRASONIC, scans_of, spans_of
from .usd_schema import (
    ACOUSTIC,
    CORE,
    FILE,
    LENS_MODEL,
    LENSES,
    MARKET_NAME,
    OURS,
    SCAN_RATE_HZ,
    SCANS,
    STATES,
    VEHICLE_FILE,
)
from .usd_text import array_text, dictionary_lines, number_text, quoted, tuple_text

ROOT = "Vehicle"
BODY = "Body"
SENSORS = "Sensors"
RENDER = "Render"
HEAD = ("    metersPerUnit = 1", '    upAxis = "Z"', ")", "")
LOOK_ALONG_X = (90.0, 0.0, -90.0)
"""rotateXYZ of a camera in its sensor's frame: it looks along -z there, and y is up."""
CLIPPING_M = (0.01, 1e6)
"""Where a camera's picture begins and ends; the default of the schema begins at 1 m."""
PX_PER_UNIT = 100.0  # Of an aperture; only ratios of its figures matter
LIDAR_SCHEMA = "OmniSensorGenericLidarCoreAPI"
RADAR_SCHEMA = "OmniSensorGenericRadarWpmDmatAPI"
RADAR_SCAN_SCHEMA = "OmniSensorGenericRadarWpmDmatScanCfgAPI"
ACOUSTIC_SCHEMA = "OmniSensorGenericAcousticWpmAPI"
OUTPUTS = {CAMERA: "LdrColor", LIDAR: "GenericModelOutput"}
"""Source of the render variable by kind; products of other kinds are not valid in SimReady."""
BODY_COLOR = (0.48, 0.51, 0.54)
ABOUT = (
    "Sensor frames: x forward, y left, z up. OmniLidar, OmniRadar and OmniAcoustic look along x as "
    "in Isaac Sim; ovrtx needs them turned by rotateXYZ = (90, 0, -90)."
)
TYPES = {CAMERA: "Camera", LIDAR: "OmniLidar", RADAR: "OmniRadar", ULTRASONIC: "OmniAcoustic"}
"""Type of the prim of a sensor by its kind; the kind is the prim's name."""


def write(sensors: PortableRig, _into: MergeTarget | None) -> Export:
    """Return a layer of the sensors alone, and messages."""
    return write_scene(sensors, SceneFacts())


def write_scene(sensors: PortableRig, facts: SceneFacts) -> Export:
    """Return a layer of the rig, one of the vehicle's mesh if there is one, and messages. More than
    `MAX_BEAMS` emitters raise `InputError`."""
    emitters = {s.name: s.scan.compute_emitters() for s in sensors
                if s.scan is not None and s.scan.compute_emitters is not None}  # fmt: skip
    total = sum(len(each.elevations) for each in emitters.values())
    require_at_most("usd", "sensors", total, MAX_BEAMS, noun="emitters, each of which is written")
    names = dict(
        zip((s.name for s in sensors), _prim_names([s.name for s in sensors]), strict=True)
    )
    lines = [f"{name}: called {prim} as a prim" for name, prim in names.items() if prim != name]
    body: list[str] = []
    files: dict[str, bytes] = {}
    if facts.vehicle is not None:
        body = list(_prim("Xform", BODY, [], [f"prepend references = @./{VEHICLE_FILE}@"]))
        files[VEHICLE_FILE] = _joined(_vehicle(facts.vehicle))
    frames = [line for s in sensors for line in _frame(s, names[s.name], emitters.get(s.name))]
    content = [
        *body,
        *_prim("Scope", SENSORS, frames, [f"doc = {quoted(ABOUT)}"]),
        *_prim("Scope", RENDER, [line for s in sensors for line in _product(s, names[s.name])]),
    ]
    data = {"program": f"perception-entropy {__version__}", **facts.metadata}
    about = ['kind = "assembly"', "customData = {"]
    about += [*dictionary_lines({OURS.rstrip(":"): data}, "    "), "}"]
    text = [
        "#usda 1.0",
        "(",
        f'    defaultPrim = "{ROOT}"',
        *HEAD,
        *_prim("Xform", ROOT, content, about),
    ]
    return {FILE: _joined(text), **files}, lines


def _joined(lines: Iterable[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode()


def _prim_names(names: Sequence[str]) -> list[str]:
    """Return a legal, unique name of a prim for each name; differing also without regard to case
    is not needed: prims are no files."""
    return named_apart([legal_frame(name) for name in names])


def _prim(
    type_name: str, name: str, content: Iterable[str], metadata: Sequence[str] = ()
) -> Iterator[str]:
    """Yield the lines of a prim; those of its content are indented."""
    if metadata:
        yield f'def {type_name} "{name}" ('
        yield from (f"    {line}" for line in metadata)
        yield ")"
    else:
        yield f'def {type_name} "{name}"'
    yield "{"
    yield from (f"    {line}" if line else "" for line in content)
    yield "}"
    yield ""


def _frame(sensor: PortableSensor, name: str, emitters: Emitters | None) -> Iterator[str]:
    """Yield the frame of a sensor, with its prim in it."""
    content = [*_placed(sensor.pose.position, sensor.pose.rotation_deg)]
    schema, values = _values(sensor, emitters)
    own = [f"custom string {OURS}{key} = {quoted(text)}" for key, text in _own_texts(sensor)]
    own += [f"custom double {OURS}{key} = {number_text(v)}" for key, v in _own_ranges(sensor)]
    type_name = TYPES.get(sensor.kind or "", "Xform")
    about = [f"prepend apiSchemas = [{', '.join(map(quoted, schema))}]"] if schema else []
    content += _prim(type_name, _prim_name(sensor), [*values, *own], about)
    yield from _prim("Xform", name, content)


def _prim_name(sensor: PortableSensor) -> str:
    """Return the name of a sensor's prim in its frame."""
    return legal_frame(sensor.kind or "sensor")


def _placed(position: Sequence[float], angles: Sequence[float]) -> Iterator[str]:
    """Yield what moves a prim; rotateXYZ is Rz Ry Rx, as roll, pitch and yaw are."""
    yield f"double3 xformOp:translate = {tuple_text(position)}"
    yield f"double3 xformOp:rotateXYZ = {tuple_text(angles)}"
    yield 'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]'


def _own_texts(sensor: PortableSensor) -> Iterator[tuple[str, str]]:
    yield "name", sensor.name
    if sensor.known_model:
        yield "model", sensor.known_model
    if sensor.fusion:
        yield "fusion", sensor.fusion
    if sensor.parameters:
        yield "parameters", sensor.parameters
    if sensor.kind not in TYPES and sensor.kind:
        yield "kind", sensor.kind


def _own_ranges(sensor: PortableSensor) -> Iterator[tuple[str, float]]:
    """Yield the ranges that the schemas have no room for."""
    if sensor.kind in (LIDAR, RADAR):
        return
    for key, value in (("minRange", sensor.min_range), ("maxRange", sensor.max_range)):
        if value is not None and math.isfinite(value):
            yield key, value


def _values(sensor: PortableSensor, emitters: Emitters | None) -> tuple[list[str], list[str]]:
    """Return the API schemas of a sensor's prim, and its attributes."""
    if sensor.kind == CAMERA:
        return _camera(sensor)
    if sensor.kind == LIDAR and emitters is not None:
        return [LIDAR_SCHEMA], list(_lidar(sensor, emitters))
    if sensor.kind == RADAR:
        return _radar(sensor)
    if sensor.kind == ULTRASONIC:
        return [ACOUSTIC_SCHEMA], list(_acoustic(sensor))
    return [], []


def _camera(sensor: PortableSensor) -> tuple[list[str], list[str]]:
    p = sensor.picture
    lines = [*_placed((0.0, 0.0, 0.0), LOOK_ALONG_X)]
    lines.append(f"float2 clippingRange = {tuple_text(CLIPPING_M)}")
    if p is None or p.size is None:
        return [], lines
    width, height = p.size
    cx, cy = p.center
    down = height * p.fx / p.fy  # of square pixels: the schema below has both focal lengths
    figures = {
        "focalLength": p.fx,
        "horizontalAperture": width,
        "verticalAperture": down,
        "horizontalApertureOffset": width / 2.0 - cx,
        "verticalApertureOffset": cy - height / 2.0,
    }
    lines += [f"float {key} = {number_text(v / PX_PER_UNIT)}" for key, v in figures.items()]
    if p.is_plain:
        return [], lines
    model = "opencvFisheye" if isinstance(p.lens, KannalaBrandt) else "opencvPinhole"
    prefix = f"omni:lensdistortion:{model}:"
    kind, schema = LENSES[model]
    bent = p.lens if isinstance(p.lens, BrownConrady | KannalaBrandt) else None
    values = {"fx": p.fx, "fy": p.fy, "cx": cx, "cy": cy}
    values |= {key: 0.0 if bent is None else getattr(bent, key) for key in kind.coefficients}
    lines.append(f"uniform token {LENS_MODEL} = {quoted(model)}")
    lines.append(f"int2 {prefix}imageSize = {tuple_text(p.size)}")
    lines += [f"float {prefix}{key} = {number_text(value)}" for key, value in values.items()]
    return [schema], lines


def _lidar(sensor: PortableSensor, emitters: Emitters) -> Iterator[str]:
    """Yield the attributes of a LiDAR: its emitters fire patternFiringRateHz / scanRateBaseHz times
    a turn; one whose beams are listed fires once a scan."""
    scan = sensor.scan
    assert scan is not None
    count = len(emitters.elevations)
    is_rotary = emitters.ticks > 1
    if sensor.known_model:
        yield f"string {MARKET_NAME} = {quoted(sensor.known_model)}"
    yield f'token {CORE}scanType = "{"ROTARY" if is_rotary else "SOLID_STATE"}"'
    yield f"uint {CORE}scanRateBaseHz = {number_text(SCAN_RATE_HZ)}"
    yield f"uint {CORE}patternFiringRateHz = {number_text(SCAN_RATE_HZ * emitters.ticks)}"
    if is_rotary:
        yield f'token {CORE}rotationDirection = "CCW"'
    else:
        yield f"uint {CORE}numLines = 1"
        yield f"uint[] {CORE}numRaysPerLine = [{count}]"
    yield f'token {CORE}rayType = "IDEALIZED"'
    yield f"float {CORE}nearRangeM = {number_text(scan.min_range)}"
    yield f"float {CORE}farRangeM = {number_text(scan.max_range)}"
    yield f"uint {CORE}numberOfEmitters = {count}"
    yield f"uint {CORE}numberOfChannels = {count}"
    state = f"{STATES}s001:"
    yield f"float[] {state}azimuthDeg = {array_text(_degrees(emitters.azimuths))}"
    yield f"float[] {state}elevationDeg = {array_text(_degrees(emitters.elevations))}"
    yield f"uint[] {state}fireTimeNs = [{', '.join(['0'] * count)}]"
    yield f"uint[] {state}channelId = [{', '.join(map(str, range(1, count + 1)))}]"
    if not is_rotary:
        yield f"uint[] {state}bank = [{', '.join(['0'] * count)}]"


def _degrees(angles: Floats) -> list[float]:
    return [degrees_in_file(value) for value in angles.tolist()]


def _radar(sensor: PortableSensor) -> tuple[list[str], list[str]]:
    scans = scans_of(sensor.parameters, sensor.name) if sensor.parameters else []
    lines = []
    for name, reach, across, up, resolution in scans:
        values = {"maxRangeM": reach, "maxAzAngDeg": across, "maxElAngDeg": up, **resolution}
        lines += [f"float {SCANS}{name}:{key} = {number_text(v)}" for key, v in values.items()]
    more = [f"{RADAR_SCAN_SCHEMA}:{name}" for name, *_ in scans[1:]]
    return [RADAR_SCHEMA, *more], lines


def _acoustic(sensor: PortableSensor) -> Iterator[str]:
    if sensor.parameters:
        spans = spans_of(sensor.parameters, sensor.name)
        for key, span in zip(("az", "el"), spans, strict=True):
            yield f"float {ACOUSTIC}{key}SpanDeg = {number_text(span)}"


def _product(sensor: PortableSensor, name: str) -> Iterator[str]:
    """Yield the render product of a camera or LiDAR, with the variable that it writes."""
    output = OUTPUTS.get(sensor.kind or "")
    if output is None:
        return
    prim = _prim_name(sensor)
    path = f"/{ROOT}/{RENDER}/{name}"
    content = [f"rel camera = </{ROOT}/{SENSORS}/{name}/{prim}>"]
    content.append(f"rel orderedVars = [<{path}/{output}>]")
    if sensor.picture is not None and sensor.picture.size is not None:
        content.append(f"uniform int2 resolution = {tuple_text(sensor.picture.size)}")
    content += _prim("RenderVar", output, [f'uniform string sourceName = "{output}"'])
    yield from _prim("RenderProduct", name, content)


def _vehicle(vehicle: Vehicle) -> Iterator[str]:
    """Yield the layer of a vehicle's mesh: a mesh a part."""
    names = _prim_names(list(vehicle.part_names))
    yield from ("#usda 1.0", "(", f'    defaultPrim = "{BODY}"', *HEAD)
    content: list[str] = []
    for number, (part, name) in enumerate(zip(vehicle.part_names, names, strict=True)):
        corners = vehicle.triangles[vehicle.parts == number].reshape(-1, 3)
        if len(corners):
            points, index = np.unique(corners, axis=0, return_inverse=True)
            content += _mesh(name, points, index.reshape(-1, 3), part in vehicle.glass)
    yield from _prim("Xform", BODY, content)


def _mesh(name: str, points: Floats, faces: Ints, is_glass: bool) -> Iterator[str]:
    """Yield a mesh (points in metres, single precision as USD has it)."""
    rounded = points.astype(np.float32)
    texts = _points(rounded)
    extent = ", ".join(_points(np.stack([rounded.min(axis=0), rounded.max(axis=0)])))
    opacity = 0.45 if is_glass else 1.0
    content = [
        f"float3[] extent = [{extent}]",
        f"int[] faceVertexCounts = [{', '.join(['3'] * len(faces))}]",
        f"int[] faceVertexIndices = [{', '.join(map(str, faces.ravel().tolist()))}]",
        f"point3f[] points = [{', '.join(texts)}]",
        'uniform token subdivisionScheme = "none"',
        "bool doubleSided = 1",
        f"color3f[] primvars:displayColor = [{tuple_text(BODY_COLOR)}]",
        f"float[] primvars:displayOpacity = [{number_text(opacity)}]",
    ]
    yield from _prim("Mesh", name, content)


def _points(points: Any) -> list[str]:
    """Return points of single precision as short texts that read back to the same bits."""
    return [f"({x!s}, {y!s}, {z!s})" for x, y, z in points]
