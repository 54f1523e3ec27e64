"""A random rig goes out in each format and comes back: poses and kinds by all, lenses and models as
far as the tables here say; what does not come back is said."""

import math

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.sensors.camera import BrownConrady, Camera, FTheta, KannalaBrandt, Pinhole
from pe_tools.exchange import RIG_FORMATS

AXLE = pe.Reference(-1.31, 0.33)
WITHIN = 1e-6
WIDTH = 1920
HEIGHT = 1080
PLACE = {"fx": 929.8429, "fy": 930.0592, "cx": 972.1794, "cy": 508.0057}
LENSES = {
    "pinhole": Pinhole(**PLACE),
    "radial": BrownConrady(**PLACE, k1=-0.29, k2=0.08, k3=-0.001),
    "brown": BrownConrady(**PLACE, k1=-0.165, k2=0.0099, p1=-0.00075, p2=5.37e-05, k3=0.01),
    "rational": BrownConrady(
        **PLACE, k1=0.3, k2=0.02, p1=1e-4, p2=-2e-4, k3=1e-3, k4=0.5, k5=0.04, k6=2e-3
    ),
    "fisheye": KannalaBrandt(
        fx=500.0, fy=501.0, cx=960.5, cy=540.5, fov=None, k1=0.02, k2=-0.003, k3=1e-4, k4=-1e-5
    ),
    "edge": KannalaBrandt(fx=500.0, fy=500.0, cx=960.0, cy=540.0, fov=math.radians(190.0)),
    "angles": FTheta(
        fx=1.0, fy=1.0, cx=960.5, cy=540.5, fov=None, k1=560.0, k2=-30.0, k3=40.0, k4=-7.0
    ),
}
OPENCV = {"pinhole", "radial", "brown", "rational", "fisheye"}
KEEPS = {
    "csv": set(LENSES),
    "urdf": {"pinhole", "radial", "brown"},
    "ros": OPENCV,
    "autoware": OPENCV,
    "nuscenes": {"pinhole", "radial", "brown"},
    "argoverse2": {"pinhole"},
    "driveworks": {"pinhole", "radial", "angles"},
    "carla": set(),
    "kitti": {"pinhole"},
    "osi": set(),
    "usd": OPENCV,
}
"""Lenses that come back to the last figure, by format."""
HOLDS = {
    "csv": {"model", "table", "ranges", "fusion"},
    "urdf": {"model", "table", "even", "ranges", "fusion"},
    "autoware": {"model"},
    "driveworks": {"model"},
    "carla": {"even", "field"},
    "osi": {"even", "uneven", "field"},
    "usd": {"model", "table", "even", "uneven", "ranges", "fusion"},
}
"""What else comes back: a catalogued model, a radar's own table, channels of an own LiDAR."""
WITHOUT = {
    "argoverse2": {"radar", "ultrasonic"},
    "carla": {"ultrasonic"},
    "kitti": {"radar", "ultrasonic"},
}
"""Kinds that a format has not."""
EVEN = pe.Lidar("even", np.radians([-20.0, -10.0, 0.0]), 36, 80.0, min_range=0.5)
UNEVEN = pe.Lidar(
    "uneven",
    np.radians([-20.0, -7.0, 3.0]),
    azimuth_count=36,
    max_range=80.0,
    azimuth_offsets=np.radians([0.0, 2.0, 0.0]),
)
NEAR = Camera("near", 640, 480, math.radians(70.0), min_range=0.3, max_range=40.0)
OWN_RADAR = catalog.from_table("own", catalog.to_table(catalog.load("Delphi ESR")))


def random_rig(name, rng):
    """Each lens, LiDAR and radar that the format has a kind for, anywhere and turned anyhow. KITTI
    has one LiDAR and up to four cameras that look as one."""
    models = {
        f"cam_{key}": Camera(f"own {key}", WIDTH, HEIGHT, lens=lens) for key, lens in LENSES.items()
    }
    models |= {"cam_near": NEAR, "lidar_known": catalog.load("Velodyne VLP-16 Puck")}
    if name == "kitti":
        keys = ("lidar_known", "cam_pinhole", "cam_brown", "cam_angles")
        models = {key: models[key] for key in keys}
    else:
        models |= {"lidar_even": EVEN, "lidar_uneven": UNEVEN, "radar_own": OWN_RADAR}
        models |= {"radar_known": catalog.load("Continental ARS408-21")}
        models |= {"ultrasonic_known": catalog.load("Bosch Ultrasonic 3.1")}
    common = (rng.uniform(-20, 20), rng.uniform(-20, 20), rng.uniform(-180, 180))
    sensors = []
    for key, model in models.items():
        if model.kind in WITHOUT.get(name, ()):
            continue
        # a roll near 90 degrees would be that of an optical frame
        turn = (rng.uniform(-40, 40), rng.uniform(-60, 60), rng.uniform(-180, 180))
        turn = common if name == "kitti" and model.kind == "camera" else turn
        place = (rng.uniform(-3, 3), rng.uniform(-1, 1), rng.uniform(0.3, 3))
        fusion = "top" if key == "lidar_even" else None
        sensors.append(pe.Sensor(key, model, pe.Pose.from_degrees(place, turn), fusion=fusion))
    return pe.Rig(sensors)


