"""Autoware's sensor kit: sensors_calibration.yaml and a file for the kit, or one for each unit.

The origin base_link is the middle of the rear axle, projected to the ground. Units are metres and
radians. A camera's frame is called NAME/camera_link and has the axes of the ground frame. A LiDAR's
frame is called NAME_base_link; it is at the base of the housing where the catalogue knows that
height. A sensor name that ends in _link is used as the frame name unchanged.

In an existing kit, frames that did not move keep their numbers. All files keep their comments,
order and structure. The pose of the kit, the parent of each frame, and frames that are no sensors
do not change either.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.table_reader import Table
from pe_core.geometry.poses import Pose
from pe_core.scene.vehicle_description import Reference
from pe_tools.formats.yaml_text import KeyPath, YamlText, parse_yaml

from . import foreign_values as foreign
from .camera_info import info_files, info_name, read_info, with_info
from .foreign_values import RPY, XYZ, Export, plain_number
from .frames import (
    composed,
    is_optical,
    optical_of_body,
    seen_from,
    turned_to_body,
    with_legal_frames,
)
from .lens_pictures import alike
from .merging import gone_lines, is_there, is_turned_so
from .portable import ORIGIN, ForeignRig, MergeTarget, PortableRig, PortableSensor, merged_lines
from .portable_kinds import CAMERA, LIDAR, RADAR
from .sensor_names import model_by_name, said_kind

BASE = "base_link"
KIT = "sensor_kit_base_link"
TO_KIT = "sensors_calibration.yaml"
IN_KIT = "sensor_kit_calibration.yaml"
FRAMES = {CAMERA: "/camera_link", LIDAR: "_base_link", RADAR: "/radar_link"}
"""Suffixes of frame names, by kind."""
TYPE = "type"
HEAD = "# Metres and radians; R = Rz(yaw) Ry(pitch) Rx(roll); x forward, y left, z up.\n"
NO_INFO = "the kit has no camera_info of it; its lens is not written"
ODD_INFO = "its camera_info has a lens that is not read; it is kept"
BODY_AXES = "x forward"
OPTICAL_AXES = "z forward"
"""Comments of a camera's frame whose name and roll would say the other."""
AT_FRAME = "no model is known: its frame is taken as the centre of its scan"


@dataclass(frozen=True, slots=True)
class Unit:
    """A file of a kit: frames on one parent, which is on base_link. `types`: what TIER IV's kits
    say of a frame as its `type`, such as pandar_xt32, by frame."""

    text: YamlText
    parent: str
    frames: Mapping[str, Pose]
    types: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Kit:
    """The content of a kit: its files with frames, those on base_link first, and the texts of its
    camera_info files, both by file name."""

    units: Mapping[str, Unit]
    infos: Mapping[str, str]


def _units(folder: Path) -> tuple[dict[str, Unit], list[str]]:
    """Return the parts of a kit by file name: the frames on base_link first, then its units. With
    messages on files that are not read. A unit is the sensor kit itself or one of several groups,
    each in a file UNIT_calibration.yaml. The kit aip_x2 of TIER IV, for example, has the units
    top_unit and front_unit. Files of other content are left out, unless nothing is left then."""
    file_names = sorted(path.name for path in folder.glob("*_calibration.yaml"))
    names = [name for name in file_names if name not in (TO_KIT, IN_KIT)]
    if IN_KIT in file_names or not names:
        names.insert(0, IN_KIT)
    base = _unit(*_head(folder / TO_KIT, (BASE,)))
    units = {TO_KIT: base}
    strays = {}
    for name in names:
        try:
            head = _head(folder / name, base.frames)
        except InputError as error:
            if name == IN_KIT:
                raise
            strays[name] = error
        else:
            units[name] = _unit(*head)
    if len(units) == 1:
        raise next(iter(strays.values()))
    return units, [f"{error.at(name)}; the file is not read" for name, error in strays.items()]


def _head(path: Path, parents: Collection[str]) -> tuple[YamlText, str]:
    """Return a file of a kit, and the frame that it is about: one of `parents`."""
    yaml = YamlText(str(path), foreign.text_of(path))
    if len(yaml.data) != 1:
        found = ", ".join(yaml.data) or "none"
        raise InputError(path, "file", "one frame, and others on it", found)
    (parent,) = yaml.data
    if parent in parents:
        return yaml, parent
    if path.name == TO_KIT:
        raise InputError(path, BASE, "a mapping of frames", "nothing")
    raise InputError(path.parent / TO_KIT, BASE, parent, ", ".join(parents))


