"""Rows of reading meshes: a million triangles of each format, against the least that has to be."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import pe_tools as pt
from tests.engine.mesh_files import glb_file, gltf, ply_header

from .timing import Timing, best_of_processor, peak_mb

SIDE = 708
"""Points along each side of a sheet of a million triangles."""


def read_obj() -> Timing:
    """A text as Blender writes it, against NumPy's own reader of its vertices."""
    points, corners = _sheet()
    ones = corners + 1
    lines = ["v {:f} {:f} {:f}".format(*p) for p in points.tolist()]
    table = "\n".join(line[2:] for line in lines)
    lines += ["f {0}//{0} {1}//{1} {2}//{2}".format(*t) for t in ones.tolist()]
    text = "\n".join(["o sheet", *lines, ""]).encode()

    def theirs(folder: Path) -> object:
        return np.loadtxt(folder / "table.txt")

    return _row(
        "obj", text, "np.loadtxt of its vertices", theirs, beside={"table.txt": table.encode()}
    )


def read_ply() -> Timing:
    """Binary lists of three, against gathering the corners of the triangles."""
    points, corners = _sheet()
    rows = np.empty(len(corners), [("n", "u1"), ("i", "<i4", 3)])
    rows["n"] = 3
    rows["i"] = corners
    header = ply_header("binary_little_endian", len(points), len(corners)).encode()
    data = header + points.astype("<f4").tobytes() + rows.tobytes()
    return _row("ply", data, "gathering the corners", lambda _: points[corners])


def read_glb() -> Timing:
    """An indexed primitive, against gathering the corners of the triangles."""
    points, corners = _sheet()
    root, positions = gltf(points=points, indices=None)
    indices = corners.astype("<u4").tobytes()
    root["meshes"][0]["primitives"][0]["indices"] = 1
    root["accessors"][1] = {
        "bufferView": 1,
        "componentType": 5125,
        "type": "SCALAR",
        "count": corners.size,
    }
    root["bufferViews"][1]["byteLength"] = len(indices)
    data = glb_file(root, positions + indices)
    return _row("glb", data, "gathering the corners", lambda _: points[corners])


def _sheet() -> tuple[np.ndarray, np.ndarray]:
    """Points (N, 3) and triangles (F, 3) of a bent sheet as large as a car."""
    u, v = np.meshgrid(*2 * [np.linspace(0.0, 1.0, SIDE)], indexing="ij")
    points = np.stack([4.7 * u - 2.35, 1.8 * v - 0.9, 0.7 + 0.35 * np.sin(3 * u)], axis=-1)
    k = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    a, b, c, d = (each.ravel() for each in (k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]))
    corners = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return points.reshape(-1, 3).astype(np.float32).astype(float), corners


def _row(
    suffix: str,
    data: bytes,
    yardstick: str,
    theirs: Callable[[Path], object],
    beside: dict[str, bytes] | None = None,
) -> Timing:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / f"mesh.{suffix}"
        for file, content in {path.name: data, **(beside or {})}.items():
            (folder / file).write_bytes(content)
        count = len(pt.read_mesh(path).triangles)
        ours = best_of_processor(lambda: pt.read_mesh(path))
        seconds = best_of_processor(lambda: theirs(folder))
    work = f"read {count:,} triangles, .{suffix} of {len(data) / 1e6:.0f} MB, processor time"
    return Timing(work, ours, peak_mb(), yardstick, yardstick_s=seconds)
