"""What takes a library to write, read back by that library: DXF, Rerun, Argoverse 2."""

import io
import math

import numpy as np
import pytest

import pe_core as pe
from pe_tools.exchange import rig_files
from pe_tools.outputs import scene_files

from .shapes import box_car, camera, lidar_on_roof, small_lidar

pytestmark = pytest.mark.thorough
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
    a = points
    b = np.roll(points, -1, axis=0)
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


def test_the_recording_has_vehicle_beams_maps_and_what_is_blind(recording):
    paths = {column.entity_path for column in recording.schema().component_columns()}
    wanted = "vehicle/body", "vehicle/cabin", "beams/roof_top", "ground/coverage"
    assert {f"/world/{each}" for each in (*wanted, "ground/entropy", "blind_volume")} <= paths
    body = np.array(logged(recording, "/world/vehicle/body", "Position3D"))
    assert body.min(axis=0) == pytest.approx([-2.3, -0.9, 0.2], abs=1e-6)
    beams = np.array(logged(recording, "/world/beams/roof_top", "LineStrip3D"))
    assert beams[:, 0] == pytest.approx(np.broadcast_to((-0.43, 0.0, 1.8), beams[:, 0].shape))
    assert beams[:, 1, 2].min() > -1e-6, "none ends under the ground"


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
    row = next(r for r in poses if r["sensor_name"] == "eye")
    lens = lenses[0]
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
