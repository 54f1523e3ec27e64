"""What takes a library to write, read back by that library: DXF, Rerun, Argoverse 2."""

import io
import math
import sys

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base import plugins
from pe_tools.exchange import rig_files
from pe_tools.outputs import scene_files

from .shapes import box_car, camera, lidar_on_roof, small_lidar

RIG = pe.Rig(
    [
        lidar_on_roof(small_lidar(), rotation=(1.0, -2.0, 30.0), name="roof top"),
        camera(70.0, position=(1.0, 0.5, 1.2), rotation=(5.0, 20.0, -130.0), name="eye"),
    ]
)
SPACE = pe.PerceptionSpace((-20, 20), (-20, 20), (0, 3), 0.5)
STUDY = pe.Study(RIG, box_car(), SPACE)
AXLE = pe.Reference(-1.3, 0.32)


def area(points):
    """Area inside a line that closes; the sign tells which way it runs."""
    a, b = points, np.roll(points, -1, axis=0)
    return float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()) / 2.0


@pytest.fixture(scope="module")
def drawing(example_plugin):
    ezdxf = pytest.importorskip("ezdxf", reason="of the example of a plugin")
    files, _ = scene_files(STUDY, "footprints-dxf", 20.0)
    assert files == scene_files(STUDY, "footprints-dxf", 20.0)[0], "the same bytes every time"
    return ezdxf.read(io.StringIO(files["footprints.dxf"].decode()))


def outlines(drawing, layer):
    lines = drawing.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
    assert all(line.closed for line in lines)
    return [np.array(line.get_points("xy")) for line in lines]


def test_the_dxf_is_sound_in_millimetres_a_layer_a_sensor(drawing):
    audit = drawing.audit()
    assert not audit.errors and not audit.fixes
    assert drawing.header["$INSUNITS"] == 4
    layers = {layer.dxf.name for layer in drawing.layers}
    assert {"VEHICLE", "BLIND_GROUND", "SENSOR_roof_top", "SENSOR_eye"} <= layers


def test_the_dxf_has_what_the_svg_has_in_millimetres(drawing):
    (body,) = outlines(drawing, "VEHICLE")
    assert area(body) == pytest.approx(4.6e3 * 1.8e3, rel=0.01)
    sensors = drawing.modelspace().query('CIRCLE[layer=="SENSOR_eye"]')
    assert tuple(sensors[0].dxf.center) == pytest.approx((1000.0, 500.0, 1200.0))
    (name,) = drawing.modelspace().query('TEXT[text=="eye"]')
    assert tuple(name.get_placement()[1]) == pytest.approx((1120.0, 620.0, 0.0))
    assert drawing.layers.get("BLIND_GROUND").rgb == (191, 31, 31)  # of 0.75, 0.12, 0.12
    ring = sum(area(line) for line in outlines(drawing, "SENSOR_roof_top"))
    assert 0.8 < ring / (math.pi * 20e3**2) < 1.0


@pytest.fixture(scope="module")
def recording(tmp_path_factory, example_plugin):
    rerun = pytest.importorskip("rerun.dataframe", reason="of the example of a plugin")
    path = tmp_path_factory.mktemp("rerun") / "scene.rrd"
    path.write_bytes(scene_files(STUDY, "rerun")[0]["scene.rrd"])
    return rerun.load_recording(path)


def logged(recording, entity, component):
    """What is logged of a component, as plain lists."""
    view = recording.view(index="log_time", contents=entity)
    (column,) = [
        c
        for c in recording.schema().component_columns()
        if c.entity_path == entity and c.component_name.endswith(f".{component}")
    ]
    (value,) = view.select_static(column).read_all().column(0).to_pylist()
    return value


@pytest.mark.parametrize(("sensor", "entity"), [*zip(RIG, ("roof_top", "eye"), strict=True)])
def test_a_recorded_sensor_stands_and_looks_as_the_sensor(recording, sensor, entity):
    own = f"/world/sensors/{entity}"
    (place,) = logged(recording, own, "Translation3D")
    assert place == pytest.approx(sensor.pose.position, abs=1e-6)
    (columns,) = logged(recording, own, "TransformMat3x3")
    turned = np.array(columns).reshape(3, 3).T  # column by column
    assert turned == pytest.approx(sensor.pose.ground_from_sensor, abs=1e-6)


