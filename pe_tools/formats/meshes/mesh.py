"""Common parts of all readers: the checked mesh, limits, notes, pieces, names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, plural, shown
from pe_core.base.plugins import call_plugin, install_hint, plugin_name, required_plugin
from pe_core.base.values import A_NAME, MAX_NAME
from pe_core.scene.mesh import Mesh

from .axes import SaidAxes

MAX_TRIANGLES = 25_000_000  # Maximum triangles of a mesh: cars have up to some millions
INSTEAD = "?"  # Replacement of an unprintable character, and of a name without a printable one
MAX_NUMBER_DIGITS = 12  # Characters kept free for a number behind a name
MESH_PLUGIN = "mesh"


def make_mesh(
    source: str,
    triangles: ArrayLike,
    parts: ArrayLike,
    names: Sequence[str],
    notes: Sequence[str] = (),
) -> Mesh:
    """Return a checked mesh with unique part names, from the output of a reader. `triangles` (F, 3,
    3) are in metres, `parts` (F,) are indices into `names`; parts with the same name are merged,
    names without triangles are dropped. No triangle, a wrong shape, a coordinate that is not finite
    or an index out of range raises `InputError`."""
    corners = np.ascontiguousarray(triangles, dtype=np.float64)
    labels = np.asarray(parts)
    if corners.size == 0:
        raise InputError(source, "triangles", "at least one triangle", "none")
    if corners.shape[1:] != (3, 3):
        raise InputError(source, "triangles", "shape (F, 3, 3)", f"shape {corners.shape}")
    if not np.isfinite(corners).all():
        row = int(np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))[0])
        found = str(corners[row].tolist())
        raise InputError(source, f"triangles[{row}]", "finite coordinates", found)
    require_labels(source, labels.shape, labels.dtype, len(corners))
    if labels.size and not 0 <= int(labels.min()) <= int(labels.max()) < len(names):
        row = int(np.flatnonzero((labels < 0) | (labels >= len(names)))[0])
        expected = f"an index into the {len(names)} part names"
        raise InputError(source, f"parts[{row}]", expected, str(labels[row]))
    if len(names) == 1:
        one_part = np.zeros(len(labels), np.int32)
        return Mesh(corners, one_part, tuple(names), notes=tuple(notes))
    used = np.bincount(labels.astype(np.int64), minlength=len(names)) > 0
    used_names = [name for name, has_triangles in zip(names, used, strict=True) if has_triangles]
    new_index = {name: new for new, name in enumerate(dict.fromkeys(used_names))}
    # Unused names are never looked up, so their number is arbitrary.
    renumber = np.array([new_index.get(name, -1) for name in names], dtype=np.int32)
    return Mesh(corners, renumber[labels], tuple(new_index), notes=tuple(notes))


def require_room(source: str, triangles: int) -> None:
    """Raise `InputError` for too many triangles, before they are created."""
    if triangles > MAX_TRIANGLES:
        found = f"{triangles:,}" if triangles < 10**18 else "more than 10^18"
        raise InputError(source, "triangles", f"at most {MAX_TRIANGLES:,}", found)


def require_labels(source: str, shape: tuple[int, ...], dtype: np.dtype[Any], faces: int) -> None:
    """Raise `InputError` unless the array of parts has one integer per face."""
    if shape != (faces,):
        raise InputError(source, "parts", f"shape ({faces},)", f"shape {shape}")
    if dtype.kind not in "iu":
        raise InputError(source, "parts", "whole numbers", f"dtype {dtype}")


def mesh_notes(skipped: Mapping[str, int], counts: NDArray[Any], crossing: int) -> tuple[str, ...]:
    """Return what users must know of a file's geometry: what is left out, by its noun, with the
    faces of fewer than three corners by `counts` (P,), and how many polygons cross themselves."""
    few = int(np.count_nonzero(counts < 3))
    left_out = [plural(number, noun) for noun, number in skipped.items() if number]
    left_out += [f"{plural(few, 'face')} of fewer than 3 corners"] if few else []
    notes = [f"left out: {', '.join(left_out)}"] if left_out else []
    if crossing:
        notes.append(f"{plural(crossing, 'polygon')} not flat, or crossing itself")
    return tuple(notes)


def fit_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return a name for each of different names: printable, on one line and not too long. Valid
    names are unchanged. In other names `INSTEAD` replaces characters that cannot be printed (line
    ends, controls, changes of the text direction, halves of a surrogate pair). Long names are cut
    at the end. A number makes names different that would become equal."""
    taken = set()
    for name in names:
        with suppress(InputError):
            taken.add(A_NAME.checked("mesh", "part", name))
    used: Counter[str] = Counter()
    return tuple(name if name in taken else _new_name(name, taken, used) for name in names)