def _unit(yaml: YamlText, parent: str) -> Unit:
    table = Table(yaml.data, yaml.source).at(parent, {})
    frames = {}
    types = {}
    for name in table.table:
        row = table.at(name, {})
        if isinstance(row.raw(TYPE, None), str):
            types[name] = row.text(TYPE)
        position, angles = (foreign.named_numbers(row, keys) for keys in (XYZ, RPY))
        frames[name] = foreign.pose_from(yaml.source, row.path, position, angles)
    return Unit(yaml, parent, frames, types)


def _model_in(text: str) -> str:
    """Return the part of a comment that is the name of a model; empty if none is."""
    catalogued = catalog.entries()
    return next((part for part in text.split("; ") if part in catalogued), "")


def _comments(unit: Unit) -> dict[str, tuple[str, str]]:
    """Return the comments of frames: the model, or any text, and the axes; empty texts if none."""
    found = {}
    for path, comment in unit.text.comments().items():
        *texts, last = comment.split("; ")
        axes = last if last in (BODY_AXES, OPTICAL_AXES) else ""
        found[path[-1]] = ("; ".join(texts) if axes else comment, axes)
    return found


def _is_optical_here(frame: str, pose: Pose, axes: str) -> bool:
    """Whether a camera's frame is an optical one: by the comment on its axes, else by itself."""
    return axes == OPTICAL_AXES if axes else is_optical(frame, pose)


def _axes_comment(frame: str, pose: Pose, *, optical: bool) -> str:
    """Return the comment on the axes of a camera's frame; empty if the frame itself says them."""
    if is_optical(frame, pose) == optical:
        return ""
    return OPTICAL_AXES if optical else BODY_AXES


def _kind_of(frame: str, type_name: str) -> str | None:
    """Return the kind that a frame's type says, or else its name. The suffix of LiDARs is that of
    many other frames: of these, the rest of the name decides."""
    stated = said_kind(type_name)
    if stated in FRAMES:
        return stated
    kind = next((kind for kind, suffix in FRAMES.items() if frame.endswith(suffix)), None)
    said = said_kind(frame.removesuffix(FRAMES.get(kind or "", "")))
    if kind in (None, LIDAR) and said is not None:
        return said if said in FRAMES else None
    return kind


def _suffix_of(frame: str) -> str:
    return next((suffix for suffix in FRAMES.values() if frame.endswith(suffix)), "")


def read(path: Path) -> ForeignRig:
    """Read the sensors of a kit: `path` is its folder, or one of its files. LiDAR poses are those
    of the frames in the files. `lifted` moves a pose from the base of the housing to the scan
    centre, once the model is known."""
    folder = path if path.is_dir() else path.parent
    by_file, lines = _units(folder)
    base, *units = by_file.values()
    poses = {
        name: composed(base.frames[unit.parent], pose)
        for unit in units
        for name, pose in unit.frames.items()
    }
    parents = {unit.parent for unit in units}
    poses |= {name: pose for name, pose in base.frames.items() if name not in parents}
    types = {frame: name for unit in (base, *units) for frame, name in unit.types.items()}
    comments = {frame: both for unit in (base, *units) for frame, both in _comments(unit).items()}
    sensors = []
    for frame, pose in poses.items():
        text, axes = comments.get(frame, ("", ""))
        type_name = types.get(frame, "")
        model = _model_in(text) or model_by_name(type_name)
        sensor = PortableSensor(frame, pose, _kind_of(frame, type_name), model, entry=frame)
        if sensor.kind == CAMERA and _is_optical_here(frame, pose, axes):
            sensor = turned_to_body(sensor)
        sensors.append(replace(sensor, name=frame.removesuffix(_suffix_of(frame))))
    names = [info_name(sensor.name) for sensor in sensors]
    infos = {name: foreign.text_of(folder / name) for name in names if (folder / name).is_file()}
    return ForeignRig(with_info(folder, sensors), lines, Kit(by_file, infos))


