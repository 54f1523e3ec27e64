"""Good files with a few bytes wrong: each is read, or refused in one line; nothing else happens."""

import json
import warnings

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.formats import read_ap_table
from pe_tools.formats.angles import read_angles
from tests.engine.mesh_files import (
    BOX,
    ZEROS,
    glb_file,
    gltf,
    npz_bytes,
    obj_bytes,
    ply_ascii,
    ply_binary,
    stl_ascii,
    stl_binary,
)
from tests.engine.test_angle_files import HESAI
from tests.engine.test_box_files import CSV, KITTI, nuscenes_box
from tests.thorough import tries

DAMAGES = tries(80, 150)
WORDS = [b"nan", b"-inf", b"1e308", b"-1", b"0", b"9" * 5000, b"\xff\xfe", b"\0", b"\xed\xa0\x80"]
WORDS += [b"[", b'"', b"\n", b"\x1b[2J", b"\xe2\x80\xae", b"<!ENTITY a 'b'>", b"&a;", b"1_0", b"\\"]

GOOD = {
    "npz": (pt.read_mesh, "a.npz", npz_bytes(triangles=BOX, parts=ZEROS, part_names=["a"])),
    "obj": (pt.read_mesh, "a.obj", b"o body\n" + obj_bytes()),
    "stl": (pt.read_mesh, "a.stl", stl_binary()),
    "stl, ascii": (pt.read_mesh, "a.stl", stl_ascii()),
    "ply": (pt.read_mesh, "a.ply", ply_binary("<")),
    "ply, ascii": (pt.read_mesh, "a.ply", ply_ascii()),
    "glb": (pt.read_mesh, "a.glb", glb_file(*gltf())),
    "csv": (pt.read_boxes, "a", CSV.encode()),
    "kitti": (pt.read_boxes, "a", KITTI.encode()),
    "nuscenes": (pt.read_boxes, "a", json.dumps([nuscenes_box(), nuscenes_box()]).encode()),
    "hesai": (read_angles, "a", HESAI.encode()),
    "columns": (read_angles, "a", b"elevation,azimuth_offset\n5,1\n-3,-1\n"),
    "table": (read_ap_table, "a", b"m,ap,n\n1,0.2,9\n10,0.5,8\n100,0.8,7\n"),
}


def damaged(rng, data):
    """The file with one thing wrong: bytes changed, lost, twice, or a word put in."""
    start, length = int(rng.integers(len(data))), int(rng.integers(1, 40))
    before, piece, after = data[:start], data[start : start + length], data[start + length :]
    match int(rng.integers(6)):
        case 0:
            return before
        case 1:
            return before + after
        case 2:
            return before + piece + piece + after
        case 3:
            return before + rng.bytes(1) + data[start + 1 :]
        case 4:
            return before + rng.bytes(length) + after
    word = WORDS[int(rng.integers(len(WORDS)))]
    return before + word + data[start + int(rng.integers(4)) :]


def read_quietly(reader, path):
    """Read; no warning may come of it."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return reader(path)


@pytest.mark.parametrize("kind", GOOD)
def test_damage_is_refused_in_one_line_or_does_no_harm(tmp_path, kind):
    """What is read of it holds finite numbers alone; some of the damage is always noticed."""
    reader, name, data = GOOD[kind]
    rng = np.random.default_rng(8)
    path, refused = tmp_path / name, 0
    path.write_bytes(data)
    read_quietly(reader, path)
    for _ in range(DAMAGES):
        path.write_bytes(damaged(rng, data))
        try:
            result = read_quietly(reader, path)
        except pe.InputError as error:
            refused += 1
            line = str(error)
            assert line.startswith(f"{path}: ") and line.isprintable() and len(line) < 600
        else:
            assert np.isfinite(numbers_of(result)).all()
            for part in getattr(result, "part_names", ()):
                assert part.isprintable() and part.strip()
    assert refused > DAMAGES // 10


def numbers_of(result):
    """All numbers that were read, end to end."""
    if isinstance(result, list):  # channels
        return np.array([(c.elevation_deg, c.azimuth_offset_deg) for c in result])
    columns = ("triangles", "x", "y", "z", "length", "yaw", "m", "ap", "n")
    return np.concatenate([np.ravel(getattr(result, c)) for c in columns if hasattr(result, c)])
