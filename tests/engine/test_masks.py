"""Ego masks, held to the plain definition: the ray through every pixel's middle, beam by beam."""

import csv
import io
import json
import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.catalog import load
from pe_core.sensors import BrownConrady, Camera, FTheta, KannalaBrandt, Lidar, kind_of
from pe_core.sensors.camera import picture
from pe_core.sensors.field_of_view import FREE, OUTSIDE
from pe_core.study import save_study
from pe_tools.cli.verbs import main
from pe_tools.outputs import scene_files
from tests.engine.test_png import decoded

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


def ego_mask(sensor, vehicle):
    return kind_of(sensor).ego_mask(sensor, vehicle)


def camera(lens=None, width=64, height=36):
    if lens is None:
        return Camera("eye", width, height, math.radians(90.0))
    return Camera("eye", width, height, lens=lens)


def mounted(model, rpy=(0.1, 0.05, 0.2)):
    return pe.Sensor("eye/left", model, pe.Pose((0.0, 0.0, 1.2), rpy))


@pytest.mark.parametrize("lens", LENSES)
def test_each_pixel_is_the_ray_through_its_middle(lens, monkeypatch):
    """One ray at a time, from first hits; rows are also cast some at a time."""
    monkeypatch.setattr(picture, "RAYS_AT_ONCE", 64 * 7)
    sensor = mounted(camera(lens))
    parts = ego_mask(sensor, BODY).parts
    axes, lens = sensor.pose.ground_from_sensor, sensor.model.projection
    kinds = set()
    for row, column in np.random.default_rng(0).integers(0, (36, 64), (300, 2)).tolist():
        way = lens.unproject(np.array([column + 0.5]), np.array([row + 0.5]))
        if np.isnan(way).any():
            expected = OUTSIDE
        else:
            hit = BODY.first_hit(sensor.pose.position, way @ axes.T, through_glass=True)
            expected = -1 if hit.face[0] < 0 else int(BODY.parts[hit.face[0]])
        assert parts[row, column] == expected
        kinds.add(expected)
    assert {-1, 0} <= kinds and 1 not in kinds  # cameras see through the pane


def test_left_is_left_and_up_is_up():
    """The wall is on the left; a roof above is in the upper rows."""
    level = ego_mask(mounted(camera(), (0.0, 0.0, 0.0)), BODY)
    assert (level.parts[18, :20] == 0).all() and (level.parts[18, 40:] == FREE).all()
    roof = np.array([[[-9.0, -9.0, 2.0], [9.0, -9.0, 2.0], [0.0, 20.0, 2.0]]])
    above = ego_mask(mounted(camera(), (0.0, 0.0, 0.0)), pe.Vehicle(roof))
    assert not above.sees_out[0, 32] and above.sees_out[-1, 32]


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
    assert set(files) == {
        *("masks.json", "occluded_by_part.csv", "eye_left_mask.png"),
        *("top_mask.png", "top_mask.csv"),
    }
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
    rows = list(csv.DictReader(io.StringIO(files["occluded_by_part.csv"].decode())))
    assert {row["part"] for row in rows if row["sensor"] == "eye/left"} <= {"wall", "rod"}
    assert int(rows[0]["rays"]) == told["eye/left"]["rays_by_part"][rows[0]["part"]]


def test_a_lidar_s_table_is_its_picture():
    files, _ = scene_files(study(), "masks")
    head, *rows = csv.reader(io.StringIO(files["top_mask.csv"].decode()))
    assert float(head[1]) == 180.0 and [float(row[0]) for row in rows][:2] == [15.0, 13.0]
    values = np.array([row[1:] for row in rows], int) * 255
    np.testing.assert_array_equal(values, decoded(files["top_mask.png"])[..., 0])


def test_without_a_vehicle_all_is_white_and_said():
    files, lines = scene_files(study(None), "masks")
    assert "the study has no vehicle: masks are white" in lines
    assert decoded(files["top_mask.png"]).min() == 255
    assert files["occluded_by_part.csv"].decode() == "sensor,part,rays,share\n"


def test_the_command_writes_them_and_replaces_nothing_unasked(tmp_path, capsys):
    save_study(study(None), tmp_path / "study.toml")
    line = ["export", str(tmp_path / "study.toml"), "--to", "masks", "-o", str(tmp_path / "out")]
    assert main(line) == 0 and (tmp_path / "out" / "top_mask.png").is_file()
    assert "no vehicle" in capsys.readouterr().err
    (tmp_path / "out" / "top_mask.png").write_text("mine")
    assert main(line) == 1 and "an existing file" in capsys.readouterr().err
    assert (tmp_path / "out" / "top_mask.png").read_text() == "mine"
    assert main([*line, "--replace"]) == 0
    (tmp_path / "file").write_text("")
    assert main([*line[:-1], str(tmp_path / "file")]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()[-1:]) == 1


def test_a_picture_of_too_many_pixels_is_refused_before_a_ray_is_cast(monkeypatch):
    monkeypatch.setattr(Camera, "projection", property(lambda self: pytest.fail("rays are cast")))
    model = Camera("c", 1_000_000, 51, math.radians(60.0))
    sensor = pe.Sensor("wide", model, pe.Pose((0, 0, 1)))
    words = "wide: mask: expected at most 50,000,000 pixels or beams, found 51,000,000"
    with pytest.raises(pe.InputError, match=words):
        ego_mask(sensor, BODY)
