"""Part names of other programs' files: made printable, never refused, no two parts made one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pe_core as pe
from pe_core.base.values import MAX_NAME
from pe_tools.formats.meshes.mesh import fit_names
from tests.engine.mesh_files import BOX, glb_file, gltf, npz_bytes, read, stl_ascii

LONG = "x" * 300


@pytest.mark.parametrize(
    ("names", "fit"),
    [
        (["Räder #1", " a", "車"], ["Räder #1", " a", "車"]),
        (["a\nb", "c\x1b[2Jd", "e\u202ef", "g\ud800"], ["a?b", "c?[2Jd", "e?f", "g?"]),
        (["", "  ", "\n"], ["?", "? (2)", "? (3)"]),
        (["a\x01", "a\x02", "a\x03"], ["a?", "a? (2)", "a? (3)"]),
        (["a\x01", "a?", "a? (2)", "a\x02"], ["a? (3)", "a?", "a? (2)", "a? (4)"]),
        ([f"{LONG}a", f"{LONG}b"], ["x" * 243, f"{'x' * 243} (2)"]),
    ],
    ids=["fit", "unprintable", "empty", "alike", "taken", "long"],
)
def test_names_are_made_fit_and_stay_different(names: list[str], fit: list[str]) -> None:
    """Names that are fit stay, even where another name becomes like one of them."""
    assert list(fit_names(names)) == fit
    assert all(name.isprintable() and len(name) <= MAX_NAME for name in fit)


def test_a_hundred_thousand_alike_are_reported_apart() -> None:
    """Each name is tried once, not with all numbers before its own."""
    names = [f"{chr(0xE000 + i % 6000)}{'x' * (i // 6000)}" for i in range(100_000)]
    assert len(set(fit_names(names))) == len(set(names)) == 100_000


def files() -> dict[str, tuple[str, bytes]]:
    """Two parts whose names differ in a character that cannot be printed."""
    two = ["body\x01", "body\x02"]
    root, binary = gltf(points=BOX[:1], indices=None)
    root["nodes"] = [{"name": name, "mesh": 0} for name in two]
    root["scenes"][0]["nodes"] = [0, 1]
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    return {
        "npz": ("a.npz", npz_bytes(triangles=BOX[:2], parts=[0, 1], part_names=two)),
        "obj": ("a.obj", (corners + "".join(f"o {n}\nf 1 2 3\n" for n in two)).encode()),
        "stl": ("a.stl", b"".join(stl_ascii(name, BOX[:1]) for name in two)),
        "glb": ("a.glb", glb_file(json.dumps(root).encode(), binary)),
    }


@pytest.mark.parametrize(("name", "data"), files().values(), ids=files())
def test_parts_do_not_become_one_by_their_names(tmp_path: Path, name: str, data: bytes) -> None:
    """Each triangle still belongs to its own part."""
    mesh = read(tmp_path, name, data)
    assert mesh.part_names == ("body?", "body? (2)")
    assert mesh.parts.tolist() == [0, 1]


@pytest.mark.parametrize("stem", ["a\nb", "a\u202eb"])
def test_a_file_s_own_name_as_a_part_s(tmp_path: Path, stem: str) -> None:
    """Where the stem stands for the part's name, it is made printable too."""
    assert read(tmp_path, f"{stem}.npz", npz_bytes(triangles=BOX)).part_names == ("a?b",)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e5, 1e154, 1e308, -1.7e308])
def test_a_vehicle_of_any_size_is_reported_without_warnings(tmp_path: Path, size: Any) -> None:
    """The mesh is read as it is; as a vehicle it is refused, and NumPy does not overflow first."""
    mesh = read(tmp_path, "a.npz", npz_bytes(triangles=np.sign(BOX) * size))
    with pytest.raises(pe.InputError, match="vehicle: triangles: expected"):
        pe.Vehicle(mesh.triangles, mesh.parts, mesh.part_names)
