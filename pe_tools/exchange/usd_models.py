"""Models of sensors from the attributes of OpenUSD's prims: lenses, emitters, scans of radars."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, shown
from pe_core.sensors.camera import BrownConrady, Pinhole

from .foreign_values import FARTHEST, FOCAL, MAX_BEAMS, MIN_RANGE, PIXELS, RANGE, require_at_most
from .lens_pictures import Picture
from .portable import Emitters, FieldOfView, PortableSensor, Scan
from .portable_kinds import (
    CAMERA,
    LIDAR,
    RADAR,
    RESOLUTIONS,
    ULTRASONIC,
    RadarScan,
    catalogued_emitters,
    parameters_of_scans,
    scans_of,
    spans_of,
)
from .usd_schema import (
    ACOUSTIC,
    ALIKE_RAD,
    APERTURE,
    CORE,
    DEFAULT_RANGE_M,
    FOCAL_LENGTH,
    FULL_DEG,
    LENS_MODEL,
    LENSES,
    NEAR_M,
    OURS,
    SCAN_RATE_HZ,
    SCANS,
    SQUARE_WITHIN,
    STATES,
    USUAL_SIZE,
)
from .usd_stage import PlacedPrim, numbers_of, text_of, value_of

PHYSX_LIDAR = "Lidar"  # Type of Isaac Sim's LiDAR by PhysX


class PrimValues:
    """Numbers of a prim's attributes; `InputError` names the prim and the attribute."""

    def __init__(self, source: Path, placed: PlacedPrim) -> None:
        self.source = source
        self.placed = placed

    def text(self, name: str) -> str:
        """Return a text or token; empty without one."""
        return text_of(self.placed, name)

    def number(self, name: str, rule: Any = None) -> float | None:
        """Return a number that meets a rule; None without a value."""
        found = numbers_of(self.source, self.placed, name, 1)
        if found is None:
            return None
        value = float(found[0])
        return value if rule is None else float(rule.checked(self.source, self.field(name), value))

    def numbers(self, name: str, count: int | None = None) -> Floats | None:
        """Return several numbers; None without a value."""
        return numbers_of(self.source, self.placed, name, count)

    def field(self, name: str) -> str:
        """Return an attribute's place for messages."""
        return f"{self.placed.path}.{name}"

    def instances(self, prefix: str) -> list[str]:
        """Return the names of instances of a multiple-apply schema, such as s001, in order."""
        names = {key[len(prefix) :].split(":")[0] for key in self.placed.prim.values
                 if key.startswith(prefix)}  # fmt: skip
        return sorted(names)


Read = tuple[PortableSensor, list[str]]


def _camera(values: PrimValues, sensor: PortableSensor, size: tuple[int, int] | None) -> Read:
    """Read a camera: its lens by NVIDIA's distortion schemas, or its aperture and focal length."""
    sensor = replace(
        sensor,
        min_range=values.number(f"{OURS}minRange", MIN_RANGE),
        max_range=values.number(f"{OURS}maxRange", FARTHEST),
    )
    if (projection := values.text("projection")) == "orthographic":
        return replace(sensor, kind="orthographic camera"), []
    lens_model = values.text(LENS_MODEL)
    if lens_model in LENSES:
        return replace(sensor, picture=_lens(values, lens_model, size)), []
    lines = []
    if lens_model or projection not in ("", "perspective"):
        lines.append(f"{sensor.name}: its lens, {shown(lens_model or projection)}, is read as one "
                     "without distortion")  # fmt: skip
    picture, notes = _aperture(values, size)
    return replace(sensor, picture=picture), [*lines, *(f"{sensor.name}: {n}" for n in notes)]


