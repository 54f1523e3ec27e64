"""Stages of OpenUSD: layers composed to prims, and where the prims are.

Sublayers, references, payloads, inherits, specializes and selected variants are composed in USD's
order of strength. A binary layer is turned into text by usd-core. Of an animated value the earliest
sample is taken. The stage's unit and its up axis are applied: poses are in metres, z up.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, shown
from pe_core.base.files import decode_text, read_bytes
from pe_core.base.plugins import call_plugin, install_hint, required_plugin

from .foreign_values import BEAM_BYTES, require_at_most
from .usd_text import MAGIC, MAX_PRIMS, SAMPLES, Arc, Prim, RawArray, parse_layer

CRATE = b"PXR-USDC"
ZIP = b"PK\x03\x04"
MAX_ARCS = 40  # References in a row, each in what the one before leads to
MAX_LAYERS = 200
CENTIMETRES = 0.01  # Unit of a stage that states none
Y_UP = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0, 0, 0, 1.0]])
"""Ground frame from a stage with y up: x stays, y is z."""
OP = "xformOp:"
INVERT = "!invert!"
RESET = "!resetXformStack!"
AXES = "XYZ"
SHEAR = 1e-3  # Cosine between axes above which a matrix is no rotation with scales


@dataclass(frozen=True, slots=True)
class PlacedPrim:
    """A prim of a stage: its path, what is said of it, and `world`, the matrix (4, 4) from its
    frame to the ground frame's axes, for columns; its translation is in metres."""

    path: str
    prim: Prim
    world: Floats

    @property
    def name(self) -> str:
        """The prim's own name."""
        return self.prim.name


@dataclass(slots=True)
class UsdStage:
    """The prims of a stage that are defined and active, in its order, by path. `lines` are
    messages on what is not read."""

    prims: dict[str, PlacedPrim]
    metadata: Mapping[str, Any]
    lines: list[str]


def read_stage(path: Path) -> UsdStage:
    """Read a stage from a layer and all that it refers to. `InputError` for a damaged layer, one
    that is too large, or more than `MAX_PRIMS` prims."""
    composing = _Composing()
    root = composing.layer(path, 0)
    whole = composing.expanded(root, root, 0)
    unit = _number(root.metadata.get("metersPerUnit"), CENTIMETRES)
    if not 0.0 < unit < math.inf:
        raise InputError(path, "metersPerUnit", "a number above 0", shown(unit))
    up = root.metadata.get("upAxis", "Y")
    world = np.eye(4) if up == "Z" else Y_UP.copy()
    prims: dict[str, PlacedPrim] = {}
    for placed in _placed(path, whole, "", world, lines=composing.lines):
        place = placed.world.copy()
        place[:3, 3] *= unit
        prims[placed.path] = replace(placed, world=place)
    return UsdStage(prims, root.metadata, composing.lines)


def value_of(prim: Prim, name: str) -> Any:
    """Return the value of an attribute: its own, or the earliest sample; None if it has none."""
    value = prim.values.get(name)
    if value is None:
        samples = prim.values.get(name + SAMPLES)
        if isinstance(samples, dict) and samples:
            value = samples[min(samples, key=_time)]
    return value


def text_of(placed: PlacedPrim, name: str) -> str:
    """Return the text of an attribute; empty for another value or none."""
    value = value_of(placed.prim, name)
    return value if isinstance(value, str) else ""


