"""The study file: each key goes there and back, and takes a hostile value or refuses it."""

import math
import random
import re
import tomllib
import warnings
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.table_reader import dumps
from pe_core.study import study_schema
from pe_core.study.study_file import study_from_dict, study_to_dict
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused
from tests.thorough import tries

MAX_LINE_LENGTH = 300
STUDIES = {
    file.stem: tomllib.loads(file.read_text("utf-8"))
    for file in sorted((Path(__file__).parent / "hostile_studies").iterdir())
}
"""Every key of a study, each with another value than its default."""
BOXES = {"boxes": "boxes.csv", "origin": [0.0, 0.0, 0.5]}
BOX_TABLE = "class,x,y,z,length,width,height,yaw\ncar,3,1,0.7,4,2,1.4,30\n"
REWRITTEN = {
    "study": [
        "optimize.free",
        *(f"sensor.1.model.{key}" for key in ("angles", "azimuth_step_deg")),
    ],
    "more": ["optimize.free"],
}
"""Keys that are written in another form: at each sensor; as the angles of the file."""
IN_ANOTHER_FORM = {"prior.boxes", "prior.grid", "prior.origin", "prior.space"}
"""Keys of a prior that others exclude."""
PINHOLE = {"kind": "camera", "width": 640, "height": 480, "hfov_deg": 90.0}
PARTNERS = {
    "area": ["parts"],
    "preset": ["shape"],
    "aspect_deg": ["dbsm"],
    "bandwidth_mhz": ["range_resolution_m"],
    "class": ["classes"],
    "dbsm": ["aspect_deg"],
    "elevations_deg": ["azimuth_offsets_deg"],
    "fov_deg": ["distortion"],
    "k1": ["distortion"],
    "max_range_m": ["min_range_m"],
    "model": ["kind"],
    "optimize": ["mount"],
    "p1": ["distortion"],
    "position": ["bounds", "worst"],
    "rotation": ["position"],
    "sensors": ["group"],
    "value": ["blind_ground"],
    "vehicle": ["move"],
    **{key: ["zone"] for key in ("path", "polygon", "ring", "spots", "x", "y", "z")},
}
"""Keys whose values have to fit together: a message may name the other one."""
STEP = tries(10, 3)
"""Every key is given one value in so many, each key others than the one before it."""
MINIMAL = """
[[sensor]]
name = "roof"
model = "Pandar64"
position = [-0.43, 0.0, 1.80]
"""

FULL = """
samples = 5000
[space]
x = [-20, 20]
y = [-10, 10]
z = [0, 4]
interval = 0.5
[prior]
model = "road"
[[prior.focus]]
factor = 2.0
x = [5, inf]
classes = ["cone", "car"]
[ap.lidar]
a = 0.2
b = 0.5
[fusion]
blind = "literal"
[vehicle]
mesh = "car.npz"
glass = ["cabin"]
clearance = 0.05
[[sensor]]
name = "roof"
model = "Pandar64"
position = [-0.43, 0.0, 1.80]
rotation = [0.1, -0.2, 0.3]
fusion = "top"
free = ["z", "yaw"]
bounds = { z = [1.5, 2.0], yaw = [-10, 10] }
[[sensor]]
name = "own"
position = [1.0, 0.0, 1.2]
[sensor.model]
kind = "lidar"
elevations_deg = [-10, 0.1, 5]
azimuth_step_deg = 0.4
max_range_m = 80
[[sensor]]
name = "cam"
model = "Camera 60 deg"
position = [1.0, 0.0, 1.5]
[optimize]
free = ["x"]
seed = 7
samples = 4096
method = "random"
candidates = 12
"""


