"""How much work scores do, counted, not timed: a change that does half as much again fails here.

Counts are the same in every run. Where a change does less, lower the number in `EXPECTED`: the next
change is held to it.
"""

import sys
import tracemalloc
from collections import Counter
from functools import partial

import pytest

import pe_core as pe
from pe_core.geometry.culling import Targets
from pe_core.geometry.raycast import VisibleTriangles
from pe_core.search import as_objective, evaluate_all
from pe_core.sensors.kernels import DefinedSample
from pe_core.sensors.lidar import voxel_beams
from pe_core.sensors.lidar.kernel_voxels import LidarSample
from tests.engine import shapes

SAMPLES = 16_384
ROOM = 1.5
"""So many times the expected number a count may be: calls differ with the version of NumPy."""
SOME = 1.0
"""What counts of 0 may rise to."""
LIDAR = shapes.small_lidar(32, 600)
NAMES = ("voxels", "rays", "ray_pairs", "beam_pairs", "calls", "kilobytes")
"""Voxels measured, rays cast, pairs of a ray and a triangle and of a beam and a voxel that are
tested, functions called, and the most memory that is held at once [kB]."""
EXPECTED = {
    "moved_upright": (16_325, 732, 3_439, 1_280, 6_074, 1_691),
    "moved_tilted": (16_325, 750, 2_879, 3_968, 5_377, 3_582),
    "moved_camera": (16_325, 2_437, 0, 0, 3_301, 1_439),
    "candidate": (65_300, 9_953, 14_482, 8_983, 11_323, 4_051),
    "score": (65_300, 77_574, 40_128, 7_035, 28_845, 5_503),
    "score_on_the_grid": (0, 71_636, 32_213, 0, 6_988, 6_518),
}


def four_sensors(offset=0.0, tilt_deg=0.0):
    """Two LiDARs and two cameras on a car of boxes; all are moved by an offset [m]."""
    sensors = [
        shapes.lidar_on_roof(LIDAR, (-0.43 + offset, 0.02, 1.8), (0.0, tilt_deg, 0.0)),
        shapes.lidar_on_roof(LIDAR, (2.2 + offset, 0.5, 0.95), (0.0, 2.0, 0.0), "front"),
        shapes.camera(30.0, (0.7 + offset, 0.0, 1.5), (0.0, 1.4, 0.0), "ahead"),
        shapes.camera(60.0, (-1.4 - offset, 0.0, 1.5), (0.0, 7.2, 180.0), "behind"),
    ]
    return pe.Rig(sensors)


def with_one_moved(rig, name, offset, tilt_deg=0.0):
    """The rig with one sensor as `four_sensors` has it, moved by an offset [m]."""
    moved = four_sensors(offset, tilt_deg)[name]
    return pe.Rig([moved if sensor.name == name else sensor for sensor in rig])


class Jobs:
    """What is counted, after the same has been done once: each at an offset of its own [m]."""

    def __init__(self):
        study = pe.Study(four_sensors(), shapes.box_car(4))
        self.rig = study.rig
        self.sample = study.evaluator(SAMPLES)
        self.grid = pe.Evaluator(shapes.small_space(), study.prior, study.vehicle, workers=1)
        self.objective = as_objective(study.evaluator(SAMPLES))

    def moved_upright(self, offset):
        self.sample.summary(with_one_moved(self.rig, "roof", offset))

    def moved_tilted(self, offset):
        self.sample.summary(with_one_moved(self.rig, "roof", offset, tilt_deg=3.0))

    def moved_camera(self, offset):
        self.sample.summary(with_one_moved(self.rig, "ahead", offset))

    def candidate(self, offset):
        evaluate_all(self.objective, [four_sensors(offset, tilt_deg=1.0)])

    def score(self, offset):
        self.sample.score(four_sensors(offset))

    def score_on_the_grid(self, offset):
        self.grid.score(four_sensors(offset))


@pytest.fixture(scope="module")
def jobs():
    return Jobs()


@pytest.fixture
def sizes(monkeypatch):
    """Counts of what kernels and rays are asked, by name."""
    found = Counter()

    def count(owner, method, name, size):
        inner = getattr(owner, method)

        def counting(*args, **options):
            result = inner(*args, **options)
            found[name] += size(args, result)
            return result

        monkeypatch.setattr(owner, method, counting)

    count(LidarSample, "measure", "voxels", lambda args, measured: len(measured.m))
    count(DefinedSample, "measure", "voxels", lambda args, measured: len(measured.m))
    count(VisibleTriangles, "first_hit", "rays", lambda args, hits: len(hits.face))
    count(Targets, "met", "ray_pairs", lambda args, met: len(args[1]))
    count(voxel_beams, "count_pairs", "beam_pairs", lambda args, counts: len(args[2]))
    return found


def calls_of(work):
    """The number of functions called, of Python and of C."""
    count = 0

    def note(_frame, event, _argument):
        nonlocal count
        count += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(before)
    return count


def kilobytes_of(work):
    """The most memory that the work held beyond what there was before."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1] // 1024
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("name", EXPECTED)
def test_a_job_does_no_more_work_than_it_did(jobs, sizes, name):
    job = getattr(jobs, name)
    job(0.01)
    sizes.clear()
    job(0.02)
    found = dict(sizes)
    found["calls"] = calls_of(partial(job, 0.03))
    found["kilobytes"] = kilobytes_of(partial(job, 0.04))
    expected = dict(zip(NAMES, EXPECTED[name], strict=True))
    more = {k: (n, expected[k]) for k, n in found.items() if n > ROOM * max(expected[k], SOME)}
    assert not more, f"{name}: found and expected {more}"
