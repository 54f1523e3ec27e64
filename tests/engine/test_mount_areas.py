"""Areas of the body as surfaces: from a mesh file beside the study, as Blender writes it."""

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.study.study_file import study_from_dict
from tests.engine import mounting, shapes
from tests.engine.mounting import BASE, CENTER, TOP

FRONT_HALF = (0.0, 0.8)
"""Of the roof, which the area is [m along x]."""
START = (0.4, 0.0, TOP + BASE + CENTER)
BAD = {
    "a file that is not there": (
        {"area": {"file": "none.npz"}},
        "study.toml: none.npz: no such file",
    ),
    "a part that is none": (
        {"area": {"file": "areas.npz", "parts": ["upper"]}},
        "area.parts: expected one of front half, lower in areas.npz, found 'upper'",
    ),
    "no name": ({"area": {"file": ""}}, "optimize.mount[0].area.file: expected the name of a file"),
    "an area and slots": (
        {"area": {"file": "areas.npz"}, "slot": [{"name": "a", "position": [0, 0, 2]}]},
        "optimize.mount[0].slot: expected one of area",
    ),
    "faces that are none": (
        {"area": {"file": "flat.npz"}},
        "mount 'area': area: expected faces, found none in the area",
    ),
    "what is no mesh": (
        {"area": {"file": "text.npz"}},
        "text.npz: file: expected a complete NumPy .npz archive",
    ),
}


def painted():
    """The front half of the box car's roof, with a triangle that is none."""
    top = shapes.box((FRONT_HALF[0], -0.7, 0.8), (FRONT_HALF[1], 0.7, TOP))
    level = top[(top[:, :, 2] == TOP).all(axis=1)]
    return np.concatenate([level, np.full((1, 3, 3), TOP)])


def area_mount(standoff=BASE, orientation="upright"):
    return pe.SurfaceMount((), standoff, orientation, pe.MountArea(painted()))


@pytest.fixture
def folder(tmp_path):
    car = mounting.car()
    faces = painted()
    pt.write_mesh(tmp_path / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    parts = np.repeat(np.arange(2, dtype=np.int32), len(faces))
    both = np.concatenate([faces, faces - [0.0, 0.0, 0.3]])
    pt.write_mesh(tmp_path / "areas.npz", pe.Mesh(both, parts, ("front half", "lower")))
    return tmp_path


def data(mount):
    sensor = {"name": "roof", "model": mounting.CAN, "position": list(START), "mount": "area"}
    mount = {"name": "area", "standoff": BASE, **mount}
    return {"vehicle": {"mesh": "car.npz"}, "sensor": [sensor], "optimize": {"mount": [mount]}}


def test_a_sensor_stays_on_the_area_though_the_part_goes_on():
    coding = mounting.coded(mounting.can(START), mount={"roof": area_mount()})
    for x in np.linspace(-1.5, 0.8, 7):
        pose = coding.candidate((x, 0.1, TOP, 0.0)).rig["roof"].pose
        assert pose.position[2] == pytest.approx(START[2], abs=1e-5)
        assert pose.position[0] == pytest.approx(max(x, 0.0), abs=1e-5)


@pytest.mark.usefixtures("few_errors", "no_key_figures")
def test_a_study_with_areas_is_written_with_them_and_searches_the_same(folder, tmp_path):
    rig, space = mounting.space(mounting.can(START), mount={"roof": area_mount()})
    search = pe.Search(
        mounting=space.mounting, samples=1024, schedule=pe.Schedule(2), method="random"
    )
    study = pe.Study(rig, mounting.car(), shapes.small_space(), search=search, samples=1024)
    there = pt.prepare_folder(tmp_path / "out")
    pt.export_study(study, there / "study.toml")
    again = pe.load_study(there / "study.toml")
    assert {each.name for each in there.glob("*.npz")} == {"vehicle.npz", "areas.npz"}
    assert np.array_equal(again.search.mounting.mounts["roof"].area.triangles, painted())
    found = [run(each) for each in (study, again)]
    assert found[0] == found[1]
    pe.save_study(again, there / "again.toml")
    assert pe.load_study(there / "again.toml").search == again.search


def run(study):
    job = pt.OptimizeJob(study)
    list(job)
    return [(row.value, row.rig["roof"].pose) for row in job.history]


def test_a_study_whose_areas_are_in_no_file_is_not_saved_alone(tmp_path):
    rig, space = mounting.space(mounting.can(START), mount={"roof": area_mount()})
    car = mounting.car()
    search = pe.Search(mounting=space.mounting)
    pt.write_mesh(tmp_path / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    with pytest.raises(pe.InputError, match="mount 'roof': area: expected a file beside"):
        pe.save_study(pe.Study(rig, car, search=search, mesh="car.npz"), tmp_path / "a.toml")


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_with_an_area_is_one_line(folder, name):
    mount, told = BAD[name]
    flat = pe.Mesh(np.ones((2, 3, 3)), np.zeros(2, np.int32), ("flat",))
    pt.write_mesh(folder / "flat.npz", flat)
    (folder / "text.npz").write_text("no archive")
    with pytest.raises(pe.InputError) as error:
        study_from_dict(data(mount), "study.toml", folder)
    line = str(error.value).replace(f"{folder}/", "")
    assert told in line and "\n" not in line
