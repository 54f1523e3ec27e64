"""Values that can be mounted: a search ends on whole steps; where its best placements agree."""

import math
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import search
from pe_tools import advice
from tests.engine import shapes

STEP_M = 0.05
STEP_RAD = math.radians(2.0)


def on_grid(value, step):
    return value == pytest.approx(round(value / step) * step, abs=1.1e-5)


@pytest.fixture
def study():
    """A LiDAR on the roof and a camera in a box of coordinates."""
    car = shapes.box_car()
    lidar = pe.Sensor("roof", shapes.small_lidar(8, 90), pe.Pose((0.4, 0.0, 1.6), (0, 0, 0)))
    rig = pe.Rig([lidar, shapes.camera(position=(2.4, 0.0, 1.2), name="front")])
    mounting = search.Mounting(
        {"top": search.SurfaceMount(car.part_names, standoff=0.1)}, {"roof": "top"}
    )
    own = pe.Search(
        free={"roof": ("yaw",), "front": ("y", "pitch")},
        limits={"front": {"y": (-0.3, 0.3)}},
        samples=2048,
        evaluations=30,
        mounting=mounting,
        grid=pe.MountingGrid(STEP_M, STEP_RAD),
    )
    base = pe.Study(rig, car, shapes.small_space(), samples=8192, search=own)
    return base.on_mounts()


def searched(study):
    job = pt.OptimizeJob(study, workers=1)
    for _ in job:
        pass
    return job.outcome


def test_a_search_ends_on_the_grid_and_tells_what_that_cost(study):
    found = searched(study)
    free = searched(replace(study, search=replace(study.search, grid=pe.MountingGrid())))
    roof, front = (found.study.rig[name].pose for name in ("roof", "front"))
    assert all(on_grid(v, STEP_M) for v in (*roof.position[:2], front.position[1]))
    assert on_grid(front.rpy[1], STEP_RAD) and on_grid(roof.rpy[2], STEP_RAD)
    assert front.position[0] == 2.4  # is not free
    assert free.rounding is None  # and the search before was the same
    assert [row.value for row in free.history] == [row.value for row in found.history]
    assert found.rounding.evaluations > 4
    assert found.rounding.cost is not None and found.rounding.stderr >= 0.0


def test_neighbours_are_tried_before_the_nearest_is_taken(study):
    """The walk ends where no neighbour on the grid is better."""
    objective = search.as_objective(study.evaluator(2048))
    walk = search.GridWalk(study.coding(), study.search.grid)

    def values(rigs):
        return [objective.value(rig) for rig in rigs]

    found = walk.best(values)
    again = search.GridWalk(study.with_rig(found.rig).coding(), study.search.grid)
    assert again.holds(found.rig)
    numbers = again.nearest()
    best = objective.value(found.rig)
    for k in range(len(numbers)):
        for step in (-1, 1):
            beside = tuple(n + step * (j == k) for j, n in enumerate(numbers))
            other = again.candidate(beside)
            assert other is None or objective.value(other.rig) >= best


def rig_at(x, yaw=0.0):
    lidar = pe.Sensor("roof", shapes.small_lidar(2, 8), pe.Pose((x, 0.0, 1.8), (0, 0, yaw)))
    return pe.Rig([lidar, shapes.camera(name="still")])


def test_the_ten_best_agree_within_their_largest_distance():
    values = [(0.0, 0.0), (0.001, 0.004), (0.01, 0.06), (0.02, -0.03), (0.5, 4.0)]
    known = [(1, search.Value(0.0, value), rig_at(x)) for value, x in values]
    known.append((0, search.Value(0.0, -9.0), rig_at(99.0)))  # of a coarser level
    known.append((1, search.Value(0.3, math.inf), rig_at(88.0)))  # breaks a limit
    found = advice.consensus_of(known[:4] + known[5:], ["roof"], search.Mounting())
    assert found.count == 3  # 4 mm off is no other placement
    assert found.sensors[0].distance == pytest.approx(0.06)
    assert found.loss == pytest.approx(0.02)
    assert "all 3 within 6 cm" in found.sensors[0].text(found.count)
    assert advice.consensus_of(known[:1], ["roof"], search.Mounting()) is None
