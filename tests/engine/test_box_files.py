"""Files of labelled boxes: what each layout says, studies of them, a line for whatever is wrong."""

import json
import math

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.formats.boxes.kitti import CAMERA
from tests.engine.refusals import wrongly_refused
from tests.engine.test_study_file import MINIMAL

CSV = """class,x,y,z,length,width,height,yaw
car,10,2,0.75,4.5,1.8,1.5,90
tram,-20.5,-3,1.8,15,2.5,3.6,-45
"""

KITTI = """\
Car 0.00 0 1.85 387.63 181.54 423.81 203.12 1.50 1.80 4.50 -2.00 1.65 10.00 -1.5707963267948966
Pedestrian 0.00 0 0 0 0 1 1 1.75 0.60 0.80 3.00 1.60 20.00 0.0 0.91
Van 0.00 0 0 0 0 1 1 2.2 1.9 5.0 0 1.65 30 0
DontCare -1 -1 -10 503.89 169.71 590.61 190.13 -1 -1 -1 -1000 -1000 -1000 -10
Tram 0 0 0 0 0 1 1 3.5 2.5 15 0 1.65 40 0
Misc 0 0 0 0 0 1 1 1.5 1.5 3 0 1.65 40 0
Tram 0 0 0 0 0 1 1 3.5 2.5 15 5 1.65 40 0
"""
AS_MET = [
    CSV.replace("\n", "\r\n", 1).replace("90\n", "90\r"),
    "\ufeff" + CSV,
    CSV.replace(",", ";"),
    CSV.replace(",", " , "),
    "\n# made by hand\n" + CSV + "\n\n",
    CSV.replace("class,x,y,z,length", "Class,X (m),y_m,Z [m],LENGTH").replace("yaw", "yaw_deg"),
    "score,yaw,z,y,x,height,width,length,class\n"
    "0.9,90,0.75,2,10,1.5,1.8,4.5,car\n,-45,1.8,-3,-20.5,3.6,2.5,15,tram\n",
]
STUDY = f"""
[space]
x = [-25, 25]
y = [-10, 10]
z = [0, 4]
interval = 0.5
[prior]
boxes = "labels"
[[prior.focus]]
factor = 2.0
classes = ["pedestrian"]
{MINIMAL}"""
BAD_PRIORS = [
    ("{}/none.csv", ('"labels"', '"none.csv"')),
    ("prior.boxes", ('"labels"', "3")),
    ("prior.model", ('"labels"', '"labels"\nmodel = "road"')),
    ("prior.classes", ('"labels"', '"labels"\nclasses = []')),
    ("prior.origin", ('"labels"', '"labels"\norigin = [1, 2]')),
    ("prior.origin", ('"labels"', '"labels"\norigin = [1, 2, inf]')),
    ("prior.focus.classes", ("pedestrian", "truck")),
    ("prior.origin", ('boxes = "labels"', "origin = [1, 2, 3]")),
    ("{}/wrong: line 2", ('"labels"', '"wrong"')),
]


def nuscenes_box(name="vehicle.car", **change):
    """A box 10 m ahead and 2 m to the left, turned by 90 degrees."""
    box = {
        "category_name": name,
        "translation": [10.0, 2.0, 0.75],
        "size": [1.8, 4.5, 1.5],
        "rotation": [math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)],
    }
    return {**box, **change}


@pytest.fixture
def write(tmp_path):
    def to_file(data, name="labels"):
        path = tmp_path / name
        if not isinstance(data, (bytes, str)):
            data = json.dumps(data)
        path.write_bytes(data.encode() if isinstance(data, str) else data)
        return path

    return to_file


def row(table, index):
    """A box's centre, sizes and yaw [deg]."""
    columns = ("x", "y", "z", "length", "width", "height")
    values = [float(getattr(table, c)[index]) for c in columns]
    return [*values, math.degrees(table.yaw[index])]


def test_csv_as_it_is_met(write):
    """Mixed line ends, a byte order mark, other separators, comments, units, columns anywhere."""
    plain = pt.read_boxes(write(CSV, "plain"))
    texts = [*AS_MET, *(f"sep={s}\n{CSV.replace(',', s)}" for s in ";\t,"), CSV.encode("utf-16")]
    assert [text for text in texts if pt.read_boxes(write(text)) != plain] == []