def lifted(sensor: PortableSensor) -> PortableSensor:
    """Return a LiDAR of a known model with the pose of its scan centre instead of its frame."""
    if sensor.is_stand_in and sensor.kind == LIDAR:
        return replace(sensor, told=AT_FRAME)
    if not (height := _height(sensor)):
        return sensor
    note = f"{1000.0 * height:.1f} mm from its frame up to the centre of its scan ({sensor.model})"
    return replace(sensor, pose=composed(sensor.pose, Pose((0.0, 0.0, height))), told=note)


def _height(sensor: PortableSensor) -> float:
    """Return the height of a sensor's origin above its frame [m]; 0 if its model is not known."""
    return catalog.scan_above_base(sensor.known_model) if sensor.kind == LIDAR else 0.0


def _frame_of(sensor: PortableSensor) -> str:
    if sensor.entry is not None:
        return str(sensor.entry)
    suffix = "" if sensor.name.endswith("_link") else FRAMES.get(sensor.kind or "", "")
    return sensor.name + suffix


def _base_frame(sensor: PortableSensor) -> Pose:
    """Return the pose of a sensor's frame; a LiDAR's frame is at the base of its housing."""
    height = _height(sensor)
    return composed(sensor.pose, Pose((0.0, 0.0, -height))) if height else sensor.pose


def _frame_lines(sensor: PortableSensor, unit: Pose) -> list[str]:
    """Return the YAML lines of a sensor's frame on a unit; the model name becomes a comment."""
    frame = _frame_of(sensor)
    on_vehicle = _base_frame(sensor)
    axes = _axes_comment(frame, on_vehicle, optical=False) if sensor.kind == CAMERA else ""
    comment = "; ".join(filter(None, [sensor.known_model, axes]))
    head = f"{frame}:  # {comment}" if comment else f"{frame}:"
    return _lines_of(head, seen_from(unit, on_vehicle))


def _lines_of(head: str, pose: Pose) -> list[str]:
    return [head, *(f"  {key}: {plain_number(v)}" for key, v in foreign.pose_numbers(pose).items())]


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return the files of a new kit, or of an existing one with its sensors updated. A new kit has
    a camera_info file per camera; messages say where the LiDARs' frames are."""
    taken = [BASE, KIT]
    if into is not None:
        units = into.document.units.values()
        taken = [unit.parent for unit in units] + [frame for unit in units for frame in unit.frames]
    named, lines = with_legal_frames(
        sensors, slashes=True, frames=lambda sensor: (_frame_of(sensor),), taken=taken
    )
    files, own_lines = (_new(named), []) if into is None else _updated(into, named)
    notes = []
    for sensor in (sensor for sensor in named if sensor.kind == LIDAR):
        text = (
            "its frame is written at the centre of its scan; Autoware's description of "
            f"{sensor.model} may want the base of the housing"
        )
        if height := _height(sensor):
            below = f"{1000.0 * height:.1f} mm below the centre of its scan"
            text = f"its frame is {below} ({sensor.model})"
        notes.append((sensor.name, text))
    written = {name: text.encode() for name, text in files.items()}
    return written, [*lines, *own_lines, *merged_lines(notes)]


def _new(sensors: Sequence[PortableSensor]) -> dict[str, str]:
    """Return a kit whose pose is the mean sensor position, rounded to centimetres, not rotated."""
    middle = [sum(s.pose.position[k] for s in sensors) / len(sensors) for k in range(3)]
    x, y, z = (round(v, 2) for v in middle)
    kit = Pose((x, y, z))
    frames = [line for sensor in sensors for line in _frame_lines(sensor, kit)]
    files = {}
    for file, parent, lines in ((TO_KIT, BASE, _lines_of(f"{KIT}:", kit)), (IN_KIT, KIT, frames)):
        files[file] = HEAD + "\n  ".join([f"{parent}:", *lines]) + "\n"
    return files | info_files(sensors)


def _updated(
    into: MergeTarget, named: Sequence[PortableSensor]
) -> tuple[dict[str, str], list[str]]:
    """Return the files of an existing kit with the sensors' poses, models and lenses. Added sensors
    go into the first unit."""
    units = into.document.units
    by_frame = {_frame_of(sensor): sensor for sensor in named}
    base = units[TO_KIT].frames
    added = [sensor for sensor in named if sensor.entry is None]
    files = {}
    left = added
    for file, unit in units.items():
        pose = ORIGIN if file == TO_KIT else base[unit.parent]
        new_lines: list[str] = []
        if file != TO_KIT:
            new_lines = [line for sensor in left for line in _frame_lines(sensor, pose)]
            left = []
        files[file] = _patched(unit, pose, by_frame, new_lines)
    infos, lines = _infos(into.document.infos, named)
    return files | infos, [*gone_lines(sensor.entry for sensor in into.gone), *lines]


