"""Mounts, ties and constraints in the study file, and one line for whatever is wrong with them."""

from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.study.study_file import study_from_dict
from tests.engine import mounting
from tests.engine.mounting import CAN, ON_ROOF, TOP
from tests.engine.refusals import wrongly_refused

ROOT = Path(__file__).parents[2]
AREA = {"name": "area", "parts": ["roof"], "standoff": 0.04}
SLOT = {"name": "here", "position": [0.0, 0.0, 1.9], "rotation": [0.0, 0.0, 0.0]}
RACK = {"name": "rack", "slot": [SLOT, SLOT | {"name": "there", "position": [0.5, 0.0, 1.9]}]}
CAMERA = {"name": "right", "model": "Camera 60 deg", "position": [0.0, -0.5, 2.5]}
PAIR = {"pairs": [["left", "right"]]}
GROUP = {"groups": [["left", "right"]]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mounts")
    car = mounting.car()
    pt.write_mesh(folder / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    return folder


def sensor(name="roof", position=ON_ROOF, **more):
    return {"name": name, "model": CAN, "position": list(position), **more}


def read(folder, sensors, **optimize):
    limits = optimize.pop("limits", {})
    data = {"vehicle": {"mesh": "car.npz"}, "sensor": sensors, "optimize": optimize}
    data["limits"] = limits
    return study_from_dict(data, "study.toml", folder)


def line(folder, sensors, **optimize):
    """The one line that a study is refused with."""
    with pytest.raises(pe.InputError) as error:
        read(folder, sensors, **optimize)
    told = str(error.value)
    assert "\n" not in told and told.startswith("study.toml: ")
    return told.removeprefix("study.toml: ")


def test_the_example_of_the_page_is_a_study(folder):
    """What docs/mounts_and_search.md shows under its heading is read as it stands there."""
    page = (ROOT / "docs" / "mounts_and_search.md").read_text("utf-8")
    text = page.split("## Mounts and constraints")[1].split("```toml\n")[1].split("```")[0]
    (folder / "sedan.npz").write_bytes((ROOT / "blend_assets" / "sedan.npz").read_bytes())
    (folder / "page.toml").write_text(text, "utf-8")
    study = pe.load_study(folder / "page.toml")
    assert len(study.search.mounting.mounts) == 2
    coding = study.coding()
    assert coding.allowed(study.rig), coding.broken(study.rig)


LEFT = sensor("left", (0.0, 0.5, 2.5))
RIGHT = sensor("right", (0.0, -0.5, 2.5))
ON = sensor(mount="area")

BAD = [
    (
        "sensor 'roof': position",
        ([sensor(position=(-0.43, 0.0, TOP + 0.2), mount="area")], {"mount": [AREA]}),
    ),
    (
        "sensor 'roof': position",
        (
            [sensor(position=(-0.43, 0.0, TOP - 0.04 + mounting.CENTER), mount="area")],
            {"mount": [AREA]},
        ),
    ),
    ("sensor 'roof': position", ([sensor(mount="rack")], {"mount": [RACK]})),
    (
        "sensor 'roof': bounds of pitch",
        ([sensor(mount="area", bounds={"pitch": [5, 10]})], {"mount": [AREA]}),
    ),
    ("mount 'area': parts", ([ON], {"mount": [AREA | {"parts": ["rooof"]}]})),
    ("sensor[0].mount", ([sensor(mount="arena")], {"mount": [AREA]})),
    ("sensor[0].mount", ([ON], {})),
    ("optimize.mount[1].name", ([sensor()], {"mount": [AREA, AREA]})),
    ("optimize.mount[0].slot", ([sensor()], {"mount": [{"name": "rack", "slot": [SLOT, SLOT]}]})),
    ("optimize.mount[0].slot", ([sensor()], {"mount": [AREA | RACK]})),
    ("optimize.mount[0].parts", ([sensor()], {"mount": [{"name": "area"}]})),
    ("optimize.no_go[0].x, y, z", ([sensor()], {"no_go": [{"name": "hatch"}]})),
    ("optimize: pair of 'left' and 'right'", ([LEFT, CAMERA], PAIR)),
    ("sensor 'right': position", ([LEFT, sensor("right", (0.0, -0.6, 2.5))], PAIR)),
    (
        "sensor 'right': position",
        ([LEFT | {"rotation": [0, 0, 30]}, RIGHT | {"rotation": [0, 0, 30]}], PAIR),
    ),
    ("optimize.pairs", ([LEFT], {"pairs": [["left"]]})),
    ("optimize.pairs", ([LEFT], {"pairs": [["left", "left"]]})),
    ("optimize: pairs", ([LEFT], PAIR)),
    ("optimize: pairs, groups", ([LEFT, RIGHT], PAIR | GROUP)),
    ("optimize: pairs, groups", ([LEFT, RIGHT], PAIR | {"groups": [["right", "left"]]})),
    ("sensor 'right': bounds", ([LEFT, RIGHT | {"bounds": {"x": [-1, 1]}}], PAIR)),
    (
        "sensor 'right': mount",
        ([LEFT, sensor("right", SLOT["position"], mount="rack")], GROUP | {"mount": [RACK]}),
    ),
    (
        "sensor 'a': bounds",
        ([sensor("a", SLOT["position"], mount="rack", bounds={"x": [-1, 1]})], {"mount": [RACK]}),
    ),
]


def test_what_is_wrong_is_refused(folder):
    refused = wrongly_refused(lambda v: read(folder, v[0], **v[1]), BAD, "study.toml")
    assert refused == []


def test_a_surface_needs_a_vehicle():
    data = {"sensor": [ON], "optimize": {"mount": [AREA]}}
    with pytest.raises(pe.InputError, match="found 'roof'"):
        study_from_dict(data)


def test_a_part_without_faces_is_no_surface():
    car = mounting.car()
    vehicle = pe.Vehicle(car.triangles, car.parts, (*car.part_names, "gone"))
    mount = {"roof": pe.SurfaceMount(["gone"])}
    with pytest.raises(pe.InputError, match=r"parts: .* none in gone"):
        mounting.coded(mounting.can(), mount=mount, vehicle=vehicle)


def test_a_vehicle_with_no_symmetry_plane_has_no_pairs():
    car = mounting.car()
    moved = car.triangles + np.array([0.0, 0.3, 0.0])
    vehicle = pe.Vehicle(moved, car.parts, car.part_names)
    left, right = (mounting.can((0, y, 2.5), name) for name, y in (("left", 0.5), ("right", -0.5)))
    rig, space = mounting.space(left, right, pairs=[("left", "right")], vehicle=vehicle)
    with pytest.raises(pe.InputError, match=r"one from y = -0\.60 to 1\.20 m"):
        next(pe.optimize(lambda _: 0.0, rig, space))


def test_models_of_one_s_own_are_alike_by_their_figures(folder):
    model = {"kind": "camera", "width": 640, "height": 480, "hfov_deg": 60}
    pair = [LEFT | {"model": model}, RIGHT | {"model": dict(model)}]
    assert read(folder, pair, **PAIR).search.mounting.pairs
    pair[1]["model"] |= {"hfov_deg": 61}
    assert "expected sensors of one model" in line(folder, pair, **PAIR)
