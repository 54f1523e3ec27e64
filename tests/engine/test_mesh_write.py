"""Mesh files: what is written, how, and what is not."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pe_core.base.errors import InputError
from pe_tools.formats.meshes import Mesh, read_mesh, write_mesh
from tests.engine.mesh_files import BOX, ZEROS


@pytest.mark.parametrize("suffix", [".npz", ".obj"])
@pytest.mark.parametrize("labels", [[0, 0, 1, 2], [2, 0, 1, 0]], ids=["in order", "mixed"])
def test_written_meshes_read_back_exactly(tmp_path: Path, suffix: str, labels: list[int]) -> None:
    """Every bit of every coordinate (-0.0 and tiny ones too), every part and its place."""
    triangles = (
        np.random.default_rng(1).normal(size=(4, 3, 3))
        * 10.0 ** np.arange(-150, 150, 75)[:, None, None]
    )
    triangles[0, 0] = (0.0, -0.0, 5e-324)
    triangles[1, 0] = (-0.0, 0.0, 5e-324)
    mesh = Mesh(triangles, np.array(labels, np.int32), ("Rad #1 – links", "g", "o"))
    path = tmp_path / f"mesh{suffix}"
    write_mesh(str(path), mesh)
    back = read_mesh(str(path))
    assert back.triangles.tobytes() == triangles.tobytes()
    assert back.parts.tolist() == labels
    assert back.part_names == mesh.part_names


def test_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: Any) -> None:
    """When the last step fails, the old file is whole and nothing else is left behind."""
    path = tmp_path / "box.npz"
    path.write_text("old")

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(InputError, match="no space left"):
        write_mesh(path, Mesh(BOX, np.zeros(12, np.int32), ("box",)))
    assert [item.name for item in tmp_path.iterdir()] == ["box.npz"]
    assert path.read_text() == "old"


def test_written_file_replaces_the_old_one(tmp_path: Path) -> None:
    """The new file takes the old one's place with the mode any new file gets, alone."""
    path, other = tmp_path / "box.obj", tmp_path / "other"
    path.write_text("old")
    other.touch()
    write_mesh(path, Mesh(BOX, np.zeros(12, np.int32), ("box",)))
    assert read_mesh(path).triangles.tolist() == BOX.tolist()
    assert path.stat().st_mode == other.stat().st_mode
    assert {item.name for item in tmp_path.iterdir()} == {"box.obj", "other"}


UNWRITABLE = {
    "suffix": ("box.stl", Mesh(BOX, ZEROS, ("box",)), "suffix"),
    "folder": ("none/box.npz", Mesh(BOX, ZEROS, ("box",)), "file"),
    "nan": ("box.obj", Mesh(BOX * np.nan, ZEROS, ("box",)), "triangles[0]"),
    "empty": ("box.obj", Mesh(BOX[:0], ZEROS[:0], ("box",)), "triangles"),
    "flat": ("box.obj", Mesh(BOX[0], ZEROS[:3], ("box",)), "triangles"),
    "parts too few": ("box.npz", Mesh(BOX, ZEROS[1:], ("box",)), "parts"),
    "part without a name": ("box.npz", Mesh(BOX, ZEROS + 1, ("box",)), "parts[0]"),
    "two lines": ("box.obj", Mesh(BOX, ZEROS, ("a\nb",)), "part_names"),
    "no name": ("box.obj", Mesh(BOX, ZEROS, ("",)), "part_names"),
    "space in front": ("box.obj", Mesh(BOX, ZEROS, (" a",)), "part_names"),
    "continued": ("box.obj", Mesh(BOX, ZEROS, ("a\\",)), "part_names"),
    "no unicode": ("box.obj", Mesh(BOX, ZEROS, ("\udc80",)), "part_names"),
}


@pytest.mark.parametrize(("name", "mesh", "field"), UNWRITABLE.values(), ids=UNWRITABLE.keys())
def test_what_could_not_be_read_back_is_not_written(
    tmp_path: Path, name: str, mesh: Mesh, field: str
) -> None:
    """The error names file and field, and no file appears."""
    with pytest.raises(InputError) as caught:
        write_mesh(tmp_path / name, mesh)
    assert str(caught.value).startswith(f"{tmp_path / name}: {field}: expected ")
    assert not list(tmp_path.iterdir())
