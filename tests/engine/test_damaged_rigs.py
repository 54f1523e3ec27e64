"""Rigs of other programs with something wrong: each is read, or refused in one line."""

import math
import re
import warnings

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.exchange import RIG_FORMATS
from pe_tools.formats.yaml_text import YamlText, parse_yaml
from tests.engine.test_damaged_files import damaged
from tests.thorough import tries

AXLE = pe.Reference(-1.31, 0.33)
DAMAGES = tries(20, 40)
"""A file; a longer hunt: `python -m tests.engine.test_damaged_rigs 5000 8`."""
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
ODD = [b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e-320", b"0", b"-1", b"1", b"", b"one"]
ODD += [b"1e7", b"1e400", b"9" * 400, b"1_0", b"null", b"[]", b"{}", b'"x"', b"true", b"1 2", b".5"]


def rig():
    """All that formats have words for: lenses of four models, even channels and others."""
    brown = pe.catalog.load("PandaSet wide")
    puck = pe.Lidar("even", np.radians([-5.0, 0.0, 5.0]), 12, 80.0)
    own = pe.Lidar("own", np.radians([-20, -7, 3]), 12, 80.0, np.radians([0, 2, 0]))
    way = (0.3, 2.5, -0.4)
    return pe.Rig(
        [
            pe.Sensor("roof", puck, pe.Pose.from_degrees((-0.43, 0, 1.8), (0.5, -1.25, 12))),
            pe.Sensor("side", own, pe.Pose.from_degrees((1, 0.9, 0.8), (1, 40, 90))),
            pe.Sensor("wide", brown, pe.Pose.from_degrees((1.5, 0.1, 1.3), way)),
            pe.Sensor("eye", pe.catalog.load("KITTI cam2"), pe.Pose.from_degrees((1, 0, 1), way)),
        ]
    )


def good_files(name, folder):
    """A format's files in a folder of their own."""
    folder.mkdir()
    whole = rig()
    one_lidar = pe.Rig([s for s in whole if s.name != "side"])
    paths, _ = pt.export_rig(one_lidar if name == "kitti" else whole, name, folder, AXLE)
    return paths


def wrong(rng, data):
    """A file with a number replaced by what is none or odd, or damaged anywhere."""
    numbers = list(NUMBER.finditer(data))
    if not numbers or rng.random() < 0.4:
        return damaged(rng, data)
    found = numbers[int(rng.integers(len(numbers)))]
    return data[: found.start()] + ODD[int(rng.integers(len(ODD)))] + data[found.end() :]


def hunt(name, folder, count, seed=8):
    """Read a format's files with one of them wrong; return how many were refused."""
    rng, refused = np.random.default_rng(seed), 0
    paths = good_files(name, folder)
    whole = {path: path.read_bytes() for path in paths}
    asked = folder if len(paths) > 1 else paths[0]
    for _ in range(count):
        path = paths[int(rng.integers(len(paths)))]
        path.write_bytes(wrong(rng, whole[path]))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                found = pt.import_rig(asked, name, AXLE)
        except pe.InputError as error:
            refused += 1
            line = str(error)
            assert str(folder) in line and line.isprintable() and len(line) < 700
        else:
            numbers = [v for s in found.rig for v in (*s.pose.position, *s.pose.rpy)]
            assert all(map(math.isfinite, numbers))
        path.write_bytes(whole[path])
    return refused


@pytest.mark.parametrize("name", RIG_FORMATS)
def test_a_damaged_rig_is_refused_in_one_line_or_does_no_harm(name, tmp_path):
    if name == "argoverse2":
        pytest.importorskip("pyarrow", reason="of the extra argoverse")
    refused = hunt(name, tmp_path / "rig", DAMAGES)
    assert DAMAGES // 6 < refused < DAMAGES


JOINT = (
    '<link name="l{0}"/><joint name="j{0}" type="fixed"><parent link="{1}"/><child link="l{0}"/>'
)
JOINT += "</joint>"
CALL = '<node exec="static_transform_publisher" args="--frame-id {1} --child-frame-id f{0}"/>'


def many(piece, count, chain=False):
    """Pieces of a file, each on the first one or on the one before."""
    stem = re.search(r"\b(\w)\{0\}", piece)[1]
    return "".join(
        piece.format(k, f"{stem}{k - 1}" if chain and k else "base") for k in range(count)
    )


@pytest.mark.parametrize("name", ["carla", "csv", "kitti", "nuscenes", "urdf"])
def test_a_word_in_place_of_a_number_is_never_0_or_nothing(name, tmp_path):
    """Every third number of a file; in URDF those of the elements that are read."""
    paths = good_files(name, tmp_path / "rig")
    asked = paths[0].parent if len(paths) > 1 else paths[0]
    refused = 0
    for path in paths:
        whole = path.read_bytes()
        begin = whole.find(b"-->") if name == "urdf" else 0
        inside = rb"(?<=[ >,:\"\[])" + NUMBER.pattern + rb"(?=[ <,\"\]\n])"
        found = [m for m in re.finditer(inside, whole) if m.start() >= begin]
        for each in found[::3]:
            before, after = whole[: each.start()], whole[each.end() :]
            if before.endswith(b"<s>") or before.rfind(b"<inertial>") > before.rfind(
                b"</inertial>"
            ):
                continue  # a lens's skew and a link's mass: for Gazebo, not read
            in_json = path.suffix == ".json" and not before.endswith(b'"')
            path.write_bytes(before + (b'"one"' if in_json else b"one") + after)
            with pytest.raises(pe.InputError):
                pt.import_rig(asked, name, AXLE)
            refused += 1
        path.write_bytes(whole)
    assert refused >= 10


def robot(pieces):
    return f'<robot name="r"><link name="base"/>{pieces}</robot>'


OSI_BEAM = '{"x":1,"y":0,"z":0}'
OSI = '{{"range": 9, "lidar_sensor_view_configuration": [{{"directions": [{}]}}]}}'
GREAT = {
    "links": ("r.urdf", lambda: robot(many(JOINT, 12_000)), "at most 10,000 links, found 12,001"),
    "chain of links": ("r.urdf", lambda: robot(many(JOINT, 3_000, True)), None),
    "transforms": ("r.xml", lambda: many(CALL, 10_001), "at most 10,000 calls"),
    "chain of frames": ("r.xml", lambda: many(CALL, 2_000, True), "at most 1,000 sensors"),
    "comments that never end": ("r.xml", lambda: "<!--" * 1_000_000, "calls of static_transform"),
    "a long call": ("r.xml", lambda: CALL.format(0, "a" * 20_000), "at most 10,000 characters"),
    "rows": (
        "r.csv",
        lambda: "name,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + "a,0,0,0,0,0,0\n" * 10_001,
        "at most 10,000 rows",
    ),
    "sensors": (
        "r.csv",
        lambda: "name,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + "a,0,0,0,0,0,0\n" * 1_001,
        "at most 1,000 sensors, found 1,001",
    ),
    "beams": (
        "sensor_view_configuration.json",
        lambda: OSI.format(",".join([OSI_BEAM] * 1_000_001)),
        "at most 1,000,000 beams",
    ),
}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a:\n" + "  b: 1\n" * 50_000, "YAML of at most 262,144 characters, found 350,003"),
        ("a: " + "[" * 100_000, "YAML, found too many levels"),
        ("a: &x [1, 2]\nb: [*x, *x]", "line 1: expected YAML without aliases"),
        ("a: 1\na: 2", "line 2: expected a key used once, found 'a'"),
        ("a: [1, 2", "line 1: expected well-formed YAML"),
        ("a: *x", "expected well-formed YAML, found undefined alias"),
        ("- 1", "a mapping"),
        ("a: \x00", "YAML"),
    ],
)
def test_yaml_that_is_out_to_do_harm_is_refused_in_one_line(text, words):
    with pytest.raises(pe.InputError) as caught:
        parse_yaml("kit.yaml", text)
    line = str(caught.value)
    assert words in line and line.isprintable() and len(line) < 600