def _time(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.inf


def numbers_of(source: object, placed: PlacedPrim, name: str, count: int | None) -> Floats | None:
    """Return `count` numbers of an attribute, any for None; None if it has no value. `InputError`
    for other values."""
    value = value_of(placed.prim, name)
    if value is None:
        return None
    return _numbers(source, f"{placed.path}.{name}", value, count)


def _numbers(source: object, field_name: str, value: Any, count: int | None) -> Floats:
    found: Floats | None
    if isinstance(value, RawArray):
        found = value.numbers
    else:
        try:
            found = np.array(value, dtype=float).ravel()
        except (TypeError, ValueError):
            found = None
    is_whole = found is not None and count in (None, len(found)) and bool(np.isfinite(found).all())
    if not is_whole or found is None:
        expected = "numbers" if count is None else f"{count} numbers"
        shape = "other values" if found is None else f"{len(found)}"
        raise InputError(source, field_name, expected, shape)
    return found


def _number(value: Any, default: float) -> float:
    return value if isinstance(value, float) else default


@dataclass(slots=True)
class _Composing:
    """Layers by path, the number of prims so far, and messages."""

    layers: dict[Path, Prim] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)
    prims: int = 0

    def layer(self, path: Path, depth: int) -> Prim:
        """Return the pseudo-root of a layer with its sublayers."""
        path = path.resolve() if depth else path
        if path in self.layers:
            return self.layers[path]
        require_at_most(path, "layers", len(self.layers) + 1, MAX_LAYERS, noun="layers")
        root = parse_layer(path, layer_text(path))
        self.layers[path] = root
        for arc in root.arcs.pop("subLayers", []):
            weaker = self._file(arc, depth)
            if weaker is not None:
                root = self.layers[path] = _merged(root, weaker)
        return root

    def _file(self, arc: Arc, depth: int) -> Prim | None:
        """Return the layer that an arc leads to; None, and a message, where it is missing."""
        assert arc.asset is not None
        name = arc.asset.path
        if depth >= MAX_ARCS:
            raise InputError(arc.asset.folder, name, f"at most {MAX_ARCS} layers in a row", "more")
        path = arc.asset.folder / name
        if "://" in name or not path.is_file():
            self._tell(f"{shown(name)} is not read: no such file")
            return None
        try:
            return self.layer(path, depth + 1)
        except InputError as error:
            if path.suffix in (".usd", ".usdc", ".usdz", ".usda"):
                raise
            self._tell(f"{shown(name)} is not read: {error.at('')}")
            return None

    def _tell(self, line: str) -> None:
        if line not in self.lines:
            self.lines.append(line)

    def expanded(
        self, prim: Prim, layer: Prim, depth: int, selections: Mapping[str, str] | None = None
    ) -> Prim:
        """Return a prim with all arcs composed, and so its descendants. `selections` are variants
        that stronger layers select."""
        self.prims += 1
        require_at_most("USD", "prims", self.prims, MAX_PRIMS, noun="prims")
        if depth > MAX_ARCS:
            raise InputError("USD", prim.name, f"at most {MAX_ARCS} references in a row", "more")
        chosen = {**prim.selections, **(selections or {})}
        children = {
            name: self.expanded(child, layer, depth) for name, child in prim.children.items()
        }
        result = replace(prim, children=children, arcs={}, variants={})
        weaker: list[Prim] = []
        for arc in prim.arcs.get("inherits", []):
            weaker += self._target(arc, layer, depth, chosen)
        for name, variants in prim.variants.items():
            if (variant := variants.get(chosen.get(name, ""))) is not None:
                weaker.append(self.expanded(variant, layer, depth + 1, chosen))
        for key in ("references", "payload", "specializes"):
            for arc in prim.arcs.get(key, []):
                weaker += self._target(arc, layer, depth, chosen)
        for each in weaker:
            result = _merged(result, each)
        return result

    def _target(
        self, arc: Arc, layer: Prim, depth: int, selections: Mapping[str, str]
    ) -> list[Prim]:
        """Return the prim that an arc leads to, composed; [] and a message where it is missing."""
        if arc.asset is not None and arc.asset.path:
            found = self._file(arc, depth)
            if found is None:
                return []
            layer = found
        path = arc.prim or f"/{layer.metadata.get('defaultPrim', '')}"
        target: Prim | None = layer
        for name in path.strip("/").split("/"):
            target = target.children.get(name) if target is not None else None
        if target is None:
            self._tell(f"{shown(path)} is not read: no such prim in its layer")
            return []
        return [self.expanded(target, layer, depth + 1, selections)]


