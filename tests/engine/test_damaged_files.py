"""Good files with something wrong: each is read, or refused in one line; nothing else happens."""

import json
import math
import re
import warnings

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.exchange import RIG_FORMATS
from pe_tools.formats import read_ap_table
from pe_tools.formats.angles import read_angles
from pe_tools.formats.yaml_text import YamlText
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
from tests.engine.refusals import wrongly_refused
from tests.engine.test_angle_files import HESAI, OUSTER, VELODYNE
from tests.engine.test_box_files import CSV, KITTI, nuscenes_box
from tests.thorough import tries

DAMAGES = tries(40, 150)
RIG_DAMAGES = tries(12, 40)
"""A file; a longer hunt in rigs: `python -m tests.engine.test_damaged_files 5000 8`."""
WORDS = [b"nan", b"-inf", b"1e308", b"-1", b"0", b"9" * 5000, b"\xff\xfe", b"\0", b"\xed\xa0\x80"]
WORDS += [b"[", b'"', b"\n", b"\x1b[2J", b"\xe2\x80\xae", b"<!ENTITY a 'b'>", b"&a;", b"1_0", b"\\"]
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
ODD = [b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e-320", b"0", b"-1", b"1", b"", b"one"]
ODD += [b"1e7", b"1e400", b"9" * 400, b"1_0", b"null", b"[]", b"{}", b'"x"', b"true", b"1 2", b".5"]

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
    "ouster": (read_angles, "a", OUSTER.encode()),
    "velodyne": (read_angles, "a", VELODYNE.encode()),
    "columns": (read_angles, "a", b"elevation,azimuth_offset\n5,1\n-3,-1\n"),
    "table": (read_ap_table, "a", b"m,ap,n\n1,0.2,9\n10,0.5,8\n100,0.8,7\n"),
}
AXLE = pe.Reference(-1.31, 0.33)
PUCK = pe.Lidar("even", np.radians([-5.0, 0.0, 5.0]), 12, 80.0)
OWN = pe.Lidar(
    "own",
    np.radians([-20, -7, 3]),
    azimuth_count=12,
    max_range=80.0,
    azimuth_offsets=np.radians([0, 2, 0]),
)
JOINT = (
    '<link name="l{0}"/><joint name="j{0}" type="fixed"><parent link="{1}"/><child link="l{0}"/>'
    "</joint>"
)
CALL = '<node exec="static_transform_publisher" args="--frame-id {1} --child-frame-id f{0}"/>'
ROWS = "name,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n{}"
OSI = '{{"range": 9, "lidar_sensor_view_configuration": [{{"directions": [{}]}}]}}'
BEAM = '{"x":1,"y":0,"z":0}'


def damaged(rng, data):
    """The file with one thing wrong: bytes changed, lost, twice, or a word put in."""
    start = int(rng.integers(len(data)))
    length = int(rng.integers(1, 40))
    before = data[:start]
    piece = data[start : start + length]
    after = data[start + length :]
    word = WORDS[int(rng.integers(len(WORDS)))]
    ways = [
        before,
        before + after,
        before + piece + piece + after,
        before + rng.bytes(1) + data[start + 1 :],
        before + rng.bytes(length) + after,
        before + word + data[start + int(rng.integers(4)) :],
    ]
    return ways[int(rng.integers(len(ways)))]


def read_or_refused(read, source):
    """What is read without a warning; None where it is refused in one line that names the file."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return read()
    except pe.InputError as error:
        line = str(error)
        assert source in line and line.isprintable() and len(line) < 700
        return None


@pytest.mark.parametrize("kind", GOOD)
def test_damage_is_refused_in_one_line_or_does_no_harm(tmp_path, kind):
    """What is read of it holds finite numbers alone; some of the damage is always noticed."""
    reader, name, data = GOOD[kind]
    rng = np.random.default_rng(8)
    path = tmp_path / name
    refused = 0
    path.write_bytes(data)
    reader(path)
    for _ in range(DAMAGES):
        path.write_bytes(damaged(rng, data))
        result = read_or_refused(lambda: reader(path), str(path))
        if result is None:
            refused += 1
            continue
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


def sensor(name, model, position, rotation=(0.3, 2.5, -0.4)):
    return pe.Sensor(name, model, pe.Pose.from_degrees(position, rotation))


RIG = pe.Rig(
    [
        sensor("roof", PUCK, (-0.43, 0, 1.8), (0.5, -1.25, 12)),
        sensor("side", OWN, (1, 0.9, 0.8), (1, 40, 90)),
        sensor("wide", pe.catalog.load("PandaSet wide"), (1.5, 0.1, 1.3)),
        sensor("eye", pe.catalog.load("KITTI cam2"), (1, 0, 1)),
    ]
)
"""All that formats have words for: lenses of two models, even channels and others."""


def good_files(name, folder):
    """Write a format's files into a folder of their own; return them, and what to import."""
    folder.mkdir()
    rig = pe.Rig([s for s in RIG if s.name != "side"]) if name == "kitti" else RIG  # one LiDAR
    paths, _ = pt.export_rig(rig, name, folder, AXLE)
    return paths, folder if len(paths) > 1 else paths[0]