def test_kitti_is_turned_from_the_camera_to_the_ground(write):
    table = pt.read_boxes(write(KITTI))
    assert list(table.names) == ["car", "pedestrian", "car"]
    x, y, z = CAMERA
    assert row(table, 0) == pytest.approx([10 + x, 2 + y, -1.65 + 0.75 + z, 4.5, 1.8, 1.5, 0])
    assert table.z[0] == pytest.approx(0.75)  # the camera stands 1.65 m above the ground
    assert row(table, 1) == pytest.approx([20 + x, -3, 0.05 + 0.875, 0.8, 0.6, 1.75, -90])
    assert dict(table.left_out) == {
        "marked DontCare": 1,
        "of unknown class 'Tram'": 2,
        "of unknown class 'Misc'": 1,
    }


def test_kitti_tracking_has_frame_and_id_in_front(write):
    lines = [f"{i} {7 - i} {line}" for i, line in enumerate(KITTI.splitlines())]
    tracking = pt.read_boxes(write("\n".join(lines)))
    assert tracking == pt.read_boxes(write(KITTI, "object"))
    assert tracking.left_out == pt.read_boxes(write(KITTI, "object")).left_out


def test_the_origin_of_labels_can_be_said(write):
    path = write(KITTI)
    at = pe.Prior.from_boxes(pt.read_boxes(path, (1.5, 0.5, 1.6))).boxes
    assert row(at, 0)[:3] == pytest.approx([11.5, 2.5, 0.7])
    assert row(pt.read_boxes(write(CSV), (-1.0, 0.0, 0.1)), 0)[:3] == pytest.approx([9, 2, 0.85])


def test_a_folder_is_read_in_the_order_of_names(tmp_path):
    first, second = KITTI.splitlines(keepends=True)[:2]
    for name, text in (("000010.txt", second), ("000002.txt", first), ("000003.txt", "\n")):
        (tmp_path / name).write_text(text)
    (tmp_path / ".hidden").write_text("not labels")
    (tmp_path / "more").mkdir()
    assert list(pt.read_boxes(tmp_path).names) == ["car", "pedestrian"]
    (tmp_path / "000011.txt").write_text(first.replace("1.50", "x"))
    with pytest.raises(pe.InputError, match=r"000011\.txt: line 1: .*the height, found 'x'"):
        pt.read_boxes(tmp_path)
    with pytest.raises(pe.InputError, match="more: folder: expected files with labels, found none"):
        pt.read_boxes(tmp_path / "more")


def test_nuscenes_annotations(write):
    trucks = ["bus.rigid", "bus.bendy", "truck", "trailer", "construction", "emergency.ambulance"]
    names = {
        "vehicle.car": "car",
        **{f"vehicle.{name}": "truck" for name in trucks},
        "vehicle.emergency.police": "car",
        **{f"human.pedestrian.{name}": "pedestrian" for name in ("adult", "wheelchair")},
        **{f"vehicle.{name}": "cyclist" for name in ("bicycle", "motorcycle")},
        "movable_object.trafficcone": "cone",
        **dict.fromkeys(("movable_object.barrier", "static_object.bicycle_rack", "animal")),
    }
    table = pt.read_boxes(write([nuscenes_box(name) for name in names]))
    assert list(table.names) == [ours for ours in names.values() if ours]
    assert row(table, 0) == pytest.approx([10, 2, 0.75, 4.5, 1.8, 1.5, 90])
    assert dict(table.left_out) == {
        f"of unknown class '{theirs}'": 1 for theirs, ours in names.items() if not ours
    }


def test_nuscenes_results(write):
    def detected(name):
        box = nuscenes_box(detection_name=name, detection_score=0.4)
        del box["category_name"]
        return box

    data = {
        "meta": {"use_lidar": True},
        "results": {
            "token1": [detected("traffic_cone"), detected("construction_vehicle")],
            "token2": [],
            "token3": [detected("barrier"), detected("pedestrian")],
        },
    }
    table = pt.read_boxes(write(data))
    assert list(table.names) == ["cone", "truck", "pedestrian"]
    assert dict(table.left_out) == {"of unknown class 'barrier'": 1}


def changed(text, old, new):
    assert old in text
    return text.replace(old, new)


