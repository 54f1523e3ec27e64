"""A study file holds the whole study: random studies, written and read, are equal to the bit."""

import math
import struct
from dataclasses import fields, is_dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import pe_core as pe
import pe_tools as pt
from pe_core.base.table_reader import dumps
from pe_core.search import AXES
from pe_core.study.study_file import study_from_dict, study_to_dict
from tests.engine import shapes
from tests.thorough import tries

BOX_TABLE = "class,x,y,z,length,width,height,yaw\ncar,9,1,0.7,4,2,1.4,30\ntram,-20,3,2,15,2.5,4,0\n"
PARTS = ("body", "cabin")
REPEATABLE = settings(
    max_examples=tries(20, 40),
    derandomize=True,
    deadline=None,
    database=None,
    phases=[Phase.generate],  # shrinking a whole study takes minutes
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
NAMES = st.text(
    st.characters(codec="utf-8", exclude_categories=("C", "Zl", "Zp", "Zs")), min_size=1, max_size=9
)
TURN = st.floats(-2 * math.pi, 2 * math.pi)
METRES = st.floats(-50, 50)
SIZES = st.floats(1e-3, 1e3)
CAMERAS = st.builds(
    pe.Camera, NAMES, st.integers(1, 9000), st.integers(1, 9000), st.floats(0.01, math.pi - 0.01)
)
SMALL = st.floats(-0.02, 0.02)
FOCAL = st.floats(400, 2000)
CENTER = st.tuples(st.floats(100, 540), st.floats(100, 380))
CIRCLE = st.one_of(st.none(), st.floats(0.3, 1.0))
CATALOGUE = st.sampled_from(pe.catalog.names()).map(pe.catalog.load)
POSES = st.builds(pe.Pose, st.tuples(METRES, METRES, METRES), st.tuples(TURN, TURN, TURN))
SENSOR = {"name": "roof", "model": "Pandar64", "position": [0, 0, 2]}
MAYBE_M = st.one_of(st.none(), st.floats(1e-3, 99))
REFERENCES = st.builds(pe.Reference, METRES, st.floats(1e-3, 9), MAYBE_M, MAYBE_M, MAYBE_M)
CURVES = st.builds(pe.ApCurve, st.floats(1e-3, 9), st.floats(-9, 9))
OBJECTS = st.builds(pe.TargetRule, st.just("objects"), st.booleans(), st.integers(8, 20_000))
TARGETS = st.one_of(st.builds(pe.TargetRule, scenes=st.integers(8, 999)), OBJECTS)
LIMITS = st.builds(
    pe.Limits, height=st.one_of(st.none(), SIZES), width=SIZES, distance=st.floats(0, 9)
)


# --- equality, field by field -------------------------------------------------------------------


def differences(a, b, path="study"):
    """Where two values differ by a bit; dataclasses are walked, so a new field is compared too."""
    if type(a) is not type(b):
        return [f"{path}: {type(a).__name__} is not {type(b).__name__}"]
    if isinstance(a, float):
        return [] if struct.pack("<d", a) == struct.pack("<d", b) else [f"{path}: {a!r} {b!r}"]
    if isinstance(a, np.ndarray):
        same = a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
        return [] if same else [f"{path}: arrays differ"]
    pairs = children(a, b)
    if pairs is None:
        return [] if a == b else [f"{path}: {a!r} {b!r}"]
    if len(pairs[0]) != len(pairs[1]) or list(pairs[0]) != list(pairs[1]):
        return [f"{path}: {list(pairs[0])} {list(pairs[1])}"]
    return [
        d for key in pairs[0] for d in differences(pairs[0][key], pairs[1][key], f"{path}.{key}")
    ]


def children(a, b):
    """What two values are made of, by name; None for what is one value."""
    if is_dataclass(a):
        return [{f.name: getattr(v, f.name) for f in fields(v)} for v in (a, b)]
    if isinstance(a, pe.PerceptionModel):
        return [{"blind": v.blind, "objects": v.objects, **v.curves} for v in (a, b)]
    if isinstance(a, dict):
        return [a, b]
    if isinstance(a, (list, tuple)):
        return [dict(enumerate(v)) for v in (a, b)]
    return None


# --- random studies -------------------------------------------------------------------------------


def pairs(values, start=None):
    """Two numbers, low before high, with a start between them if there is one."""
    held = st.just(start) if start is not None else values
    return st.tuples(values, values, held).map(lambda v: (min(v), max(v)))


@st.composite
def lidars(draw):
    count = draw(st.integers(1, 5))
    angles = st.lists(st.floats(-math.pi / 2, math.pi / 2), min_size=count, max_size=count)
    fov = draw(
        st.one_of(
            st.just((-math.pi, math.pi)),
            st.tuples(st.floats(-math.pi, -0.5), st.floats(0.5, math.pi)),
        )
    )
    offsets = draw(st.one_of(st.none(), angles))
    steps = draw(st.integers(30, 4000))
    range_m = draw(st.floats(0.5, 900))
    least = draw(st.sampled_from([0.0, 0.1, 0.4]))
    return pe.Lidar(
        draw(NAMES),
        draw(angles),
        steps,
        range_m,
        azimuth_offsets=offsets,
        horizontal_fov=fov,
        min_range=least,
    )


@st.composite
def lens_cameras(draw):
    cx, cy = draw(CENTER)
    circle = draw(CIRCLE)
    lens = draw(st.sampled_from([pe.Pinhole, pe.BrownConrady, pe.KannalaBrandt, pe.FTheta]))
    first = {"k1": draw(st.floats(300, 900))} if lens is pe.FTheta else {}
    values = {key: draw(SMALL) for key in lens.coefficients} | first
    focal = (1.0, 1.0) if lens is pe.FTheta else (draw(FOCAL), draw(FOCAL))
    ranges = draw(st.one_of(st.just((0.0, math.inf)), st.tuples(st.floats(0, 1), METRES.map(abs))))
    name = draw(NAMES)
    width = 640
    height = 480
    hfov = None
    min_range = ranges[0]
    max_range = ranges[1] + 2.0
    try:
        return pe.Camera(
            name,
            width,
            height,
            hfov,
            lens=lens(*focal, cx, cy, circle, **values),
            min_range=min_range,
            max_range=max_range,
        )
    except pe.InputError:  # it folds inside the picture: the same lens without distortion
        return pe.Camera(
            name,
            width,
            height,
            hfov,
            lens=lens(*focal, cx, cy, circle, **first),
            min_range=min_range,
            max_range=max_range,
        )


@st.composite
def rigs(draw):
    names = draw(st.lists(NAMES, min_size=1, max_size=4, unique=True))
    sensors = []
    for name in names:
        model = draw(st.one_of(CATALOGUE, lidars(), CAMERAS, lens_cameras()))
        group = draw(st.one_of(st.none(), NAMES))
        fusion = None if group is None else f"{model.kind} {group} shared"
        curve = draw(st.one_of(st.none(), st.builds(pe.ApCurve, st.floats(0.01, 1), SMALL)))
        shared = fusion or model.fuses_early  # a group has one curve
        sensors.append(pe.Sensor(name, model, draw(POSES), fusion, curve=None if shared else curve))
    return pe.Rig(sensors)


@st.composite
def searches(draw, rig, vehicle):
    free = {}
    limits = {}
    for sensor in rig:
        if draw(st.booleans()):
            free[sensor.name] = tuple(draw(st.lists(st.sampled_from(AXES), unique=True)))
        start = dict(zip(AXES, (*sensor.pose.position, *sensor.pose.rpy), strict=True))
        axes = draw(st.lists(st.sampled_from(AXES), unique=True))
        limits[sensor.name] = {
            a: draw(pairs(METRES if a in "xyz" else TURN, start[a])) for a in axes
        }
    schedule = pe.Schedule(candidates=draw(st.integers(1, 10**6)))
    samples = draw(st.sampled_from([0, 1024, 65_536]))
    mounting = draw(mountings(rig, vehicle, limits))
    seed = draw(st.integers(0, 2**63 - 1))
    tolerance = draw(tolerances(len(rig)))
    return pe.Search(
        free,
        limits,
        seed,
        samples,
        schedule=schedule,
        mounting=mounting,
        method="random",
        tolerance=tolerance,
    )


@st.composite
def tolerances(draw, sensors):
    position = draw(st.floats(0, 1))
    angle = draw(st.floats(0, math.pi / 4))
    failures = sensors > 1 and draw(st.booleans())
    worst = (position > 0 or angle > 0 or failures) and draw(st.booleans())
    return pe.Tolerance(position, angle, 2 * draw(st.integers(1, 9)), failures, worst=worst)


@st.composite
def mountings(draw, rig, vehicle, limits):
    """Mounts of all kinds, on which sensors start that can; ties; constraints that may not fit."""
    named = st.lists(NAMES, min_size=2, max_size=2, unique=True)
    names = draw(named)
    parts = ("body",) if vehicle is None else vehicle.part_names
    first = next(iter(rig))
    mounts = {}
    on = {}
    if draw(st.booleans()):
        others = [pe.Slot(name, draw(POSES)) for name in names if name != first.name]
        mounts[names[0]] = pe.SlotMount([pe.Slot(first.name, first.pose), *others])
        if not limits.get(first.name):
            on[first.name] = names[0]
    if draw(st.booleans()):
        some = draw(st.lists(st.sampled_from(parts), min_size=1, unique=True))
        how = draw(st.sampled_from(["upright", "normal", "facing"]))
        mounts[names[1]] = pe.SurfaceMount(some, draw(st.floats(0, 9)), how)
    followers = [sensor.name for sensor in rig if sensor.name != first.name]
    tied = draw(st.booleans()) and followers and not limits.get(followers[0])
    groups = [(first.name, followers[0])] if tied else []
    return pe.Mounting(mounts, on, pairs=(), groups=groups, constraints=draw(constraints()))


@st.composite
def constraints(draw):
    sides = st.one_of(st.none(), pairs(METRES).filter(lambda p: p[0] < p[1]))
    names = draw(st.lists(NAMES, max_size=2, unique=True))
    areas = [pe.NoGo(name, draw(sides), draw(sides), (0.0, math.inf)) for name in names]
    return pe.Constraints(draw(st.booleans()), areas)


@st.composite
def object_classes(draw):
    share = draw(st.floats(0, 1))
    lanes = tuple(draw(st.lists(METRES, min_size=1, max_size=3)))
    scales = [draw(SIZES) for _ in range(4)]
    size = tuple(draw(SIZES) for _ in range(3))
    return pe.ObjectClass(
        draw(NAMES),
        size,
        *scales,
        share,
        lanes,
        draw(st.floats(0, 9)),
        draw(st.floats(0, 9)),
        draw(st.floats(0, 9)),
        draw(st.floats(0, 1)),
    )


@st.composite
def priors(draw, folder):
    kind = draw(st.sampled_from(["road", "highway", "uniform", "boxes", "own"]))
    if kind == "boxes":
        prior = pe.study_from_dict(
            {"sensor": [SENSOR], "prior": {"boxes": "table.csv", "origin": [1, 0.1, 0]}},
            folder=folder,
        ).prior
    elif kind == "own":
        own = draw(st.lists(object_classes(), max_size=2, unique_by=lambda c: c.name))
        shipped = draw(st.permutations(pe.Prior.road().classes))
        count = draw(st.integers(1, 5))
        names = {c.name for c in own}
        prior = pe.Prior("road", (*own, *(c for c in shipped[:count] if c.name not in names)))
    else:
        prior = getattr(pe.Prior, kind)()
    edges = st.one_of(st.just((-math.inf, math.inf)), pairs(METRES).filter(lambda p: p[0] < p[1]))
    some = st.lists(st.sampled_from(prior.class_names), unique=True).map(tuple)
    one = st.builds(pe.Focus, st.floats(0, 9), edges, edges, st.one_of(st.none(), some))
    focus = tuple(draw(st.lists(one, max_size=2)))
    dense = draw(st.dictionaries(st.sampled_from(prior.class_names), st.floats(0, 99)))
    return type(prior)(prior.model, prior.classes, focus, prior.boxes, dense)


@st.composite
def spaces(draw):
    interval = draw(st.sampled_from([0.1, 0.5, 0.3, 1.0, 0.25]))
    bounds = []
    for _ in "xyz":
        low = draw(st.integers(-500, 500))
        voxels = draw(st.integers(1, 900))
        bounds.append((low * interval, (low + voxels) * interval))
    return pe.PerceptionSpace(*bounds, interval)


@st.composite
def vehicles(draw):
    car = shapes.box_car()
    moved = car.triangles + draw(st.tuples(METRES, METRES, METRES))
    glass = draw(st.lists(st.sampled_from(PARTS), unique=True))
    names = draw(st.lists(NAMES, min_size=2, max_size=2, unique=True))
    renamed = dict(zip(PARTS, names, strict=True))
    clearance = draw(st.floats(0, 0.99))
    return pe.Vehicle(
        moved, car.parts, tuple(names), tuple(renamed[g] for g in glass), clearance=clearance
    )


@st.composite
def mesh_axes(draw):
    """Keys for the mesh's axes that leave a file in the ground frame as it is."""
    up = draw(st.sampled_from([None, "+z"]))
    forward = draw(st.sampled_from([None, "+x"]))
    return pe.MeshAxes(up, forward, 1.0, draw(st.sampled_from([None, (0.0, 0.0, 0.0)])))


@st.composite
def selections(draw, rig):
    """Choices of one sensor, and limits that leave a design."""
    some = draw(st.lists(st.one_of(CATALOGUE, CAMERAS), max_size=3, unique_by=lambda m: m.name))
    options = [pe.Option(model, draw(st.floats(0, 1e6))) for model in some]
    choices = [pe.Choice(options, [[*rig][-1].name], None, draw(st.booleans()))] if some else []
    count = st.one_of(st.none(), st.integers(9, 99))
    kinds = {kind: n for kind in ("lidar", "camera") if (n := draw(count)) is not None}
    return pe.Selection(choices, draw(count), kinds, draw(st.one_of(st.just(""), NAMES)))


@st.composite
def studies(draw, folder):
    rig = draw(rigs())
    vehicle = draw(st.one_of(st.none(), vehicles()))
    lidar = draw(CURVES)
    camera = draw(CURVES)
    classes = st.dictionaries(NAMES, CURVES, max_size=2)
    objects = {kind: own for kind in ("lidar", "camera") if (own := draw(classes))}
    blind = draw(st.sampled_from(["floor", "literal"]))
    return pe.Study(
        rig,
        vehicle,
        draw(spaces()),
        draw(priors(folder)),
        pe.PerceptionModel(blind, objects=objects, lidar=lidar, camera=camera),
        draw(searches(rig, vehicle)),
        draw(st.sampled_from([0, 1024, 10_007])),
        *((None,) if vehicle is None else ("body.npz", draw(mesh_axes()))),
        reference=draw(st.one_of(st.none(), REFERENCES)),
        selection=draw(selections(rig)),
        limits=draw(LIMITS),
        targets=draw(TARGETS),
    )


# --- the tests ------------------------------------------------------------------------------------


@REPEATABLE
@given(st.data())
def test_a_random_study_comes_back_from_its_file_equal_in_every_field(data):
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "table.csv").write_text(BOX_TABLE, "utf-8")
        study = data.draw(studies(folder))
        if study.vehicle is not None:
            body = study.vehicle
            mesh = pe.Mesh(body.triangles, body.parts, body.part_names)
            pt.write_mesh(folder / study.mesh, mesh)
        pe.save_study(study, folder / "study.toml")
        again = pe.load_study(folder / "study.toml")
    assert differences(study, again) == []
    assert study_to_dict(again) == study_to_dict(study)
    assert dumps(study_to_dict(again)) == dumps(study_to_dict(study))