def test_a_recorded_camera_is_a_pinhole_in_our_axes(recording):
    picture = "/world/sensors/eye/picture"
    (matrix,) = logged(recording, picture, "PinholeProjection")
    model = RIG["eye"].model
    expected = [[model.focal_px, 0, 960], [0, model.focal_px, 540], [0, 0, 1]]
    assert pytest.approx(np.array(expected), rel=1e-6) == np.array(matrix).reshape(3, 3).T
    forward_left_up = [[5, 4, 1]]  # of rerun's codes of directions
    assert logged(recording, picture, "ViewCoordinates") == forward_left_up
    assert logged(recording, picture, "Resolution") == [[1920.0, 1080.0]]


def test_edges_of_a_recorded_view_run_from_the_camera_to_the_corners_of_its_picture(recording):
    """In the sensor's own axes: a spoke leaves along each corner, whatever stops it."""
    border, *spokes = logged(recording, "/world/sensors/eye/view", "LineStrip3D")
    assert border[0] == border[-1] and len(spokes) == 8
    half = math.tan(math.radians(35.0))
    corners = {(y, z) for y in (half, -half) for z in (half * 1080 / 1920, -half * 1080 / 1920)}
    ends = np.array([end for start, end in spokes if np.allclose(start, 0.0)])
    for corner in corners:
        assert np.abs(ends[:, 1:] / ends[:, :1] - corner).max(axis=1).min() < 1e-5


def test_the_recording_has_vehicle_beams_maps_and_what_is_blind(recording):
    paths = {column.entity_path for column in recording.schema().component_columns()}
    wanted = "vehicle/body", "vehicle/cabin", "beams/roof_top", "ground/coverage"
    assert {f"/world/{each}" for each in (*wanted, "ground/entropy", "blind_volume")} <= paths
    body = np.array(logged(recording, "/world/vehicle/body", "Position3D"))
    assert body.min(axis=0) == pytest.approx([-2.3, -0.9, 0.2], abs=1e-6)
    beams = np.array(logged(recording, "/world/beams/roof_top", "LineStrip3D"))
    assert beams[:, 0] == pytest.approx(np.broadcast_to((-0.43, 0.0, 1.8), beams[:, 0].shape))
    assert beams[:, 1, 2].min() > -1e-6, "none ends under the ground"


def test_a_recording_of_too_many_beams_is_refused_before_they_are_asked(example_plugin):
    """Of ten million it took six gigabytes."""
    pytest.importorskip("rerun", reason="of the example of a plugin")
    great = pe.Lidar("great", np.radians(np.linspace(-20.0, 20.0, 1000)), 1001, 80.0)
    study = pe.Study(pe.Rig([pe.Sensor("roof", great, pe.Pose((0.0, 0.0, 2.0)))]))
    with pytest.raises(pe.InputError, match=r"at most 1,000,000 beams.*found 1,001,000"):
        scene_files(study, "rerun")
    assert "directions" not in vars(great), "they were never worked out"


def tables():
    feather = pytest.importorskip("pyarrow.feather", reason="of the extra argoverse")
    files, lines = rig_files(RIG, "argoverse2", AXLE)
    assert lines == ["left out of Argoverse 2: beams of roof top"]
    return {name: feather.read_table(io.BytesIO(data)) for name, data in files.items()}


def test_argoverse_s_tables_have_its_columns_and_say_their_conventions():
    poses, lenses = tables().values()
    assert poses.column_names == ["sensor_name", "qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"]
    expected = "sensor_name fx_px fy_px cx_px cy_px k1 k2 k3 height_px width_px"
    assert lenses.column_names == expected.split()
    assert b"rear axle at its height" in poses.schema.metadata[b"frame"]
    assert lenses.to_pylist()[0]["width_px"] == 1920 and len(lenses) == 1


def test_argoverse_s_own_projection_sees_a_point_where_ours_does():
    """As its PinholeCamera does: u ~ K (R' (p - t)), p from the rear axle."""
    poses, lenses = (table.to_pylist() for table in tables().values())
    row, lens = next(r for r in poses if r["sensor_name"] == "eye"), lenses[0]
    w, x, y, z = (row[key] for key in ("qw", "qx", "qy", "qz"))
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    sensor = RIG["eye"]
    seen = sensor.pose.ground_from_sensor @ [10.0, 2.0, -1.0] + sensor.pose.position
    ego = seen - (AXLE.rear_axle_x, 0.0, AXLE.rear_axle_z)
    right, down, depth = rotation.T @ (ego - [row["tx_m"], row["ty_m"], row["tz_m"]])
    u = lens["fx_px"] * right / depth + lens["cx_px"]
    v = lens["fy_px"] * down / depth + lens["cy_px"]
    f = sensor.model.focal_px
    assert (u, v) == pytest.approx((960.0 - 0.2 * f, 540.0 + 0.1 * f), abs=1e-6)


