"""Workers get what they will evaluate when they start: an objective that came later would start all
of them anew."""

from concurrent.futures import Executor, Future
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import Front, Goals, Mounting, SurfaceMount
from pe_core.search.payload import receive
from pe_tools import jobs
from pe_tools.jobs.region_job import RegionJob
from pe_tools.jobs.where_job import WhereJob
from tests.engine import shapes

ROOF = "roof"
FRONT = Goals(front=Front(("entropy", "height"), 2))
JOBS = {
    "optimize": lambda study: jobs.OptimizeJob(study),
    "front": lambda study: pt.FrontJob(
        replace(study, search=replace(study.search, goals=FRONT, evaluations=60))
    ),
    "region": lambda study: RegionJob(study, ROOF, allowed=0.1, count=12),
    "region, others searched": lambda study: RegionJob(
        study, ROOF, allowed=0.1, count=12, search_others=True
    ),
    "where": lambda study: WhereJob(study, study.rig[ROOF], count=12),
}


class CountingExecutor(Executor):
    """Works in this thread, and counts how often all of its workers would be started."""

    def __init__(self):
        self.starts = 0
        self.tasks = 0

    def start_with(self, key, data):
        self.starts += 1
        receive(key, data)

    def submit(self, fn, /, *args, **kwargs):
        self.tasks += 1
        future = Future()
        future.set_result(fn(*args, **kwargs))
        return future


def study():
    car = shapes.box_car()
    lidar = pe.Sensor(ROOF, shapes.small_lidar(8, 90), pe.Pose((0.4, 0.0, 1.6), (0, 0, 0)))
    rig = pe.Rig([lidar, shapes.camera(position=(2.2, 0.0, 1.2), name="front")])
    mounting = Mounting({"top": SurfaceMount(car.part_names, standoff=0.1)}, {ROOF: "top"})
    search = pe.Search({ROOF: ("x", "y")}, samples=2048, evaluations=20, mounting=mounting)
    return pe.Study(rig, car, shapes.small_space(), samples=2048, search=search).on_mounts()


@pytest.mark.usefixtures("few_errors", "no_key_figures")
@pytest.mark.parametrize("name", JOBS)
def test_workers_are_started_once(name):
    job = JOBS[name](study())
    job.executor = CountingExecutor()
    for _ in job:
        pass
    assert job.executor.tasks and job.executor.starts == 1