def there_and_back(rig, name, folder, in_folder):
    """What is read of a rig in a format, from its file or its folder, and the lines of both."""
    if name == "argoverse2":
        pytest.importorskip("pyarrow", reason="of the extra argoverse")
    paths, lines = pt.export_rig(rig, name, folder, AXLE)
    placed = next(iter(s.pose for s in rig if s.kind == "lidar")) if name == "kitti" else None
    path = folder if in_folder or len(paths) > 1 else paths[0]
    found = pt.import_rig(
        path, None if name != "argoverse2" else name, AXLE, models=None, placed=placed
    )
    return found, lines


def figures_of(lens):
    return [getattr(lens, key) for key in ("fx", "fy", "cx", "cy", *lens.coefficients)]


def on_axis(lens):
    return lens.fx * float(lens.slope(np.zeros(1))[0])


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", RIG_FORMATS)
def test_a_rig_comes_back(name, seed, tmp_path):
    rng = np.random.default_rng(seed)
    rig = random_rig(name, rng)
    holds = HOLDS.get(name, set())
    found, lines = there_and_back(rig, name, tmp_path, in_folder=seed == 1)
    text = "\n".join(lines)
    names = [s.name for s in rig]
    if name == "osi":
        names = [f"{s.kind}_{number}" for number, s in enumerate(rig)]
    elif name == "kitti":
        names = ["velodyne", "camera_0", "camera_1", "camera_2"]
        rig = pe.Rig(sorted(rig, key=lambda s: s.kind != "lidar"))
    assert [s.name for s in found.rig] == names
    for ours, theirs in zip(rig, found.rig, strict=True):
        assert theirs.kind == ours.kind
        assert np.abs(np.subtract(theirs.pose.position, ours.pose.position)).max() < WITHIN
        turned = theirs.pose.ground_from_sensor - ours.pose.ground_from_sensor
        assert np.abs(turned).max() < WITHIN
        model = ours.model
        again = theirs.model
        key = ours.name.split("_")[1]
        if key in LENSES:
            own = model.projection
            other = again.projection
            assert (key in KEEPS[name]) == (f"{ours.name}: the " not in text), text
            if key in KEEPS[name]:
                assert type(other) is type(own) and other.fov == pytest.approx(own.fov)
                assert figures_of(other) == pytest.approx(figures_of(own), abs=WITHIN)
            assert on_axis(other) == pytest.approx(on_axis(own), abs=WITHIN)
            if name not in ("nuscenes", "kitti"):  # these have no sizes
                assert (again.width, again.height) == (WIDTH, HEIGHT)
        elif key == "known" and "model" in holds and ours.kind in ("lidar", *holds & {"table"}):
            assert again.name == model.name
            assert catalog.to_table(again) == catalog.to_table(model)
        elif key in ("even", "uneven") and key in holds:
            order = [np.lexsort(each.directions.T.round(6)) for each in (model, again)]
            beams = [each.directions[k] for each, k in zip((model, again), order, strict=True)]
            assert np.abs(beams[0] - beams[1]).max() < WITHIN
        elif ours.kind == "radar" and "table" in holds:
            assert catalog.to_table(again) == catalog.to_table(model)
        elif ours.kind == "radar" and "field" in holds:
            (left, right), (_, top) = model.window
            (low, high), (_, up) = again.window
            assert (low, high, up) == pytest.approx((left, right, top))
        if "ranges" in holds and ours.kind == "camera":
            assert (again.min_range, again.max_range) == (model.min_range, model.max_range)
        assert theirs.fusion == (ours.fusion if "fusion" in holds else None)