def test_distortion_in_an_argoverse_table_is_reported(tmp_path):
    feather = pytest.importorskip("pyarrow.feather", reason="of the extra argoverse")
    import pyarrow

    pt.export_rig(RIG, "argoverse2", tmp_path, AXLE)
    path = tmp_path / "intrinsics.feather"
    (row,) = feather.read_table(path).to_pylist()
    feather.write_feather(pyarrow.Table.from_pylist([{**row, "k1": -0.25}]), path)
    assert any(
        "k1, k2, k3 are not applied" in line for line in pt.import_rig(tmp_path, None, AXLE).lines
    )


@pytest.mark.parametrize(
    "damage", [lambda data: b"", lambda data: data[:200], lambda data: b"x" * 99]
)
def test_a_damaged_feather_table_is_refused_in_a_line(tmp_path, damage):
    pytest.importorskip("pyarrow", reason="of the extra argoverse")
    pt.export_rig(RIG, "argoverse2", tmp_path, AXLE)
    path = tmp_path / "intrinsics.feather"
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(pe.InputError, match="expected a feather table"):
        pt.import_rig(tmp_path, None, AXLE)


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_compressed_table_is_read_and_a_large_one_is_refused(compression, tmp_path):
    """A file of more than 100 kB, or of more rows than a rig has, is no calibration."""
    feather = pytest.importorskip("pyarrow.feather", reason="of the extra argoverse")
    import pyarrow

    pt.export_rig(RIG, "argoverse2", tmp_path, AXLE)
    path = tmp_path / "egovehicle_SE3_sensor.feather"
    feather.write_feather(feather.read_table(path), path, compression=compression)
    assert [s.name for s in pt.import_rig(tmp_path, None, AXLE).rig] == [s.name for s in RIG]
    for column in (np.arange(2e5), np.zeros(10**6)):
        table = pyarrow.table({"qw": pyarrow.array(column)})
        feather.write_feather(table, path, compression=compression)
        with pytest.raises(pe.InputError, match=r"at most 100,000 bytes|a feather table"):
            pt.import_rig(tmp_path, None, AXLE)


def test_offsets_that_lie_and_feather_s_first_version_are_refused_before_a_value_is_read(tmp_path):
    """A text that would begin before the table's own memory: reading it ended the process."""
    feather = pytest.importorskip("pyarrow.feather", reason="of the extra argoverse")
    pt.export_rig(RIG, "argoverse2", tmp_path, AXLE)
    path = tmp_path / "egovehicle_SE3_sensor.feather"
    whole = path.read_bytes()
    names = [each.name for each in RIG]
    offsets = np.cumsum([0, *map(len, names)]).astype("<i4").tobytes()
    assert whole.count(offsets) == 1, "where the texts of the names begin and end"
    lying = np.array([0, 1 << 30, (1 << 30) + 5], "<i4").tobytes()
    first = io.BytesIO()
    feather.write_feather(feather.read_table(path), first, version=1)
    for data in (whole.replace(offsets, lying), first.getvalue()):
        path.write_bytes(data)
        with pytest.raises(pe.InputError, match="expected a feather table"):
            pt.import_rig(tmp_path, None, AXLE)


@pytest.mark.parametrize("lacks", ["plugin", "library"])
def test_without_its_library_it_says_in_one_line_what_to_install(monkeypatch, lacks):
    for plugin in [name for name in plugins.SHIPPED if name.startswith("library.")]:
        if lacks == "plugin":
            monkeypatch.delitem(plugins.SHIPPED, plugin)
        else:
            monkeypatch.setitem(plugins.SHIPPED, plugin, "no_such_library:write")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(pe.InputError, match=r'"perception-entropy\[argoverse\]"') as told:
        rig_files(RIG, "argoverse2", AXLE)
    assert "\n" not in str(told.value) and len(str(told.value)) < 200
