"""Which camera shows the ground where: by every camera alone, and by each lens's own projection."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring.sight import NO_CAMERA, VEHICLE, Sight, outlines
from pe_core.scoring.sight.blind_ground import BODY_M
from pe_core.sensors import KannalaBrandt
from tests.engine import shapes

SPACE = pe.PerceptionSpace((-10, 10), (-10, 10), (0, 2), 0.1)
BOX = pe.Vehicle(shapes.box((-2.0, -0.8, 0.3), (2.0, 0.8, 1.2)))
FISHEYE = KannalaBrandt(fx=110.0, fy=112.0, cx=250.0, cy=150.0, fov=None, k1=-0.02, k2=0.001)
WIDE = pe.Camera("wide", 500, 300, lens=FISHEYE)
NARROW = pe.Camera("narrow", 1920, 1080, hfov=np.radians(40.0))


def camera(name, model, place, turn_deg):
    return pe.Sensor(name, model, pe.Pose.from_degrees(place, turn_deg))


RIG = pe.Rig(
    [
        camera("front", WIDE, (2.1, 0.0, 0.7), (0.0, 25.0, 0.0)),
        camera("tele", NARROW, (2.0, 0.0, 1.5), (0.0, 20.0, 0.0)),
        pe.Sensor(
            "roof", pe.Lidar("ring", np.radians([-15.0, 0.0]), 720, 60.0), pe.Pose((0, 0, 1.5))
        ),
        camera("left", WIDE, (0.5, 0.9, 1.0), (0.0, 45.0, 90.0)),
    ]
)
CAMERAS = pe.Rig([each for each in RIG if each.kind == "camera"])


@pytest.fixture(scope="module")
def look():
    return Sight(SPACE, pe.Prior.road(), BOX)


@pytest.fixture(scope="module")
def view(look):
    return look.surround_view(RIG, 5.0)


def test_blind_is_what_is_blind_to_the_cameras_to_the_bit(look, view):
    expected = look.blind(CAMERAS, 0.0, 5.0)
    found = outlines(view.blind.astype(float), 0.5, view.x, view.y)
    assert view.area == expected.area > 1.0
    assert len(found) == len(expected.outlines)
    assert all((a == b).all() for a, b in zip(found, expected.outlines, strict=True))
    assert look.blind(RIG, 0.0, 5.0).area <= view.area
    assert (view.camera[view.blind] == NO_CAMERA).all()


def test_a_square_is_of_the_camera_with_the_most_pixels_per_metre_of_those_that_see_it(look, view):
    assert view.cameras == ("front", "tele", "left")
    x, y = np.meshgrid(view.x, view.y, indexing="ij")
    most = np.zeros(view.camera.shape)
    first = np.full(view.camera.shape, NO_CAMERA)
    for number, name in enumerate(view.cameras):
        sensor = RIG[name]
        alone = look.surround_view(pe.Rig([RIG[name]]), 5.0)
        assert set(np.unique(alone.camera)) == {VEHICLE, NO_CAMERA, 0}
        assert ((alone.camera == NO_CAMERA) == alone.blind)[alone.camera != VEHICLE].all()
        a, b, c = sensor.pose.position
        focal = sensor.model.focal_px
        pixels = np.where(alone.camera == 0, focal / np.sqrt((x - a) ** 2 + (y - b) ** 2 + c**2), 0)
        first[pixels > most] = number
        most = np.maximum(most, pixels)
    outside = view.camera != VEHICLE
    differ = (first != view.camera) & outside
    assert differ.mean() < 1e-4, "but for ties on the bisector of two equal ones"
    assert all((view.camera == number).sum() > 1000 for number in range(3))
    assert (
        outside[np.abs(x) > 2.0].all() and not outside[(np.abs(x) < 1.9) & (np.abs(y) < 0.7)].any()
    )


def test_no_square_is_of_a_camera_whose_picture_has_nothing_of_a_body_there(view):
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    disc = np.column_stack([np.cos(turn), np.sin(turn)]) * (BODY_M + view.step)
    disc = np.vstack([[[0.0, 0.0]], disc / 2.0, disc])
    for number, name in enumerate(view.cameras):
        i, j = (w[::7] for w in np.nonzero(view.camera == number))
        points = np.column_stack([view.x[i], view.y[j]])[:, None] + disc
        offsets = np.concatenate([points, np.zeros((*points.shape[:2], 1))], axis=2)
        sensor = RIG[name]
        along = (offsets - sensor.pose.position) @ sensor.pose.ground_from_sensor
        lens = sensor.model.projection
        right, down = lens.project(*np.moveaxis(along, 2, 0))
        inside = (right >= 0) & (right <= sensor.model.width) & (along[..., 0] > -1.0)
        inside &= (down >= 0) & (down <= sensor.model.height)
        assert inside.any(axis=1).all(), name


def test_a_rig_without_a_camera_has_no_surround_view(look):
    with pytest.raises(pe.InputError, match="surround view"):
        look.surround_view(pe.Rig([RIG["roof"]]))