def test_yaml_with_tags_anchors_and_braces_is_read_and_edited_where_it_can_be():
    text = "%YAML:1.0\n---\na: !x [1, b, -.5e1]\nc: {d: &y 2, e: &y 'no'}  # kept\n"
    yaml = YamlText("kit.yaml", text)
    assert yaml.data == {"a": [1.0, "b", -5.0], "c": {"d": 2.0, "e": "no"}}
    edited = yaml.edited({("c", "d"): "7.25"}, {})
    assert edited == text.replace("&y 2", "7.25")
    with pytest.raises(pe.InputError, match="c: expected a mapping with a line for each key"):
        yaml.edited({}, {}, (("c",), ["f: 1"]))


@pytest.mark.parametrize("case", GREAT)
def test_a_rig_of_too_much_is_refused_before_it_is_worked_on(case, tmp_path):
    """Each took minutes, or did not end, where a number of frames was looked through for each."""
    name, text, words = GREAT[case]
    (tmp_path / name).write_text(text())
    if words is None:
        assert len(pt.import_rig(tmp_path / name, reference=AXLE).rig) == 1, "the last link"
        return
    with pytest.raises(pe.InputError, match=words):
        pt.import_rig(tmp_path / name, reference=AXLE)


if __name__ == "__main__":
    import sys
    import tempfile
    from pathlib import Path

    for each in sorted({*RIG_FORMATS}):
        with tempfile.TemporaryDirectory() as there:
            refused = hunt(each, Path(there) / "rig", int(sys.argv[1]), int(sys.argv[2]))
            print(f"{each}: {refused} refused", flush=True)