RANDOM = 'method = "random"\n'
BAD = [
    ("study", "a = ["),
    ("spce", MINIMAL + "[spce]\n"),
    ("sensor[0].colour", MINIMAL + "colour = 3\n"),
    ("sensor[0].model", MINIMAL.replace("Pandar64", "Pandar65")),
    ("sensor[0].name", MINIMAL.replace('name = "roof"', "")),
    ("sensor", "[space]\n"),
    ("rig: sensor name", MINIMAL + MINIMAL),
    ("space.interval", MINIMAL + "[space]\ninterval = 0.3\n"),
    ("prior.model", MINIMAL + '[prior]\nmodel = "city"\n'),
    ("prior.focus[0].factor", MINIMAL + "[[prior.focus]]\nx = [0, 1]\n"),
    ("sensor[0].free", MINIMAL + 'free = ["up"]\n'),
    ("roof: bounds of z", MINIMAL + "bounds = {z = [2, 3]}\n"),
    ("sensor[0].bounds.w", MINIMAL + "bounds = {w = [2, 3]}\n"),
    ("optimize.candidates", MINIMAL + f"[optimize]\n{RANDOM}candidates = 0\n"),
    ("optimize.method", MINIMAL + "[optimize]\ncandidates = 9\n"),
]


def nested(depth, of=list):
    value = 1
    for _ in range(depth):
        value = [value] if of is list else {"a": value}
    return value


VALUES = {
    "nan": math.nan,
    "inf": math.inf,
    "-inf": -math.inf,
    "1e308": 1e308,
    "5e-324": 5e-324,
    "0": 0,
    "-1": -1,
    "0.5": 0.5,
    "180.7": 180.7,
    "10**18": 10**18,
    "10**400": 10**400,
    "5000 digits": 10**5000,
    "true": True,
    "empty": "",
    "long": "x" * 10**6,
    "turned": "a\u202eb",
    "bell": "a\x07\x1b[31mb",
    "nul": "a\0b",
    "surrogate": "a\ud800b",
    "[]": [],
    "{}": {},
    "[[]]": [[]],
    "lists": nested(1000),
    "tables": nested(1000, dict),
    "many": [0.5] * 10**4,
    "three nan": [math.nan] * 3,
    "two 1e308": [-1e308, 1e308],
    "two inf": [-math.inf, math.inf],
    "two 5000 digits": [0, 10**5000],
    "two texts": ["a", "\u202e"],
    "three 5000 digits": [10**5000] * 3,
    "null": None,
}


def paths(value, path=()):
    """The way to everything in a study: to its tables, its lists, their elements."""
    if path:
        yield path
    if isinstance(value, dict):
        for key in value:
            yield from paths(value[key], (*path, key))
    elif isinstance(value, list):
        in_all = path == ("sensor",) or (value and isinstance(value[0], dict))
        for i in range(len(value) if in_all else min(1, len(value))):  # of numbers, the first
            yield from paths(value[i], (*path, i))


def changed(study, path, value):
    """A study with another value at the end of a path; the tables along the path are copied."""
    key, *rest = path
    copied = study.copy()
    copied[key] = changed(study[key], rest, value) if rest else value
    return copied