def hunt(name, folder, count, seed=8):
    """Read a format's files with a number that is odd, or damage; return how many were refused, or
    told as left out: a damaged lens does not refuse its rig."""
    rng = np.random.default_rng(seed)
    refused = 0
    paths, asked = good_files(name, folder)
    whole = {path: path.read_bytes() for path in paths}
    for _ in range(count):
        path = paths[int(rng.integers(len(paths)))]
        data = whole[path]
        numbers = list(NUMBER.finditer(whole[path]))
        wrong = damaged(rng, data)
        if numbers and rng.random() < 0.6:
            number = numbers[int(rng.integers(len(numbers)))]
            odd = ODD[int(rng.integers(len(ODD)))]
            wrong = data[: number.start()] + odd + data[number.end() :]
        path.write_bytes(wrong)
        found = read_or_refused(lambda: pt.import_rig(asked, name, AXLE), str(folder))
        if found is None or any(": expected " in line for line in found.lines):
            refused += 1
        if found is not None:
            numbers = [v for s in found.rig for v in (*s.pose.position, *s.pose.rpy)]
            assert all(map(math.isfinite, numbers))
        path.write_bytes(data)
    return refused


@pytest.mark.parametrize("name", RIG_FORMATS)
def test_a_damaged_rig_is_refused_in_one_line_or_does_no_harm(name, tmp_path):
    if name == "argoverse2":
        pytest.importorskip("pyarrow", reason="of the extra argoverse")
    refused = hunt(name, tmp_path / "rig", RIG_DAMAGES)
    assert RIG_DAMAGES // 6 < refused < RIG_DAMAGES


@pytest.mark.parametrize("name", ["carla", "csv", "kitti", "nuscenes", "urdf"])
def test_a_word_in_place_of_a_number_is_never_0_or_nothing(name, tmp_path):
    """Every fifth number of a file; in URDF those of the elements that are read."""
    paths, asked = good_files(name, tmp_path / "rig")
    refused = 0
    for path in paths:
        whole = path.read_bytes()
        begin = whole.find(b"-->") if name == "urdf" else 0
        inside = rb"(?<=[ >,:\"\[])" + NUMBER.pattern + rb"(?=[ <,\"\]\n])"
        for each in [m for m in re.finditer(inside, whole) if m.start() >= begin][::5]:
            before = whole[: each.start()]
            after = whole[each.end() :]
            in_inertial = before.rfind(b"<inertial>") > before.rfind(b"</inertial>")
            if before.endswith(b"<s>") or in_inertial:
                continue  # a lens's skew and a link's mass: for Gazebo, not read
            in_json = path.suffix == ".json" and not before.endswith(b'"')
            path.write_bytes(before + (b'"one"' if in_json else b"one") + after)
            with pytest.raises(pe.InputError):
                pt.import_rig(asked, name, AXLE)
            refused += 1
        path.write_bytes(whole)
    assert refused >= 6


def many(piece, count, chain=False):
    """Pieces of a file, each on the first one or on the one before."""
    stem = re.search(r"\b(\w)\{0\}", piece)[1]
    return "".join(
        piece.format(k, f"{stem}{k - 1}" if chain and k else "base") for k in range(count)
    )


def robot(joints):
    return f'<robot name="r"><link name="base"/>{joints}</robot>'


TOO_MUCH = [
    ("link", ("r.urdf", lambda: robot(many(JOINT, 12_000)))),
    ("file", ("r.xml", lambda: many(CALL, 10_001))),
    ("sensors", ("r.xml", lambda: many(CALL, 2_000, True))),
    ("file", ("r.xml", lambda: "<!--" * 1_000_000)),
    ("file", ("r.xml", lambda: "<node a='" * 200_000)),
    ("transform 1", ("r.xml", lambda: CALL.format(0, "a" * 20_000))),
    ("file", ("r.csv", lambda: ROWS.format("a,0,0,0,0,0,0\n" * 10_001))),
    ("sensors", ("r.csv", lambda: ROWS.format("a,0,0,0,0,0,0\n" * 1_001))),
    (
        "lidar_sensor_view_configuration[0].directions",
        ("sensor_view_configuration.json", lambda: OSI.format(",".join([BEAM] * 1_000_001))),
    ),
]


def test_a_rig_of_too_much_is_refused_before_it_is_worked_on(tmp_path):
    """Each took minutes, or did not end, where a number of frames was looked through for each."""

    def imported(given):
        (tmp_path / given[0]).write_text(given[1]())
        return pt.import_rig(tmp_path / given[0], reference=AXLE)

    assert wrongly_refused(imported, TOO_MUCH, tmp_path) == []
    chain = imported(("r.urdf", lambda: robot(many(JOINT, 3_000, True))))
    assert len(chain.rig) == 1, "the last link"


def test_yaml_with_tags_anchors_and_braces_is_read_and_edited_where_it_can_be():
    text = "%YAML:1.0\n---\na: !x [1, b, -.5e1]\nc: {d: &y 2, e: &y 'no'}  # kept\n"
    yaml = YamlText("kit.yaml", text)
    assert yaml.data == {"a": [1.0, "b", -5.0], "c": {"d": 2.0, "e": "no"}}
    edited = yaml.edited({("c", "d"): "7.25"}, {})
    assert edited == text.replace("&y 2", "7.25")
    assert yaml.comments() == {("c",): "kept"}
    edited = yaml.edited({}, {("c",): "new", ("a",): "seen"})
    assert edited == text.replace("kept", "new").replace(".5e1]", ".5e1]  # seen")
    with pytest.raises(pe.InputError) as error:
        yaml.edited({}, {}, (("c",), ["f: 1"]))
    assert error.value.field == "c"


if __name__ == "__main__":
    import sys
    import tempfile
    from pathlib import Path

    for each in sorted({*RIG_FORMATS}):
        with tempfile.TemporaryDirectory() as there:
            refused = hunt(each, Path(there) / "rig", int(sys.argv[1]), int(sys.argv[2]))
            print(f"{each}: {refused} refused", flush=True)
