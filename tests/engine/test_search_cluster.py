"""One search of sixteen sensors by processes and a Dask cluster: the bits of one process."""

import os
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from tests.engine import shapes
from tests.thorough import THOROUGH

WORKERS, SENSORS, EVALUATIONS = 4, 16, 60


class Noted:
    """An evaluator that notes each time a worker unpickles it, with the mesh."""

    def __init__(self, folder, evaluator):
        self.folder, self.evaluator = folder, evaluator

    def __setstate__(self, state):
        vars(self).update(state)
        (Path(self.folder) / f"unpickled {os.getpid()} {time.monotonic_ns()}").touch()

    def entropy(self, rig):
        return self.evaluator.entropy(rig)


@pytest.fixture(scope="module")
def study():
    """Eight LiDARs and eight cameras round a box car of 3072 triangles."""
    lidar, camera = shapes.small_lidar(4, 40), pe.Camera("c", 60, 40, 1.0)
    sensors = []
    for k in range(SENSORS):
        angle = 2.0 * np.pi * k / SENSORS
        place = (2.6 * np.cos(angle), 1.3 * np.sin(angle), 1.2)
        model = lidar if k % 2 else camera
        sensors.append(pe.Sensor(f"s{k}", model, pe.Pose(place, (0.0, 0.0, angle))))
    body = shapes.refined(shapes.box((-2.2, -0.9, 0.3), (2.2, 0.9, 1.5)), 4)
    car = pe.Vehicle(body, np.zeros(len(body), np.int32), ("body",))
    return pe.Study(pe.Rig(sensors), car, shapes.small_space())


def steps(objective, study, executor=None):
    found = pe.optimize(
        objective, study.rig, study.search_space(), evaluations=EVALUATIONS, executor=executor
    )
    return [(s.entropy, s.improved, [own.pose for own in s.best]) for s in found]


@pytest.fixture(scope="module")
def by_one_process(study):
    return steps(study.evaluator(1024), study)


@pytest.fixture
def client():
    """The client of a cluster of four workers."""
    distributed = pytest.importorskip("distributed")
    options = {"host": "127.0.0.1", "dashboard_address": None, "threads_per_worker": 1}
    with (
        distributed.LocalCluster(n_workers=WORKERS, processes=True, **options) as cluster,
        distributed.Client(cluster) as connected,
    ):
        connected.wait_for_workers(WORKERS)
        yield connected


@pytest.mark.skipif(not THOROUGH, reason="starts four processes of a cluster")
@pytest.mark.skipif(sys.platform == "win32", reason="as the other test of a cluster")
def test_a_search_of_sixteen_sensors_by_workers_of_a_cluster_takes_the_steps_of_one_process(
    study, client, by_one_process, tmp_path
):
    addresses = list(client.scheduler_info()["workers"])
    for count in (1, 2, WORKERS):
        noted = Noted(str(tmp_path), study.evaluator(1024))
        executor = client.get_executor(workers=addresses[:count], pure=False)
        assert steps(noted, study, executor) == by_one_process
        files = list(tmp_path.glob("unpickled *"))
        unpickled = [path.name.split()[1] for path in files]
        assert 0 < len(unpickled) == len(set(unpickled)) <= count, "the mesh comes once to each"
        for path in files:
            path.unlink()
