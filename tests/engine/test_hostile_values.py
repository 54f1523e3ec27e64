"""Every key of a study file given every hostile value: taken, or refused in one short line."""

import json
import math
import re
import tomllib
import warnings
from pathlib import Path

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.study.study_file import study_from_dict
from tests.engine import shapes
from tests.thorough import pairs, tries

MAX_LINE_LENGTH = 300
STUDIES = Path(__file__).parent / "hostile_studies"
STUDY = tomllib.loads((STUDIES / "study.toml").read_text("utf-8"))
MORE = tomllib.loads((STUDIES / "more.toml").read_text("utf-8"))
"""A study with the tables that the first one lacks."""
PINHOLE = {"kind": "camera", "width": 640, "height": 480, "hfov_deg": 90.0}
BOXES = {"boxes": "boxes.csv", "origin": [0.0, 0.0, 0.0], "focus": []}
PARTNERS = {
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
    "position": ["bounds"],
    "rotation": ["position"],
    "sensors": ["group"],
    "vehicle": ["move"],
    "x": ["zone"],
    "y": ["zone"],
}
"""Keys whose values have to fit together: a message may name the other one."""
STEP = tries(6, 3)
"""Every key is given one value in so many, each key others than the one before it."""
EXTREMES = [
    ("ap", "lidar", "a", 1e-12),
    ("ap", "lidar", "a", 1e3),
    ("ap", "lidar", "b", -1e3),
    ("prior", "focus", 0, "factor", 1e9),
    ("prior", "focus", 0, "factor", 5e-324),
    ("prior", "focus", 0, "x", [-math.inf, math.inf]),
    ("prior", "class", 0, "size", [5e-324, 5e-324, 5e-324]),
    ("prior", "class", 0, "height_spread", 5e-324),
    ("prior", "class", 0, "decay_x", 5e-324),
    ("prior", "class", 0, "laplace_y", 5e-324),
    ("prior", "class", 0, "gauss_y", 1e9),
    ("prior", "class", 0, "share", 0.0),
    ("prior", "class", 0, "lanes", [1e9]),
    ("sensor", 0, "position", [1e4, -1e4, 1e4]),
    ("sensor", 0, "rotation", [3600.0, -3600.0, 3600.0]),
    ("sensor", 0, "model", "max_range_m", 0.001),
    ("sensor", 0, "model", "elevations_deg", [-90.0, 90.0, 5e-324]),
    ("sensor", 0, "rotation", [1e-320, 0.0, 0.0]),
    ("sensor", 0, "model", "azimuth_count", 1),
    ("sensor", 2, "model", "hfov_deg", 0.001),
    ("sensor", 2, "model", "hfov_deg", 179.999),
    ("sensor", 2, "model", "width", 1_000_000),
    ("vehicle", "clearance", 0.999),
    ("vehicle", "clearance", 5e-324),
    ("space", {"x": [999_992, 1_000_000], "y": [-4, 4], "z": [0, 4], "interval": 0.5}),
    ("space", {"x": [-0.002, 0.002], "y": [-0.002, 0.002], "z": [2, 2.004], "interval": 0.001}),
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
        for i in range(
            len(value) if path == ("sensor",) else min(1, len(value))
        ):  # of numbers, the first
            yield from paths(value[i], (*path, i))


def changed(path, value, study=STUDY):
    """A study with another value at the end of a path; the tables along the path are copied."""
    key, *rest = path
    copied = study.copy()
    copied[key] = changed(rest, value, study[key]) if rest else value
    return copied


def key_of(path):
    """The last name on the way."""
    return [key for key in path if isinstance(key, str)][-1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hostile")
    car = shapes.box_car()
    pt.write_mesh(folder / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    (folder / "angles.csv").write_text("elevation_deg\n-1\n2\n", "utf-8")
    (folder / "boxes.csv").write_text(
        "class,x,y,z,length,width,height,yaw\ncar,3,1,0.7,4,2,1.4,30\n", "utf-8"
    )
    return folder


def refused(read, *words):
    """The line a study is refused with, checked; None if it is taken."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            read()
        except pe.InputError as error:
            line = str(error)
            assert len(line) < MAX_LINE_LENGTH and line.isprintable(), line
            assert any(word in line for word in words), (words, line)
            return line
    return None


def names_of(path):
    """What a message about a value may call it: its key as in the file, or that of its partner."""
    return [key_of(path), *PARTNERS.get(key_of(path), [])]


ALL = [
    *((STUDY, path) for path in paths(STUDY)),
    *((STUDY | {"prior": BOXES}, ("prior", *path)) for path in paths(BOXES)),
    *((MORE, path) for path in paths(MORE)),
]


def plain(sensor):
    """The sensor; in place of a camera whose lens bends, one that is read at once."""
    return {**sensor, "model": PINHOLE} if "distortion" in sensor["model"] else sensor


def complaint_about(path, value, folder, base=STUDY):
    """What is wrong with how a value at a path is taken or refused; None where nothing is.

    What takes long to read stays where the path leads to it: the mesh, and lenses that bend.
    """
    if path[0] != "vehicle" and base is not MORE:
        base = {key: value for key, value in base.items() if key != "vehicle"}
    if path[0] != "sensor":
        plain = [
            s | {"model": PINHOLE} if "distortion" in s["model"] else s for s in base["sensor"]
        ]
        base = base | {"sensor": plain}
    data = changed(path, value, base)
    try:
        line = refused(lambda: study_from_dict(data, "study.toml", folder), *names_of(path))
        if line is not None:
            where = line.split(": expected")[0]
            assert set(names_of(path)) & set(re.findall("[a-z0-9_]+", where)), line
    except Exception as fault:  # of any kind: all offenders are listed
        return f"{type(fault).__name__}: {fault}"[:MAX_LINE_LENGTH]
    return None


def test_every_key_takes_a_hostile_value_or_refuses_it_in_one_line(folder):
    assert len(ALL) > 100
    tried = {
        (".".join(map(str, path)), name): complaint_about(path, value, folder, base)
        for row, (base, path) in enumerate(ALL)
        for column, (name, value) in enumerate(VALUES.items())
        if (row + column) % STEP == 0
    }
    assert {where: fault for where, fault in tried.items() if fault} == {}


NO_TOML = ["samples = " + "[" * 5000 + "]" * 5000, "samples = 1979-13-45", "samples = \x00"]
NO_TOML += ['samples = "\\ud800"', "\x1b[31m = \u202e"]


def test_a_file_that_is_no_toml_is_one_line(tmp_path):
    """More of them are in test_hostile_files."""
    file = tmp_path / "study.toml"
    for text in NO_TOML:
        file.write_text(text, "utf-8")
        assert refused(lambda: pe.load_study(file), "TOML", "sensor", "samples"), text


def test_a_study_of_nothing_hostile_is_taken(folder):
    for data in (STUDY, STUDY | {"prior": BOXES}, MORE):
        study = study_from_dict(data, "study.toml", folder)
        assert len(study.rig) >= 4 and study.vehicle is not None


@pytest.mark.parametrize(
    ("change", "samples"),
    pairs(EXTREMES, [0, 1024]),
    ids=lambda c: str(c) if isinstance(c, int) else "-".join(map(str, c)),
)
def test_the_extremes_that_are_taken_score_to_finite_numbers(folder, change, samples):
    """Without a warning; a prior of no weight is refused."""
    data = changed(change[:-1], change[-1]) | {"samples": samples}
    if change[0] in ("sensor", "space"):
        for sensor in data["sensor"]:
            sensor.pop("bounds", None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study = study_from_dict(data, "study.toml", folder)
        try:
            score = study.evaluator().score(study.rig)
        except pe.InputError as error:
            assert "weight" in str(error) or "no box" in str(error)
            return
    json.dumps(score.to_dict(), allow_nan=False)
    assert math.isfinite(score.entropy)