def _lens(values: PrimValues, model: str, size: tuple[int, int] | None) -> Picture:
    """Return the lens of a distortion schema of OpenCV."""
    kind, _ = LENSES[model]
    prefix = f"omni:lensdistortion:{model}:"
    stated = values.numbers(f"{prefix}imageSize", 2)
    own = size if stated is None else (int(stated[0]), int(stated[1]))
    width, height = own or USUAL_SIZE
    scale = (1.0, 1.0) if size is None else (size[0] / width, size[1] / height)
    focal = [values.number(f"{prefix}{key}", FOCAL) for key in ("fx", "fy")]
    center = [values.number(f"{prefix}{key}") for key in ("cx", "cy")]
    half = (width / 2.0, height / 2.0)
    fx, fy = (float(width) if f is None else f for f in focal)
    cx, cy = (middle if c is None else c for c, middle in zip(center, half, strict=True))
    bent = {key: values.number(prefix + key) or 0.0 for key in kind.coefficients}
    lens = kind(fx * scale[0], fy * scale[1], cx * scale[0], cy * scale[1], **bent)
    if isinstance(lens, BrownConrady) and not any(bent.values()):
        lens = Pinhole(lens.fx, lens.fy, lens.cx, lens.cy)
    return Picture(lens, size or (width, height))


def _aperture(values: PrimValues, size: tuple[int, int] | None) -> tuple[Picture, list[str]]:
    """Return the pinhole of an aperture, whose pixels are square, and notes on what is assumed."""
    focal = values.number("focalLength", FOCAL) or FOCAL_LENGTH
    across = values.number("horizontalAperture", FOCAL) or APERTURE[0]
    down = values.number("verticalAperture", FOCAL) or APERTURE[1]
    notes = []
    if size is None:
        height = max(1, round(USUAL_SIZE[0] * down / across))
        size = (USUAL_SIZE[0], int(PIXELS.checked(values.source, values.field("aperture"), height)))
        notes.append(f"no picture size in the file; {size[0]} x {size[1]} px stands in")
    width, height = size
    if abs(down / across * width / height - 1.0) > SQUARE_WITHIN:
        notes.append("the picture has other sides than the aperture; its width is followed")
    scale = width / across
    offsets = [values.number(f"{side}ApertureOffset") or 0.0 for side in ("horizontal", "vertical")]
    cx = width / 2.0 - offsets[0] * scale
    cy = height / 2.0 + offsets[1] * scale
    fx = focal * scale
    return Picture(Pinhole(fx, fx, cx, cy), size), notes


def _lidar(values: PrimValues, sensor: PortableSensor, _: tuple[int, int] | None) -> Read:
    """Read a LiDAR by its emitters, or Isaac Sim's by PhysX, by its fields of view."""
    if values.placed.prim.type == PHYSX_LIDAR:
        return replace(sensor, scan=_physx_scan(values)), []
    near = values.number(f"{CORE}nearRangeM", MIN_RANGE)
    far = values.number(f"{CORE}farRangeM", RANGE)
    sensor = replace(sensor, min_range=near, max_range=far)
    found = [_emitters(values, name) for name in values.instances(STATES)]
    states = [each for each in found if each is not None]
    if not states:
        return sensor, []
    lines = []
    if far is None:
        far = DEFAULT_RANGE_M
        lines.append(f"{sensor.name}: no range in the file; the schema's {far:g} m stands in")
    sensor = _scanned(values, sensor, states, near=NEAR_M if near is None else near, far=far)
    return _with_own_emitters(sensor, lines), lines


def _with_own_emitters(sensor: PortableSensor, lines: list[str]) -> PortableSensor:
    """Return a LiDAR without the name of a catalogued model whose emitters are not the file's."""
    scan = sensor.scan
    known = catalogued_emitters(sensor.model or "")
    if scan is None or scan.compute_emitters is None or known is None:
        return sensor
    own = scan.compute_emitters()
    pairs = ((known.azimuths, own.azimuths), (known.elevations, own.elevations))
    is_known = known.ticks == own.ticks and all(
        len(a) == len(b) and np.allclose(a, b, rtol=0.0, atol=ALIKE_RAD) for a, b in pairs
    )
    if is_known:
        return sensor
    lines.append(f"{sensor.name}: its emitters are not those of {sensor.model}, but the file's")
    return replace(sensor, model=None)


def _emitters(values: PrimValues, state: str) -> tuple[Floats, Floats] | None:
    """Return azimuths and elevations [deg] of the emitters of a state; None if it has none. Lengths
    that differ from the number of emitters raise `InputError`."""
    elevations = values.numbers(f"{STATES}{state}:elevationDeg")
    azimuths = values.numbers(f"{STATES}{state}:azimuthDeg")
    if elevations is None:
        return None
    azimuths = np.zeros_like(elevations) if azimuths is None else azimuths
    stated = values.number(f"{CORE}numberOfEmitters")
    count = len(elevations) if stated is None else int(stated)
    for key, found in (("elevationDeg", elevations), ("azimuthDeg", azimuths)):
        if len(found) != count:
            place = values.field(f"{STATES}{state}:{key}")
            raise InputError(values.source, place, f"{count} numbers, one an emitter", len(found))
    return azimuths, elevations