def _merged(strong: Prim, weak: Prim) -> Prim:
    """Return what a stronger and a weaker layer say together."""
    children = dict(weak.children)
    for name, child in strong.children.items():
        children[name] = _merged(child, children[name]) if name in children else child
    variants = {name: dict(each) for name, each in weak.variants.items()}
    for name, each in strong.variants.items():
        variants[name] = {**variants.get(name, {}), **each}
    arcs = dict(weak.arcs)
    for key, own in strong.arcs.items():
        arcs[key] = [*own, *arcs.get(key, [])]
    defined = strong.specifier if strong.specifier != "over" else weak.specifier
    return Prim(
        strong.name,
        defined,
        strong.type or weak.type,
        metadata={**weak.metadata, **strong.metadata},
        values={**weak.values, **_stated(strong.values)},
        children=children,
        arcs=arcs,
        variants=variants,
        selections={**weak.selections, **strong.selections},
    )


def _stated(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that are there; one of its own hides a weaker layer's samples."""
    result = {}
    for name, value in values.items():
        result[name] = value
        if not name.endswith(SAMPLES) and name + SAMPLES not in values:
            result[name + SAMPLES] = None
    return result


def _placed(
    source: Path, prim: Prim, path: str, world: Floats, lines: list[str]
) -> Iterator[PlacedPrim]:
    """Yield the defined, active prims below a prim, with their matrices in the stage's unit."""
    animated: Counter[str] = Counter()
    stack = [(prim, path, world)]
    root = world
    while stack:
        above, above_path, above_world = stack.pop()
        below = []
        for name, child in above.children.items():
            if child.specifier != "def" or child.metadata.get("active") is False:
                continue
            child_path = f"{above_path}/{name}"
            local, is_reset = _local(source, child, child_path)
            if any(key.startswith(OP) and key.endswith(SAMPLES) for key in child.values):
                animated[child_path] += 1
            placed = _product(root if is_reset else above_world, local)
            yield PlacedPrim(child_path, replace(child, name=name), placed)
            below.append((child, child_path, placed))
        stack += reversed(below)
    if animated:
        names = ", ".join(list(animated)[:3])
        lines.append(f"animated, the earliest time is read: {names}")


def _local(source: Path, prim: Prim, path: str) -> tuple[Floats, bool]:
    """Return the matrix of a prim in its parent, and whether it leaves the parents' out."""
    order = value_of(prim, "xformOpOrder")
    names = order if isinstance(order, list) else []
    is_reset = RESET in names
    matrix = np.eye(4)
    for name in names[names.index(RESET) + 1 :] if is_reset else names:
        text = str(name)
        inverse = text.startswith(INVERT)
        key = text.removeprefix(INVERT)
        value = value_of(prim, key)
        if value is None or not key.startswith(OP):
            continue
        step = _operation(source, f"{path}.{key}", key.removeprefix(OP).split(":")[0], value)
        if inverse:
            step = _inverse(source, f"{path}.{key}", step)
        matrix = _product(matrix, step)
    return matrix, is_reset


def _product(a: Floats, b: Floats) -> Floats:
    """Return the product of two matrices (4, 4), in plain sums."""
    result: Floats = (a[:, :, None] * b[None]).sum(axis=1)
    return result


def _inverse(source: Path, place: str, matrix: Floats) -> Floats:
    """Return the inverse of a matrix (4, 4) that moves, turns and scales."""
    a, b, c = matrix[:3, :3].T
    rows = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    determinant = float((a * rows[0]).sum())
    if determinant == 0.0:
        raise InputError(source, place, "a matrix with an inverse", "none")
    result = np.eye(4)
    result[:3, :3] = rows / determinant
    result[:3, 3] = -(result[:3, :3] * matrix[:3, 3]).sum(axis=1)
    return result


def _operation(source: Path, place: str, kind: str, value: Any) -> Floats:
    """Return the matrix (4, 4) of one operation, for columns."""
    matrix = np.eye(4)
    if kind == "transform":
        return _numbers(source, place, value, 16).reshape(4, 4).T  # USD's is for rows
    if kind == "orient":
        w, x, y, z = _numbers(source, place, value, 4)
        length = math.sqrt(w * w + x * x + y * y + z * z)
        if length < 1e-9:
            raise InputError(source, place, "a quaternion of length 1", "0")
        matrix[:3, :3] = _of_quaternion(w / length, x / length, y / length, z / length)
    elif kind == "translate":
        matrix[:3, 3] = _numbers(source, place, value, 3)
    elif kind == "scale":
        matrix[[0, 1, 2], [0, 1, 2]] = _numbers(source, place, value, 3)
    elif kind[:-1] in ("translate", "scale") and kind[-1] in AXES:
        axis = AXES.index(kind[-1])
        row, column = (axis, 3) if kind.startswith("translate") else (axis, axis)
        matrix[row, column] = _numbers(source, place, value, 1)[0]
    elif kind.startswith("rotate") and set(kind[6:]) <= set(AXES) and len(kind) in (7, 9):
        axes = kind[6:]
        angles = _numbers(source, place, value, len(axes)).tolist()
        for letter in axes:  # the first is applied first; angles are those about x, y and z
            angle = angles[AXES.index(letter)] if len(angles) > 1 else angles[0]
            matrix = _product(_turn(letter, math.radians(angle)), matrix)
    else:
        raise InputError(source, place, "an operation of USD", shown(kind))
    return matrix


def _turn(axis: str, angle: float) -> Floats:
    cosine, sine = _cosine_and_sine(angle)
    a, b = [k for k in range(3) if AXES[k] != axis]
    matrix = np.eye(4)
    sign = -1.0 if axis == "Y" else 1.0
    matrix[a, a] = matrix[b, b] = cosine
    matrix[a, b] = -sign * sine
    matrix[b, a] = sign * sine
    return matrix


def _cosine_and_sine(angle: float) -> tuple[float, float]:
    """Return cosine and sine [rad]; those of quarter turns have no rounding."""
    quarters = angle / (math.pi / 2.0)
    if quarters == round(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    return math.cos(angle), math.sin(angle)


def _of_quaternion(w: float, x: float, y: float, z: float) -> Floats:
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def rotation_of(source: object, placed: PlacedPrim) -> Floats:
    """Return the rotation (3, 3) of a prim without its scales. `InputError` where it is mirrored,
    sheared or flat: a sensor cannot be so."""
    axes = placed.world[:3, :3]
    lengths = np.sqrt((axes**2).sum(axis=0))
    if not lengths.min() > 1e-9 * max(float(lengths.max()), 1e-300):
        raise InputError(source, placed.path, "scales that are not 0", "a flat frame")
    unit = axes / lengths
    dots = [abs(float((unit[:, a] * unit[:, b]).sum())) for a, b in ((0, 1), (1, 2), (0, 2))]
    if max(dots) > SHEAR:
        raise InputError(source, placed.path, "axes at right angles", "a sheared frame")
    if float((np.cross(unit[:, 0], unit[:, 1]) * unit[:, 2]).sum()) < 0.0:
        raise InputError(source, placed.path, "a right-handed frame", "a mirrored one")
    x = unit[:, 0]
    y = unit[:, 1] - x * (x * unit[:, 1]).sum()
    y = y / math.sqrt(float((y * y).sum()))
    return np.stack([x, y, np.cross(x, y)], axis=1)


def layer_text(path: Path) -> str:
    """Return a layer's text; that of a binary one comes from usd-core."""
    data = read_bytes(path, BEAM_BYTES)
    if data.startswith((CRATE, ZIP)):
        name = "usd_text"
        point, function = required_plugin(
            "library", name, str(path), "file", f"usd-core: {install_hint('library', name)}"
        )
        text: str = call_plugin(point, function, path)
        return text
    if not data.lstrip(b"\xef\xbb\xbf").startswith(MAGIC.encode()):
        raise InputError(path, "file", "a layer of USD, text or binary", "something else")
    return decode_text(data)
