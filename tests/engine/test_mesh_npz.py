"""NPZ files: parts and their names, and every error."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.engine.mesh_files import (
    BOX,
    FACES,
    NAN,
    ZEROS,
    cut,
    npz_bytes,
    one_line_test,
    read,
)


def test_npz_parts_are_merged_and_dropped(tmp_path: Path) -> None:
    """Of four names one is repeated and one has no triangles: two are left."""
    names = np.array(["a", "unused", "b", "a"])
    data = npz_bytes(triangles=BOX[:3], parts=np.array([3, 2, 0]), part_names=names)
    mesh = read(tmp_path, "car.npz", data)
    assert mesh.part_names == ("a", "b")
    assert mesh.parts.tolist() == [0, 1, 0]


def test_npz_without_parts_may_have_a_name(tmp_path: Path) -> None:
    """A lone part name is used for all triangles."""
    data = npz_bytes(triangles=BOX, part_names=np.array(["body"]))
    assert read(tmp_path, "car.npz", data).part_names == ("body",)


BAD = {
    "npz of text": ("a.npz", b"hello", "file", ".npz"),
    "npz that is npy": ("a.npz", b"\x93NUMPY\x01\x00", "file", ".npz"),
    "npz cut": ("a.npz", cut(npz_bytes(triangles=BOX)), "file", "complete"),
    "npz of objects": ("a.npz", npz_bytes(triangles=np.array([{}])), "file", "pickle"),
    "npz without triangles": ("a.npz", npz_bytes(parts=[0]), "triangles", "parts"),
    "npz of empty": ("a.npz", npz_bytes(triangles=BOX[:0]), "triangles", "at least one"),
    "npz of two axes": ("a.npz", npz_bytes(triangles=BOX[0]), "triangles", "(3, 3)"),
    "npz of words": ("a.npz", npz_bytes(triangles=BOX.astype(str)), "triangles", "real"),
    "npz of NaN": ("a.npz", npz_bytes(triangles=NAN[FACES]), "triangles[0]", "nan"),
    "npz parts too short": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=[0], part_names=["a"]),
        "parts",
        "(12,)",
    ),
    "npz parts not whole": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=np.zeros(12), part_names=["a"]),
        "parts",
        "float64",
    ),
    "npz part out of range": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=[0] * 11 + [-1], part_names=["a"]),
        "parts[11]",
        "-1",
    ),
    "npz parts without names": ("a.npz", npz_bytes(triangles=BOX, parts=ZEROS), "part_names", "no"),
    "npz names without parts": (
        "a.npz",
        npz_bytes(triangles=BOX, part_names=["a", "b"]),
        "parts",
        "2 part names",
    ),
    "npz names of numbers": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=ZEROS, part_names=[1]),
        "part_names",
        "unicode",
    ),
}


test_bad_input_is_reported_in_one_line = one_line_test(BAD)