BAD = [
    ("file", ""),
    ("file", b"\x89PNG\r\n\x1a\n\0\0\0"),
    ("line 1", "samples = 0\n[space]\n"),
    ("line 1", "car,10,2,0.75,4.5,1.8,1.5,90\n"),
    ("line 1", changed(CSV, "yaw", "angle")),
    ("line 1", changed(CSV, "yaw", "x")),
    ("line 2", changed(CSV, ",90", "")),
    ("line 2", changed(CSV, ",90", ",90,1")),
    ("line 3", changed(CSV, "-3", "left")),
    ("line 3", changed(CSV, "-3", "nan")),
    ("line 3", changed(CSV, "1.8,15", "1.8,0")),
    ("line 3", changed(CSV, "3.6", "-3.6")),
    ("line 3", changed(CSV, "-20.5", "1e12")),
    ("line 3", changed(CSV, "tram", "")),
    ("boxes", "class,x,y,z,length,width,height,yaw\n"),
    ("line 2", changed(KITTI, " 0.91", " 0.91 1")),
    ("line 1", changed(KITTI, "Car 0.00 ", "Car ")),
    ("line 1", changed(KITTI, "1.50", "nan")),
    ("line 1", changed(KITTI, "1.50", "0")),
    ("line 1", " ".join(["1"] * 17)),
    ("boxes", KITTI.splitlines()[3]),
    ("line 1", "[{]"),
    ("line 3", "[\n{},\n}"),
    ("file", {"results": []}),
    ("results[t]", {"results": {"t": {}}}),
    ("boxes", []),
    ("[0]", [1]),
    ("[0]", [{}]),
    ("[0].category_name", [nuscenes_box(3)]),
    ("boxes", [nuscenes_box("animal")]),
    ("[1].size", [nuscenes_box(), nuscenes_box(size=[1, 2])]),
    ("[0]", [nuscenes_box(size=[1, 0, 1])]),
    ("[0].translation", [nuscenes_box(translation=[1, math.nan, 1])]),
    ("[0].rotation", [nuscenes_box(rotation=[0, 0, 0, 0])]),
    ("[0].rotation", [nuscenes_box(rotation=None)]),
]


def test_bad_files_are_refused_by_their_line(write, tmp_path):
    assert wrongly_refused(lambda data: pt.read_boxes(write(data)), BAD, tmp_path) == []


def test_a_column_of_tracks_is_no_column_of_classes(tmp_path):
    """300 names took 7 GB, and a score of each."""
    path = tmp_path / "labels.csv"
    rows = [f"track {n},10,2,0.75,4.5,1.8,1.5,90" for n in range(300)]
    path.write_text("\n".join([CSV.splitlines()[0], *rows]))
    with pytest.raises(pe.InputError) as error:
        pt.read_boxes(path)
    assert (error.value.field, error.value.found) == ("class", "300")
    path.write_text("\n".join([CSV.splitlines()[0], *rows[:64]]))
    assert len(pt.read_boxes(path).classes) == 64


@pytest.mark.parametrize(("name", "table"), [("study", "boxes.csv"), ("other", "other.boxes.csv")])
def test_an_exported_study_scores_the_same_bits_elsewhere(write, tmp_path, name, table):
    write(KITTI)
    placed = changed(STUDY, '"labels"', '"labels"\norigin = [1.5, 0.25, 1.61]')
    study = pe.load_study(write(placed, "s.toml"))
    name = f"{name}.toml"
    (tmp_path / "out").mkdir()
    pt.export_study(study, tmp_path / "out" / name)
    expected = sorted([".perception-entropy.json", name, table])
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == expected
    (tmp_path / "labels").unlink()
    copy = pe.load_study(tmp_path / "out" / name)
    assert copy.prior.boxes.file == table and copy.prior.boxes == study.prior.boxes
    for each in (0, 4096):
        scores = [s.evaluator(each).score(s.rig).to_dict() for s in (study, copy)]
        assert scores[0] == scores[1]


def test_bad_priors_of_boxes_are_refused(write, tmp_path):
    write(KITTI)
    write(changed(KITTI, "1.75", "-1"), "wrong")

    def loaded(change):
        pe.load_study(write(changed(STUDY, *change), "study.toml"))

    rows = [(field.format(tmp_path), change) for field, change in BAD_PRIORS]
    assert wrongly_refused(loaded, rows, tmp_path / "study.toml") == []
