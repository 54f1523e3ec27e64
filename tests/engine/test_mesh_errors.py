"""Mesh files: the errors that all formats share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from pe_core.base.errors import InputError
from pe_tools.formats.meshes import read_mesh
from tests.engine.mesh_files import (
    BOX,
    glb_file,
    gltf,
    npz_bytes,
    one_line_test,
    ply_binary,
    read,
    stl_binary,
)
from tests.thorough import tries

BAD = {
    "unknown suffix": ("a.fbx", b"", "suffix", ".obj"),
    "no suffix": ("a", b"", "suffix", "none"),
}


test_bad_input_is_reported_in_one_line = one_line_test(BAD)


@pytest.mark.parametrize("name", ["a.npz", "a.obj", "a.stl", "a.ply", "a.glb"])
@pytest.mark.parametrize("folder", [False, True], ids=["missing", "a folder"])
def test_files_that_cannot_be_read(tmp_path: Path, name: str, folder: bool) -> None:
    """A missing file and a folder in its place are told of like any other bad input."""
    if folder:
        (tmp_path / name).mkdir()
    with pytest.raises(InputError) as caught:
        read_mesh(tmp_path / name)
    expected = "a readable file" if folder else "an existing file"
    assert str(caught.value).startswith(f"{tmp_path / name}: file: expected {expected}")


def test_a_path_no_file_can_have() -> None:
    """A NUL in the path is told of like a missing file."""
    with pytest.raises(InputError, match="file: expected a readable file, found embedded null"):
        read_mesh("a\0.obj")


BINARY: dict[str, Callable[[], bytes]] = {
    "box.npz": lambda: npz_bytes(triangles=BOX),
    "box.stl": stl_binary,
    "box.ply": lambda: ply_binary("<"),
    "x.glb": lambda: glb_file(*gltf()),
}


@pytest.mark.parametrize(("name", "make"), BINARY.items(), ids=BINARY.keys())
def test_a_binary_file_cut_anywhere_is_an_error(
    tmp_path: Path, name: str, make: Callable[[], bytes]
) -> None:
    """No cut, wherever it falls, gives a mesh or any other exception; by default every fifth."""
    data = make()
    for end in [*range(0, len(data), tries(5, 1)), len(data) - 1]:
        with pytest.raises(InputError):
            read(tmp_path, name, data[:end])