def _scanned(
    values: PrimValues,
    sensor: PortableSensor,
    states: Sequence[tuple[Floats, Floats]],
    near: float,
    far: float,
) -> PortableSensor:
    """Return a LiDAR with the scan of its emitters: a whole turn of one state as channels, other
    scans as beams."""
    is_rotary = values.text(f"{CORE}scanType") != "SOLID_STATE"
    ticks = _ticks(values) if is_rotary else 1
    window = [values.number(f"{CORE}valid{end}AzimuthDeg") for end in ("Start", "End")]
    first = 0.0 if window[0] is None else window[0]
    last = FULL_DEG if window[1] is None else window[1]
    is_whole = not is_rotary or abs(last - first) >= FULL_DEG - 1e-6
    start = values.number(f"{CORE}startAzimuthOffsetDeg") or 0.0 if is_rotary else 0.0
    azimuths, elevations = states[0]
    offsets = _wrapped(azimuths + start)
    if len(states) == 1 and is_whole:
        return replace(sensor, scan=_scan(elevations, offsets, ticks, near=near, far=far))
    beams = _beams(states, ticks, start)
    if not is_whole:
        turned = (beams[:, 0] - first) % FULL_DEG
        beams = beams[turned <= (last - first) % FULL_DEG + 1e-6]
    if not len(beams):
        raise InputError(values.source, values.field(CORE), "beams within its azimuths", "none")
    scan = _scan(beams[:, 1], _wrapped(beams[:, 0]), 1, near=near, far=far)
    return replace(sensor, scan=scan)


def _ticks(values: PrimValues) -> int:
    """Return the number of azimuths of a turn: firings a second by scans a second."""
    step = values.number(f"{CORE}rotPatternFiringResDeg", FOCAL)
    if step is not None:
        return max(1, round(FULL_DEG / step))
    rate = values.number(f"{CORE}scanRateBaseHz", FOCAL) or SCAN_RATE_HZ
    names = ("patternFiringRateHz", "reportRateBaseHz")
    firing = next(filter(None, (values.number(CORE + name, FOCAL) for name in names)), None)
    if firing is None:
        expected = f"{names[0]} or {names[1]}: how often its emitters fire"
        raise InputError(values.source, values.field(CORE), expected, "none")
    return max(1, round(firing / rate))


def _beams(states: Sequence[tuple[Floats, Floats]], ticks: int, start: float) -> Floats:
    """Return azimuths and elevations (B, 2) [deg] of all beams of a turn; states take turns."""
    total = sum(len(states[k % len(states)][0]) for k in range(ticks))
    require_at_most("USD", "emitters", total, MAX_BEAMS, noun="beams of a scan")
    rows = []
    for tick in range(ticks):
        azimuths, elevations = states[tick % len(states)]
        rows.append(np.stack([azimuths + start + tick * FULL_DEG / ticks, elevations], axis=1))
    return np.concatenate(rows)


def _wrapped(azimuths: Floats) -> Floats:
    """Return azimuths within +-180 degrees; those that are keep their bits."""
    return np.where(np.abs(azimuths) <= 180.0, azimuths, (azimuths + 180.0) % FULL_DEG - 180.0)


def _scan(elevations: Floats, offsets: Floats, ticks: int, near: float, far: float) -> Scan:
    up = np.array([math.radians(v) for v in elevations.tolist()])
    around = np.array([math.radians(v) for v in offsets.tolist()])
    return Scan(
        len(up),
        float(up.min()),
        float(up.max()),
        ticks,
        fov=(-math.pi, math.pi),
        max_range=far,
        even=False,
        min_range=near,
        compute_emitters=lambda: Emitters(around, up, ticks),
    )