@settings(REPEATABLE, max_examples=tries(8, 15))
@given(st.data())
def test_an_exported_study_holds_the_same_prior_and_vehicle(data):
    with TemporaryDirectory() as first, TemporaryDirectory() as second:
        folder = Path(first)
        (folder / "table.csv").write_text(BOX_TABLE, "utf-8")
        study = data.draw(studies(folder))
        pt.export_study(study, Path(second) / "study.toml")
        again = pe.load_study(Path(second) / "study.toml")
    assert again.prior == study.prior
    assert not differences(study.vehicle, again.vehicle)
    assert not differences(study.rig, again.rig)
    assert not differences(study.search, again.search)
    assert not differences(study.selection, again.selection)


def test_a_difference_of_one_bit_or_a_forgotten_field_is_seen():
    study = pe.Study(pe.Rig([shapes.lidar_on_roof()]))
    moved = pe.Pose((-0.43, 0.0, math.nextafter(1.8, 2.0)))
    rig = pe.Rig([shapes.lidar_on_roof().moved(moved)])
    (line,) = differences(study, study.with_rig(rig))
    assert line.startswith("study.rig.sensors.0.pose.position.2: 1.8")
    for field in fields(pe.Schedule):
        value = getattr(pe.Schedule(), field.name)
        other = pe.Schedule(**{field.name: 7 if isinstance(value, int) else value * 0.9})
        assert differences(pe.Schedule(), other)
    assert differences(0.0, -0.0) and differences(1, 1.0) and differences((1,), (1, 2))


def test_a_placement_rounded_past_its_bound_can_be_read_again():
    sensor = SENSOR | {"position": [0, 0, 1.5], "bounds": {"z": [1.500004, 2.0]}}
    assert study_from_dict({"sensor": [sensor]}).rig["roof"].pose.position[2] == 1.5
    with pytest.raises(pe.InputError, match="bounds of z"):
        study_from_dict({"sensor": [sensor | {"position": [0, 0, 1.49999]}]})
