"""Pictures: ego masks and ranges, held to rays; the PNG files they go into."""

import json
import math
import struct
import zlib

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.catalog import load
from pe_core.sensors import BrownConrady, Camera, FTheta, KannalaBrandt, Lidar, range_picture
from pe_core.sensors.field_of_view import FREE
from pe_tools.outputs import masks, scene_files

TRIANGLES = np.array(
    [  # a wall on the left of the view, a pane ahead on the right, a rod thinner than a pixel
        [[2.0, 0.3, 0.0], [2.0, 3.0, 0.0], [2.0, 0.3, 3.0]],
        [[2.0, 3.0, 0.0], [2.0, 3.0, 3.0], [2.0, 0.3, 3.0]],
        [[2.0, -1.0, 0.0], [2.0, -0.2, 0.0], [2.0, -0.2, 3.0]],
        [[1.5, -0.1, 0.0], [1.5, -0.104, 0.0], [1.5, -0.1, 3.0]],
    ]
)
BODY = pe.Vehicle(TRIANGLES, [0, 0, 1, 2], ["wall", "pane", "rod"], ["pane"])
LENSES = (
    None,
    BrownConrady(50.0, 50.0, 32.0, 18.0, k1=-0.2),
    KannalaBrandt(22.0, 22.0, 32.0, 18.0, fov=math.radians(150)),
    FTheta(22.0, 22.0, 32.0, 18.0, k1=1.0) if "k1" in FTheta.coefficients else None,
)


WALL = pe.Vehicle(
    np.array(
        [  # a wall across, 2 m ahead, 4 m wide, from the ground up to 3 m
            [[2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 2.0, 3.0]],
            [[2.0, -2.0, 0.0], [2.0, 2.0, 3.0], [2.0, -2.0, 3.0]],
        ]
    )
)


def ego_mask(sensor, vehicle):
    return masks.MASKS[sensor.kind](sensor, vehicle)


def camera(lens=None, width=64, height=36):
    if lens is None:
        return Camera("eye", width, height, math.radians(90.0))
    return Camera("eye", width, height, lens=lens)


def mounted(model, rpy=(0.1, 0.05, 0.2)):
    return pe.Sensor("eye/left", model, pe.Pose((0.0, 0.0, 1.2), rpy))


@pytest.mark.parametrize("lens", LENSES)
def test_each_pixel_is_the_ray_through_its_middle(lens, monkeypatch):
    """One ray at a time, from first hits; rows are also cast some at a time."""
    monkeypatch.setattr(masks, "RAYS_AT_ONCE", 64 * 7)
    sensor = mounted(camera(lens))
    parts = ego_mask(sensor, BODY).parts
    axes = sensor.pose.ground_from_sensor
    lens = sensor.model.projection
    kinds = set()
    for row, column in np.random.default_rng(0).integers(0, (36, 64), (300, 2)).tolist():
        way = lens.unproject(np.array([column + 0.5]), np.array([row + 0.5]))
        if np.isnan(way).any():
            expected = masks.OUTSIDE
        else:
            hit = BODY.first_hit(sensor.pose.position, way @ axes.T, through_glass=True)
            expected = -1 if hit.face[0] < 0 else int(BODY.parts[hit.face[0]])
        assert parts[row, column] == expected
        kinds.add(expected)
    assert {-1, 0} <= kinds and 1 not in kinds  # cameras see through the pane


def test_each_beam_is_its_first_hit():
    lidar = Lidar("toy", np.radians([-10.0, 0.0, 15.0]), 360, 2.5)
    sensor = mounted(lidar)
    mask = ego_mask(sensor, BODY)
    assert mask.parts.shape == (3, 360)
    for row, e in enumerate(mask.elevations.tolist()):
        a = mask.azimuths
        own = np.stack(
            [math.cos(e) * np.cos(a), math.cos(e) * np.sin(a), np.full(360, math.sin(e))]
        )
        hit = BODY.first_hit(sensor.pose.position, own.T @ sensor.pose.ground_from_sensor.T)
        expected = np.where(hit.distance < 2.5, BODY.parts[hit.face], FREE)
        np.testing.assert_array_equal(mask.parts[row], expected)
    assert mask.elevations[0] > mask.elevations[-1] and mask.azimuths[0] > mask.azimuths[-1]
    assert 1 in mask.parts  # glass stops beams


def study(vehicle=BODY):
    models = {"eye/left": camera(LENSES[2]), "top": load("Velodyne VLP-16 Puck")}
    poses = pe.Pose((0.0, 0.0, 1.2)), pe.Pose((0.0, 0.0, 1.3))
    pairs = zip(models.items(), poses, strict=True)
    return pe.Study(pe.Rig([pe.Sensor(n, m, p) for (n, m), p in pairs]), vehicle)


def test_files_say_what_the_arrays_do():
    files, lines = scene_files(study(), "masks")
    assert set(files) == {"masks.json", "eye_left_mask.png", "top_mask.png", "top_mask.csv"}
    assert lines == ["eye/left: called eye_left in names of files"]
    told = {each["sensor"]: each for each in json.loads(files["masks.json"])["masks"]}
    for sensor in study().rig:
        mask = ego_mask(sensor, BODY)
        own = told[sensor.name]
        pixels = decoded(files[own["file"]])[..., 0]
        assert (own["height"], own["width"]) == pixels.shape
        np.testing.assert_array_equal(pixels, np.where(mask.sees_out, 255, 0))
        stopped = (mask.parts >= 0).mean()
        assert told[sensor.name]["occluded_share"] == pytest.approx(stopped, abs=1e-6)
        assert sum(told[sensor.name]["by_part"].values()) == pytest.approx(stopped, abs=1e-5)
    assert told["eye/left"]["outside_share"] > 0.0
    assert told["eye/left"]["rays_by_part"].keys() <= {"wall", "rod"}