def at(study, path):
    for key in path:
        study = study[key]
    return study


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studies")
    car = shapes.box_car()
    pt.write_mesh(folder / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    (folder / "angles.csv").write_text("elevation_deg\n-1\n2\n", "utf-8")
    (folder / "boxes.csv").write_text(BOX_TABLE, "utf-8")
    return folder


@pytest.fixture
def write(folder):
    def to_file(text):
        path = folder / "study.toml"
        path.write_text(text, "utf-8")
        return path

    return to_file


# --- there and back -------------------------------------------------------------------------------


def keys_of(schema, path=()):
    """Every key of a schema, with those of the tables of its lists; names are a star."""
    for key, inner in schema.get("properties", {}).items():
        yield (*path, key)
        yield from keys_of(inner, (*path, key))
    more = schema.get("additionalProperties")
    if isinstance(more, dict):
        yield from keys_of(more, (*path, "*"))
    for inner in (schema.get("items"), *schema.get("anyOf", ())):
        if isinstance(inner, dict):
            yield from keys_of(inner, path)


def is_given(key, given):
    return any(
        len(own) == len(key) and all(a in ("*", b) for a, b in zip(key, own, strict=True))
        for own in given
    )


def test_the_studies_here_have_every_key():
    given = {
        tuple(step for step in path if isinstance(step, str))
        for study in STUDIES.values()
        for path in paths(study)
    }
    missing = {".".join(key[:2]) for key in keys_of(study_schema()) if not is_given(key, given)}
    limits = {key for key in missing if key.startswith("limits.")}  # all of one form
    assert missing - limits == IN_ANOTHER_FORM


def without(study, keys):
    for key in keys:
        path = [int(step) if step.isdigit() else step for step in key.split(".")]
        study = changed(study, path[:-1], {**at(study, path[:-1])})
        at(study, path[:-1]).pop(path[-1])
    return study


@pytest.mark.parametrize("name", STUDIES)
def test_every_key_is_written_as_it_was_read(name, folder):
    study = study_from_dict(STUDIES[name], "study.toml", folder)
    written = study_to_dict(study)
    rewritten = ("azimuth_count", "elevations_deg", "horizontal_fov_deg")
    given = without(STUDIES[name], REWRITTEN.get(name, ()))
    if name == "study":
        written = without(written, [f"sensor.1.model.{key}" for key in rewritten])
    assert written == given


def parts(value):
    """Yield all that a study is made of; of numbers each bit counts, also that of a zero."""
    if isinstance(value, pe.PerceptionModel):
        value = [value.model, value.blind, value.curves, value.objects]
    if is_dataclass(value):
        value = {each.name: getattr(value, each.name) for each in fields(value)}
    if isinstance(value, Mapping):
        value = [step for item in value.items() for step in item]
    if isinstance(value, list | tuple):
        for each in value:
            yield from parts(each)
    else:
        yield value.tobytes() if isinstance(value, np.ndarray) else repr(value)


@pytest.mark.parametrize("name", STUDIES)
def test_any_number_comes_back_to_the_bit(name, folder):
    """Where a number near that of the file is taken; by default of every third key."""
    rng = random.Random(name)
    taken = 0
    for path in [*paths(STUDIES[name])][:: tries(3, 1)]:
        value = at(STUDIES[name], path)
        if isinstance(value, bool | str | dict | list):
            continue
        near = value * (1.0 + rng.uniform(-1e-3, 1e-3))
        data = changed(light(STUDIES[name], path), path, near)
        try:
            study = study_from_dict(data, "study.toml", folder)
        except pe.InputError:
            continue  # whole numbers, and what has to fit another key
        written = study_to_dict(study)
        again = study_from_dict(tomllib.loads(dumps(written)), "study.toml", folder)
        assert list(parts(again)) == list(parts(study)), path
        taken += 1
    assert taken > 5


def test_an_exported_study_stands_alone_with_its_mesh_boxes_and_angles(folder, tmp_path):
    data = STUDIES["study"] | {"prior": BOXES}
    study = study_from_dict(data, "study.toml", folder)
    pt.export_study(study, tmp_path / "study.toml")
    again = pe.load_study(tmp_path / "study.toml")
    for name in ("rig", "vehicle", "search", "selection"):
        assert list(parts(getattr(again, name))) == list(parts(getattr(study, name)))
    assert again.prior == study.prior


def test_toml_text_reads_back_as_it_was():
    data = {
        "a": 1,
        "b": -0.1,
        "c": [math.inf, -math.inf, 1e300, 5e-324],
        "d": 'quotes " and \\ and\nlines\x7f',
        "odd key.": {"nested": [{"x": [1, [2.5]]}, {"y": True}]},
        "empty": [],
    }
    assert tomllib.loads(dumps(data)) == data


# --- by hand --------------------------------------------------------------------------------------


def test_what_is_not_said_has_the_paper_s_values(write):
    study = pe.load_study(write(MINIMAL))
    assert study.space == pe.PerceptionSpace()
    assert study.model == pe.PerceptionModel()
    assert study.vehicle is None and study.samples == 0
    assert study.rig["roof"].pose == pe.Pose((-0.43, 0.0, 1.80)), "upright"
    assert study.search.free == {"roof": ("x", "y", "z", "pitch")}
    assert study.search.schedule.candidates == 1000


def test_everything_that_is_said_arrives(write):
    study = pe.load_study(write(FULL))
    assert study.space.shape == (80, 40, 8)
    assert study.prior.focus[0] == pe.Focus(2.0, (5.0, math.inf), classes=("cone", "car"))
    assert study.model == pe.PerceptionModel(lidar=pe.ApCurve(0.2, 0.5), blind="literal")
    assert study.vehicle.glass == ("cabin",) and study.vehicle.clearance == 0.05
    assert study.rig["roof"].pose.rpy == tuple(map(math.radians, (0.1, -0.2, 0.3)))
    own = study.rig["own"].model
    assert own.beam_count == 3 * 900 and own.elevations.tolist() == [
        math.radians(each) for each in (-10, 0.1, 5)
    ]
    assert study.search.free == {"roof": ("z", "yaw"), "own": ("x",), "cam": ("x",)}
    bounds = study.search_space().bounds["roof"]
    assert bounds["z"] == (1.5, 2.0)
    assert bounds["yaw"] == pytest.approx((-math.radians(10), math.radians(10)))


def test_a_placement_rounded_past_its_bound_can_be_read_again():
    sensor = {"name": "roof", "model": "Pandar64", "position": [0, 0, 1.5]}
    sensor["bounds"] = {"z": [1.500004, 2.0]}
    assert study_from_dict({"sensor": [sensor]}).rig["roof"].pose.position[2] == 1.5
    with pytest.raises(pe.InputError, match="bounds of z"):
        study_from_dict({"sensor": [sensor | {"position": [0, 0, 1.49999]}]})


# --- what is wrong --------------------------------------------------------------------------------


def test_bad_studies_are_refused(write):
    path = write(MINIMAL)
    assert wrongly_refused(lambda text: pe.load_study(write(text)), BAD, path) == []


def test_a_study_that_is_not_there(tmp_path):
    with pytest.raises(pe.InputError, match=r"none\.toml: no such file"):
        pe.load_study(tmp_path / "none.toml")


def names_of(path):
    """What a message about a value may call it: its key as in the file, or that of its partner."""
    key = [key for key in path if isinstance(key, str)][-1]
    return {key, *PARTNERS.get(key, [])}


def light(study, path):
    """A study without what takes long to read, unless the path leads to it."""
    asked = path[0]
    if asked not in ("requirement", "vehicle", "state", "weather"):
        study = {key: value for key, value in study.items() if key != "requirement"}
    if asked not in ("vehicle", "state") and not {"requirement", "state"} & set(study):
        study = {key: value for key, value in study.items() if key != "vehicle"}
    if asked == "sensor":
        return study
    plain = [s | {"model": PINHOLE} if "distortion" in s["model"] else s for s in study["sensor"]]
    return study | {"sensor": plain}


def complaint_about(path, value, folder, base):
    """What is wrong with how a value at a path is taken or refused; None where nothing is."""
    data = changed(light(base, path), path, value)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            study_from_dict(data, "study.toml", folder)
    except pe.InputError as error:
        line = str(error)
        where = set(re.findall("[a-z0-9_]+", line.split(": expected")[0]))
        is_line = len(line) < MAX_LINE_LENGTH and line.isprintable()
        return None if is_line and names_of(path) & where else line[:MAX_LINE_LENGTH]
    except Exception as fault:  # of any kind: all offenders are listed
        return f"{type(fault).__name__}: {fault}"[:MAX_LINE_LENGTH]
    return None


def test_every_key_takes_a_hostile_value_or_refuses_it_in_one_line(folder):
    keys = [(study, path) for study in STUDIES.values() for path in paths(study)]
    boxes = STUDIES["study"] | {"prior": BOXES}
    keys += [(boxes, ("prior", *path)) for path in paths(BOXES)]
    tried = {
        (".".join(map(str, path)), name): complaint_about(path, value, folder, base)
        for row, (base, path) in enumerate(keys)
        for column, (name, value) in enumerate(VALUES.items())
        if (row + column) % STEP == 0
    }
    assert {where: fault for where, fault in tried.items() if fault} == {}


NO_TOML = ["samples = " + "[" * 5000 + "]" * 5000, "samples = 1979-13-45", "samples = \x00"]
NO_TOML += ['samples = "\\ud800"', "\x1b[31m = \u202e"]


@pytest.mark.parametrize("text", NO_TOML, ids=range(len(NO_TOML)))
def test_a_file_that_is_no_toml_is_one_line(text, write):
    with pytest.raises(pe.InputError) as error:
        pe.load_study(write(text))
    assert len(str(error.value)) < MAX_LINE_LENGTH and str(error.value).isprintable()
