"""*Free Region* and *Compare Built Rig* in Blender: the same as on the command line, drawn."""

import bpy
import numpy as np
import pytest

import pe_tools as pt
from blender_addon.engine import jobs, pe, search
from blender_addon.queries import where_map
from tests.addon import scenes


@pytest.fixture(autouse=True)
def _one_process(monkeypatch):
    """No worker processes: they do not look at the few heights that this one looks at."""
    monkeypatch.setattr("os.cpu_count", lambda: 1)


@pytest.fixture
def asked(car):
    """The car's scene, its first sensor, and that sensor's region by a figure without a sample."""
    name = next(iter(scenes.study().rig)).name
    view = car.perception_entropy.view
    view.region_loss = 400.0  # nothing is lost but what rules forbid
    done = bpy.ops.pe.free_region(name=name, figure="blind_sector", places=12)
    assert done == {"FINISHED"}
    return car, name, where_map.regions[car.name]


def test_the_operator_finds_what_the_engine_finds(asked):
    _, name, found = asked
    job = jobs.RegionJob(scenes.study(), name, "blind_sector", allowed=400.0, count=12)
    for _ in job:
        pass
    assert np.array_equal(found.patch, job.found.patch) and len(found.patch)
    assert found.places == job.found.places


def test_one_click_makes_the_region_the_mount_of_its_sensor(asked, tmp_path):
    car, name, found = asked
    half = float(np.median(found.loss[~found.forbidden]))
    car.perception_entropy.view.region_loss = max(half, 1e-6)
    cut = found.allowing(car.perception_entropy.view.region_loss).patch
    assert bpy.ops.pe.use_as_mount() == {"FINISHED"}
    row = car.perception_entropy.mounts[-1]
    assert car.objects[name].perception_entropy.mount == row.name
    study = scenes.study()
    mount = study.search.mounting.mount_of(name)
    assert np.allclose(mount.area.triangles, cut, atol=1.1e-5)
    step = search.Parametrization(study.rig, study.search_space())  # the sensor is on it
    assert step.domain_of(name).surface is not None
    pt.export_study(study, tmp_path / "next.toml")  # and a file brings it back
    assert bpy.ops.pe.import_file(filepath=str(tmp_path / "next.toml")) == {"FINISHED"}
    again = scenes.study().search.mounting.mount_of(name)
    assert np.array_equal(again.area.triangles, mount.area.triangles)


def test_a_built_rig_is_drawn_with_lines_to_the_designed_one(car, tmp_path):
    study = scenes.study()
    first, *others = study.rig
    x, y, z = first.pose.position
    off = first.moved(pe.Pose((x + 0.02, y, z), first.pose.rpy))
    pt.export_rig(pe.Rig([off, *others]), "urdf", tmp_path / "built.urdf")
    done = bpy.ops.pe.compare_built(filepath=str(tmp_path / "built.urdf"))
    assert done == {"FINISHED"}
    found = where_map.built[car.name]
    assert [pair.name for pair in found.worst_first] == [first.name]
    assert found.worst_first[0].offset[0] == pytest.approx(0.02, abs=1e-5)
    shape = scenes.drawn(car)["ghosts"][""]
    assert len(shape.through.points)
    assert [tag.text for tag in shape.labels] == [first.name]
    bpy.ops.pe.dismiss(answer="BUILT")
    assert "ghosts" not in scenes.drawn(car)