def _patched(
    unit: Unit, pose: Pose, by_frame: Mapping[str, PortableSensor], added: Sequence[str]
) -> str:
    """Return the text of a file with the new coordinates, or all angles, of frames that moved.
    `pose` is that of the unit on base_link."""
    values: dict[KeyPath, str] = {}
    comments: dict[KeyPath, str] = {}
    old_comments = _comments(unit)
    for frame in unit.frames.keys() & by_frame.keys():
        sensor = by_frame[frame]
        old = unit.frames[frame]
        text, axes = old_comments.get(frame, ("", ""))
        optical = sensor.kind == CAMERA and _is_optical_here(frame, composed(pose, old), axes)
        on_vehicle = optical_of_body(sensor.pose) if optical else _base_frame(sensor)
        now = seen_from(pose, on_vehicle)
        moved = zip(XYZ, old.position, now.position, strict=True)
        changed = [key for key, a, b in moved if not is_there(a, b)]
        changed += [] if is_turned_so(old, now) else RPY
        numbers = foreign.pose_numbers(now)
        values |= {(unit.parent, frame, key): plain_number(numbers[key]) for key in changed}
        new_axes = axes
        if sensor.kind == CAMERA and changed:
            new_axes = _axes_comment(frame, on_vehicle, optical=optical)
        typed = model_by_name(unit.types.get(frame, ""))
        new_text = _new_text(sensor, text, typed, is_moved=bool(changed))
        if (new_text, new_axes) != (text, axes):
            comments[unit.parent, frame] = "; ".join(filter(None, [new_text, new_axes]))
    return unit.text.edited(values, comments, ((unit.parent,), added))


def _new_text(sensor: PortableSensor, text: str, typed: str | None, *, is_moved: bool) -> str:
    """Return the comment of a frame of a kit with its model, if the comment has one. A LiDAR that
    moved gets one: the frame is at the base of this model's housing. So does a sensor whose type
    in the file says another model, `typed`."""
    old = _model_in(text)
    new = sensor.known_model or ""
    if not old:
        is_placed_by_model = is_moved and bool(_height(sensor)) and new != typed
        is_placed_by_model |= typed is not None and new in catalog.entries() and new != typed
        return "; ".join(filter(None, [new, text])) if is_placed_by_model else text
    if new in catalog.entries():
        return text.replace(old, new)
    if sensor.kind == CAMERA:  # its camera_info describes it
        return text
    return "; ".join(part for part in text.split("; ") if part != old)


def _infos(
    texts: Mapping[str, str], named: Sequence[PortableSensor]
) -> tuple[dict[str, str], list[str]]:
    """Return the camera_info files, and messages on cameras that have none. A file is rewritten
    only when the lens has changed, and created only for an added camera."""
    files = dict(texts)
    fresh = info_files(named)
    lines = []
    for sensor in named:
        name = info_name(sensor.name)
        if sensor.kind != CAMERA or sensor.picture is None:
            continue
        if name not in files and sensor.entry is not None:
            lines.append(f"{sensor.name}: {NO_INFO}")
        elif name not in files:
            files[name] = fresh[name]
        elif (own := read_info(name, files[name])[0]) is None:
            lines.append(f"{sensor.name}: {ODD_INFO}")
        elif not alike(own, sensor.picture):
            files[name] = fresh[name]
    return files, lines


def read_vehicle_info(path: str | Path) -> Reference:
    """Return the reference points of a vehicle from Autoware's vehicle_info file. The origin of the
    ground frame is below the middle of the vehicle's length. A file that cannot be read, or a
    number that is missing or impossible, raises `InputError`."""
    path = Path(path)
    top = Table(parse_yaml(str(path), foreign.text_of(path)), str(path))
    nodes = top.at("/**", {}) if "/**" in top else top
    keys = ("wheel_radius", "wheel_base", "front_overhang", "rear_overhang")
    radius, base, front, rear = foreign.named_numbers(nodes.at("ros__parameters", {}), keys)
    middle = (rear + base + front) / 2.0
    return Reference(rear - middle, radius, base, front, rear_overhang=rear)