def _new_name(name: str, taken: set[str], used: Counter[str]) -> str:
    start = name[: MAX_NAME - MAX_NUMBER_DIGITS]
    base = "".join(c if c.isprintable() else INSTEAD for c in start).strip() or INSTEAD
    fit = base
    while not used[base] or fit in taken:
        used[base] += 1
        fit = base if used[base] == 1 else f"{base} ({used[base]})"
    taken.add(fit)
    return fit


class Piece(NamedTuple):
    """Triangles (F, 3, 3) of one part, in the file's axes and units."""

    name: str
    triangles: Floats


def placed(triangles: Floats, matrix: Floats) -> Floats:
    """Transform triangles by a matrix (4, 4) for column vectors; mirroring keeps the outside."""
    if np.array_equal(matrix, np.eye(4)):
        return triangles + 0.0  # as the sums below: no -0.0
    x, y, z = (triangles[..., k] for k in range(3))
    rows = [row[0] * x + row[1] * y + row[2] * z + row[3] for row in matrix[:3]]
    moved = np.stack(rows, axis=-1)
    return moved[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0.0 else moved


def joined(pieces: Sequence[Piece]) -> tuple[Floats, NDArray[np.int32]]:
    """Triangles (F, 3, 3) of all pieces, and the piece (F,) of each."""
    sizes = [len(piece.triangles) for piece in pieces]
    triangles = np.concatenate([np.zeros((0, 3, 3)), *(piece.triangles for piece in pieces)])
    return triangles, np.repeat(np.arange(len(pieces), dtype=np.int32), sizes)


def found(
    source: str, pieces: list[Piece], metres: float, up: str, notes: Sequence[str] = ()
) -> FoundMesh:
    """Join pieces into one mesh; `metres` is the file's unit [m], `up` its up axis."""
    if not (np.isfinite(metres) and metres > 0.0):
        raise InputError(source, "unit", "a length in metres", metres)
    triangles, parts = joined(pieces)
    if metres != 1.0:
        triangles = triangles * metres
    return FoundMesh(triangles, parts, [piece.name for piece in pieces], up, notes=notes)


class FoundMesh(NamedTuple):
    """Result of a reader: triangles [m] in the file's axes, parts, names, the up axis, and what
    users must know, such as geometry that is left out."""

    triangles: ArrayLike
    parts: NDArray[Any]
    part_names: Sequence[str]
    up: str
    notes: Sequence[str] = ()


def read_with_plugin(path: Path, data: bytes) -> tuple[Mesh, SaidAxes]:
    """Read a mesh with the plugin for its suffix. No plugin, a missing library (the message says
    how to install it), or an error of the plugin raises `InputError`."""
    suffix = path.suffix.lower()
    hint = install_hint(MESH_PLUGIN, suffix[1:])
    expected = f"a reader for it ({hint}), or the mesh imported into Blender"
    point, reader = required_plugin(MESH_PLUGIN, suffix[1:], str(path), "suffix", expected=expected)
    found = call_plugin(point, reader, path, data)
    if not isinstance(found, FoundMesh):
        raise InputError(plugin_name(point), "result", "a FoundMesh", shown(found))
    mesh = make_mesh(str(path), found.triangles, found.parts, found.part_names, notes=found.notes)
    forward = "+x" if found.up != "+x" else "+z"
    return mesh, SaidAxes(found.up, "file", forward, "")