def lidar(elevations_deg, azimuths=4, max_range=50.0, fov=(-180, 180)):
    table = {"kind": "lidar", "elevations_deg": elevations_deg, "azimuth_count": azimuths}
    return catalog.from_table(
        "toy", table | {"max_range_m": max_range, "horizontal_fov_deg": list(fov)}
    )


def test_by_hand():
    """1 m above the ground: down 45 degrees it is sqrt 2 away, or 2 sqrt 2 to a wall 2 m ahead."""
    sensor = pe.Sensor("toy", lidar([-45, 0]), pe.Pose((0.0, 0.0, 1.0)))
    picture = range_picture(sensor, WALL)
    assert np.degrees(picture.elevations) == pytest.approx([0, -45])
    assert np.degrees(picture.azimuths) == pytest.approx([180, 90, 0, -90])
    level, down = picture.distance
    assert level == pytest.approx([math.inf, math.inf, 2.0, math.inf])
    assert down == pytest.approx([math.sqrt(2)] * 4)  # the ground comes before the wall
    assert picture.occluded.tolist() == [[False, False, True, False], [False] * 4]


@pytest.mark.parametrize("model", ["Hesai AT128E2X", "Velodyne VLP-16 Puck", "RoboSense RS-Bpearl"])
def test_each_pixel_is_its_beam_s_first_hit(model):
    """Beam by beam, from directions worked out anew, turned and tilted."""
    sensor = pe.Sensor("it", catalog.load(model), pe.Pose((0.3, 0.2, 1.1), (0.1, 0.2, 0.4)))
    picture = range_picture(sensor, WALL)
    rng = np.random.default_rng(0)
    offsets = dict(zip(sensor.model.elevations, sensor.model.azimuth_offsets, strict=True))
    turned = sensor.pose.ground_from_sensor
    seen = set()
    for row, column in rng.integers(0, picture.distance.shape, (300, 2)).tolist():
        e = picture.elevations[row]
        a = picture.azimuths[column] + offsets[e]
        beam = turned @ [math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)]
        body = WALL.first_hit(sensor.pose.position, beam[None]).distance[0]
        ground = 1.1 / -beam[2] if beam[2] < 0 else math.inf
        nearest = min(body, ground)
        expected = nearest if nearest <= sensor.model.max_range else math.inf
        assert picture.distance[row, column] == pytest.approx(expected, rel=1e-9)
        assert picture.occluded[row, column] == (body <= ground and expected < math.inf)
        seen.add((bool(picture.occluded[row, column]), expected < math.inf))
    assert (True, True) in seen  # some met the wall


def test_things_end_beams_unless_something_is_before_them():
    """A box ahead of the wall, one behind it, and one on the left, 5 m away."""
    boxes = [WALL.triangles + np.array([dx, 0.0, 0.0]) for dx in (-1.0, 1.0)]
    left = WALL.triangles[..., [1, 0, 2]] + np.array([0.0, 3.0, 0.0])
    parts = np.repeat([0, 1, 2], 2)
    things = pe.Vehicle(np.concatenate([*boxes, left]), parts, ["before", "behind", "left"])
    sensor = pe.Sensor("toy", lidar([0, -45]), pe.Pose((0.0, 0.0, 1.0)))
    picture = range_picture(sensor, WALL, things)
    assert picture.things[0].tolist() == [-1, 2, 0, -1]  # behind, left, ahead, right
    assert picture.distance[0] == pytest.approx([math.inf, 5.0, 1.0, math.inf])
    assert not picture.occluded.any()
    assert range_picture(sensor, WALL, pe.Vehicle(boxes[1])).occluded[0].tolist()[2]


def chunks(png):
    """Names and contents of a file's chunks, their sums checked."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at = 8
    found = []
    while at < len(png):
        (size,) = struct.unpack(">I", png[at : at + 4])
        name = png[at + 4 : at + 8]
        data = png[at + 8 : at + 8 + size]
        (told,) = struct.unpack(">I", png[at + 8 + size : at + 12 + size])
        assert told == zlib.crc32(name + data)
        found.append((name, data))
        at += 12 + size
    return found


def decoded(png):
    """Pixels (H, W, channels) of a file of eight bits, one byte after the other."""
    parts = dict(chunks(png))
    width, height, depth, kind, *rest = struct.unpack(">IIBBBBB", parts[b"IHDR"])
    assert depth == 8 and rest == [0, 0, 0]
    n = {0: 1, 2: 3, 3: 1, 6: 4}[kind]
    lines = np.frombuffer(zlib.decompress(parts[b"IDAT"]), np.uint8).reshape(height, -1).tolist()
    above = [0] * (width * n)
    rows = []
    for number, *line in lines:
        row = []
        for k, value in enumerate(line):
            left, corner = (row[k - n], above[k - n]) if k >= n else (0, 0)
            up = above[k]
            guess = left + up - corner
            nearest = min((left, up, corner), key=lambda v: abs(guess - v))
            row.append((value + (0, left, up, (left + up) // 2, nearest)[number]) % 256)
        rows.append(row)
        above = row
    return np.array(rows, np.uint8).reshape(height, width, n)