def _physx_scan(values: PrimValues) -> Scan | None:
    """Return the scan of Isaac Sim's LiDAR by PhysX, with rays from edge to edge of its fields."""
    names = ("horizontalFov", "horizontalResolution", "verticalFov", "verticalResolution")
    across, step, down, apart = (values.number(name, FOCAL) for name in names)
    far = values.number("maxRange", RANGE)
    near = values.number("minRange", MIN_RANGE) or 0.0
    if across is None or step is None or far is None:
        return None
    is_high = bool(value_of(values.placed.prim, "highLod"))
    if is_high and down is not None and apart is not None:
        count = max(1, round(down / apart))
        elevations = np.linspace(-down / 2.0, down / 2.0, count)
    else:
        elevations = np.zeros(1)
    columns = max(1, round(across / step))
    if across >= FULL_DEG:
        return _scan(elevations, np.zeros_like(elevations), columns, near=near, far=far)
    azimuths = np.linspace(-across / 2.0, across / 2.0, columns)
    require_at_most(values.source, "rays", len(azimuths) * len(elevations), MAX_BEAMS, noun="rays")
    up = np.repeat(elevations, len(azimuths))
    return _scan(up, np.tile(azimuths, len(elevations)), 1, near=near, far=far)


def _radar(values: PrimValues, sensor: PortableSensor, _: tuple[int, int] | None) -> Read:
    """Read a radar: a mode for each of its scans, or our own table where that still says so."""
    scans = list(_scans(values))
    lines = []
    table = values.text(f"{OURS}parameters")
    if table:
        if _alike(scans, scans_of(table, sensor.name)):
            return replace(sensor, parameters=table), []
        lines.append(f"{sensor.name}: its scans are not those of its table, but the file's")
        sensor = replace(sensor, model=None)
    if not scans:
        return sensor, lines
    lines.append(f"{sensor.name}: the file has no RCS; its ranges are taken as those for 10 dBsm")
    parameters = parameters_of_scans(sensor.model or sensor.name, scans)
    return replace(sensor, parameters=parameters), lines


def _alike(a: Sequence[RadarScan], b: Sequence[RadarScan]) -> bool:
    """Whether two radars have the same ranges and angles but for single precision."""
    if len(a) != len(b):
        return False
    pairs = zip((v for row in a for v in row[1:4]), (v for row in b for v in row[1:4]), strict=True)
    return all(math.isclose(x, y, rel_tol=1e-6) for x, y in pairs)


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else math.radians(degrees)


def _scans(values: PrimValues) -> Iterator[RadarScan]:
    """Yield name, range [m], half azimuth and half elevation [deg], and resolutions of each scan of
    a radar that states its range and its angles."""
    for name in values.instances(SCANS):
        keys = ("maxRangeM", "maxAzAngDeg", "maxElAngDeg")
        reach, across, up = (values.number(f"{SCANS}{name}:{key}", FOCAL) for key in keys)
        if reach is None or across is None or up is None:
            continue
        found = {key: values.number(f"{SCANS}{name}:{key}", FOCAL) for key in RESOLUTIONS}
        stated = {key: value for key, value in found.items() if value is not None}
        yield name, reach, across, up, stated


def _acoustic(values: PrimValues, sensor: PortableSensor, _: tuple[int, int] | None) -> Read:
    """Read an ultrasonic sensor: our own table, or its spans and range."""
    spans = [values.number(f"{ACOUSTIC}{key}SpanDeg", FOCAL) for key in ("az", "el")]
    table = values.text(f"{OURS}parameters")
    if table:
        known = spans_of(table, sensor.name)
        if all(s is None or math.isclose(s, own, rel_tol=1e-6)
               for s, own in zip(spans, known, strict=True)):  # fmt: skip
            return replace(sensor, parameters=table), []
    far = values.number(f"{OURS}maxRange", RANGE)
    if far is None or None in spans:
        return sensor, []
    across, up = (math.radians(span or 0.0) / 2.0 for span in spans)
    return replace(sensor, field=FieldOfView((-across, across), (-up, up), far)), []


def by_table(values: PrimValues, sensor: PortableSensor, _: tuple[int, int] | None) -> Read:
    return replace(sensor, parameters=values.text(f"{OURS}parameters")), []


MODEL_READERS = {CAMERA: _camera, LIDAR: _lidar, RADAR: _radar, ULTRASONIC: _acoustic}
