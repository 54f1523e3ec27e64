"""Boxes in nuScenes' format: a list of annotations, or a submission of results. A box is a table
with ``translation`` [x, y, z] of its centre, ``size`` [width, length, height], ``rotation`` as a
quaternion [w, x, y, z], and ``category_name``, ``detection_name`` or ``tracking_name``. The
published annotations are in a map's frame; these files have to be in the vehicle's frame."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import MAX_QUOTE, quoted
from pe_core.base.values import real

from .labels import BoxNumbers, Labels

CLASSES = {
    "car": "car",
    "truck": "truck",
    "bus": "truck",
    "trailer": "truck",
    "construction": "truck",
    "construction_vehicle": "truck",
    "pedestrian": "pedestrian",
    "bicycle": "cyclist",
    "motorcycle": "cyclist",
    "traffic_cone": "cone",
    "trafficcone": "cone",
}  # By detection_name, or by the second word of category_name (``vehicle.bus.rigid``)
EMERGENCY = {"ambulance": "truck", "police": "car"}  # By the third word of ``vehicle.emergency.*``
GROUPS = ("vehicle", "human", "movable_object")
NAMES = ("detection_name", "category_name", "tracking_name")
LIST = 'a list of boxes, or {"results": {sample: [boxes]}}'


def read_nuscenes(source: str, data: Any) -> Labels:
    """Read labels from JSON data."""
    labels = Labels(source)
    for where, box in _boxes(source, data):
        if not isinstance(box, Mapping):
            raise InputError(source, where, "a table", shown(box))
        key = next((key for key in NAMES if key in box), None)
        if key is None:
            raise InputError(source, where, f"one of {', '.join(NAMES)}", "none")
        name = box[key]
        if not isinstance(name, str) or not name:
            raise InputError(source, f"{where}.{key}", "a text", shown(name))
        row = _row(source, where, box)
        if class_name := _class_of(name):
            labels.add(where, class_name, row)
        else:
            labels.count_left_out(f"of unknown class {quoted(name)}")
    return labels


def _boxes(source: str, data: Any) -> Iterator[tuple[str, Any]]:
    """Yield every box and its location in the file."""
    if isinstance(data, Mapping):
        results = data.get("results")
        if not isinstance(results, Mapping):
            raise InputError(source, "file", LIST, f"a table of {shown(list(data))}")
        for sample, boxes in results.items():
            yield from _listed(source, f"results[{sample[:MAX_QUOTE]}]", boxes)
    else:
        yield from _listed(source, "", data)


def _listed(source: str, where: str, boxes: Any) -> Iterator[tuple[str, Any]]:
    if not isinstance(boxes, list):
        raise InputError(source, where or "file", LIST, shown(boxes))
    yield from ((f"{where}[{i}]", box) for i, box in enumerate(boxes))


def _class_of(name: str) -> str | None:
    words = name.lower().split(".")
    if len(words) == 1:
        return CLASSES.get(words[0])
    if words[0] not in GROUPS:
        return None
    if words[1] == "emergency":
        return EMERGENCY.get(words[-1])
    return CLASSES.get(words[1])


def _row(source: str, where: str, box: Mapping[str, Any]) -> BoxNumbers:
    x, y, z = _numbers(source, where, box, "translation", count=3)
    width, length, height = _numbers(source, where, box, "size", count=3)
    w, i, j, k = _numbers(source, where, box, "rotation", count=4)
    if not any((w, i, j, k)):
        raise InputError(source, f"{where}.rotation", "a quaternion", "zeros alone")
    yaw = math.atan2(2.0 * (w * k + i * j), w * w + i * i - j * j - k * k)
    return x, y, z, length, width, height, yaw


def _numbers(
    source: str, where: str, box: Mapping[str, Any], key: str, count: int
) -> Sequence[float]:
    values = box.get(key)
    numbers = [real(v) for v in values] if isinstance(values, list) else []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        found = "nothing" if values is None else shown(values)
        raise InputError(source, f"{where}.{key}", f"{count} finite numbers", found)
    return numbers
