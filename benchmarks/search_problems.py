"""The problems on which methods of search are compared: a function each, and a row of `PROBLEMS`.

Every problem is a whole study of a moderate size: voxels of 0.5 m, and LiDARs with so few beams
that as many meet a voxel as on the usual grid. One evaluation takes 3 to 60 ms.

Problems that judge a method must have no part in its settings: see `SearchProblem`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import pe_core as pe
from tests.engine.shapes import box, refined

SPACE = pe.PerceptionSpace((-60.0, 60.0), (-30.0, 30.0), (0.0, 5.0), 0.5)
BUDGETS = ("small", "default")
"""Evaluations of a run: those of the problem, or as many as a study that names none has."""
SAMPLES = 8192
"""Voxels on which the methods evaluate a placement; its entropy on the grid is compared."""
SEDAN = Path(__file__).resolve().parent.parent / "blend_assets" / "experiments" / "1_pandar64.toml"
PUCK = "Velodyne VLP-16 Puck"
"""A model whose housing the catalogue knows."""
UPRIGHT = (0.0, 0.0, 0.0)
ANY_SLOPE = math.pi
"""Of an upright sensor on a bumper or a side: the face may be vertical."""
Vector3 = tuple[float, float, float]
AxisLimits = dict[str, tuple[float, float]]
CAR = {
    "body": ((-2.3, -0.9, 0.2), (2.3, 0.9, 0.9)),
    "cabin": ((-1.5, -0.7, 0.85), (0.8, 0.7, 1.45)),
}
SHUTTLE = {
    "hull": ((-3.0, -1.0, 0.3), (3.0, 1.0, 2.4)),
    "pod": ((-0.8, -0.5, 2.35), (0.8, 0.5, 2.6)),
}


def lidar(channels: int = 16, azimuths: int = 180) -> pe.Lidar:
    """Return a LiDAR with few beams, from 25 degrees down to 15 degrees up."""
    elevations = np.radians(np.linspace(-25.0, 15.0, channels))
    return pe.Lidar(f"LiDAR {channels} x {azimuths}", elevations, azimuths, 60.0)


def camera(hfov_deg: float = 60.0) -> pe.Camera:
    """Return a camera with 480 x 270 pixels."""
    return pe.Camera(f"camera {hfov_deg:g} deg", 480, 270, math.radians(hfov_deg))


def sensor(name: str, model: object, position: Vector3, rotation: Vector3 = UPRIGHT) -> pe.Sensor:
    """Return a sensor at a position [m], with roll, pitch, yaw [deg]."""
    model = pe.catalog.load(model) if isinstance(model, str) else model
    return pe.Sensor(name, model, pe.Pose.from_degrees(position, rotation))


def body(boxes: Mapping[str, tuple[Vector3, Vector3]]) -> pe.Vehicle:
    """Return a body of boxes, each a part, with faces above the others as parts of their own.

    A part "NAME top", "NAME left", "NAME front" and "NAME rear" is that face of a box.
    """
    triangles = []
    parts = []
    names = list[str]()
    for name, (low, high) in boxes.items():
        some = refined(box(low, high), 1)
        first = len(names)
        names += [name, f"{name} top", f"{name} left", f"{name} front", f"{name} rear"]
        faces = ((2, high[2]), (1, high[1]), (0, high[0]), (0, low[0]))
        on_face = [(some[:, :, axis] == at).all(axis=1) for axis, at in faces]
        parts.append(np.select(on_face, range(first + 1, first + 5), first).astype(np.int32))
        triangles.append(some)
    return pe.Vehicle(np.concatenate(triangles), np.concatenate(parts), tuple(names))


def study(
    sensors: list[pe.Sensor],
    vehicle: pe.Vehicle | None,
    free: Mapping[str, tuple[str, ...]],
    limits: Mapping[str, AxisLimits] | None = None,
    mounting: pe.Mounting | None = None,
    samples: int = SAMPLES,
    **more: object,
) -> pe.Study:
    """Return a study; bounds of angles are in degrees."""
    bounds = {
        name: {a: b if a in "xyz" else tuple(map(math.radians, b)) for a, b in axes.items()}
        for name, axes in (limits or {}).items()
    }
    search = pe.Search(free, bounds, samples=samples, mounting=mounting or pe.Mounting())
    return pe.Study(pe.Rig(sensors), vehicle, SPACE, search=search, **more)


def two_free() -> pe.Study:
    """Two LiDARs in boxes, nothing in their way."""
    sensors = [
        sensor("a", lidar(32, 240), (1.0, 0.5, 1.5)),
        sensor("b", lidar(), (-1.0, -0.5, 1.5)),
    ]
    limits = {"x": (-2.5, 2.5), "y": (-1.0, 1.0), "z": (0.8, 2.6), "pitch": (-15.0, 15.0)}
    free = dict.fromkeys("ab", tuple(limits))
    return study(sensors, None, free, dict.fromkeys("ab", limits), samples=65_536)


def car_and_pairs() -> pe.Study:
    """A LiDAR on a car's roof and two pairs of cameras on its sides and its front."""
    sensors = [
        sensor("roof", lidar(32, 240), (-0.4, 0.0, 1.6)),
        sensor("side", camera(90.0), (0.0, 0.91, 0.7), (0.0, 0.0, 60.0)),
        sensor("side right", camera(90.0), (0.0, -0.91, 0.7), (0.0, 0.0, -60.0)),
        sensor("front", camera(60.0), (2.31, 0.4, 0.7), (0.0, 0.0, 10.0)),
        sensor("front right", camera(60.0), (2.31, -0.4, 0.7), (0.0, 0.0, -10.0)),
    ]
    mounts = {
        "cabin": pe.SurfaceMount(["cabin top"], 0.15, "upright"),
        "left": pe.SurfaceMount(["body left"], 0.01, "upright", max_slope=ANY_SLOPE),
        "nose": pe.SurfaceMount(["body front"], 0.01, "upright", max_slope=ANY_SLOPE),
    }
    mounting = pe.Mounting(
        mounts=mounts,
        on={"roof": "cabin", "side": "left", "front": "nose"},
        pairs=[("side", "side right"), ("front", "front right")],
    )
    limits = {
        "roof": {"pitch": (-10.0, 10.0)},
        "side": {"pitch": (-20.0, 30.0), "yaw": (0.0, 170.0)},
        "front": {"pitch": (-20.0, 30.0), "yaw": (-60.0, 60.0)},
    }
    free = {name: tuple(axes) for name, axes in limits.items()}
    return study(sensors, body(CAR), free, limits, mounting=mounting)


def corners_and_rack() -> pe.Study:
    """Two LiDARs on bumpers, one of them with a no-go area, and a camera that takes a slot."""
    sensors = [
        sensor("left", lidar(), (2.4, 0.3, 0.6)),
        sensor("rear", lidar(), (-2.4, 0.0, 0.6)),
        sensor("eye", camera(120.0), (0.7, 0.0, 1.55)),
    ]
    places = {
        "front": (0.7, 0.0, 1.55, 0),
        "left": (0.0, 0.7, 1.55, 90),
        "back": (-1.4, 0, 1.55, 180),
    }
    slots = [
        pe.Slot(name, pe.Pose.from_degrees((x, y, z), (0.0, 5.0 * tilt, yaw)))
        for name, (x, y, z, yaw) in places.items()
        for tilt in (0, 1, 2)
    ]
    slots = [pe.Slot(f"{slot.name} {k}", slot.pose) for k, slot in enumerate(slots)]
    mounts = {
        "front": pe.SurfaceMount(["body front"], 0.1, "upright", max_slope=ANY_SLOPE),
        "rear": pe.SurfaceMount(["body rear"], 0.1, "upright", max_slope=ANY_SLOPE),
        "rack": pe.SlotMount(slots),
    }
    mounting = pe.Mounting(
        mounts=mounts,
        on={"left": "front", "rear": "rear", "eye": "rack"},
        constraints=pe.Constraints(no_go=[pe.NoGo("plate", x=(2.0, 3.0), y=(-0.26, 0.26))]),
    )
    limits = {name: {"pitch": (-15.0, 15.0), "roll": (-15.0, 15.0)} for name in ("left", "rear")}
    free = {name: ("roll", "pitch") for name in limits}
    return study(sensors, body(CAR), free, limits, mounting=mounting)


def _around(names: str, models: list[object], far: float, wide: float, z: float) -> list[pe.Sensor]:
    """Return sensors round the origin, the first ahead, each looking outwards."""
    sensors = []
    for k, name in enumerate(names):
        angle = math.tau * k / len(names)
        place = (round(far * math.cos(angle), 3), round(wide * math.sin(angle), 3), z)
        turn = math.remainder(math.degrees(angle), 360.0)
        sensors.append(sensor(name, models[k % len(models)], place, (0.0, 0.0, turn)))
    return sensors


def shuttle_of_eight() -> pe.Study:
    """Four LiDARs at the corners and four cameras above the edges of a shuttle, clear housings."""
    corner = {"x": (-3.4, 3.4), "y": (-1.4, 1.4), "z": (0.4, 2.9), "pitch": (-15.0, 15.0)}
    edge = {"x": (-3.2, 3.2), "y": (-1.2, 1.2), "z": (1.6, 3.0), "pitch": (-10.0, 30.0)}
    sensors = [
        sensor(f"{name}", PUCK, (3.2 * x, 1.2 * y, 1.2))
        for name, (x, y) in zip("abcd", ((1, 1), (1, -1), (-1, 1), (-1, -1)), strict=True)
    ]
    sensors += [each for each in _around("efgh", [camera(90.0)], far=3.1, wide=1.1, z=2.5)]
    limits = {s.name: corner if s.name in "abcd" else edge for s in sensors}
    mounting = pe.Mounting(constraints=pe.Constraints(clear_housings=True))
    return study(
        sensors, body(SHUTTLE), dict.fromkeys(limits, tuple(corner)), limits, mounting=mounting
    )


def eight_free() -> pe.Study:
    """Four LiDARs and four cameras in boxes, the cameras' yaw free, too; nothing in their way."""
    sensors = _around("abcd", [lidar()], far=2.0, wide=1.0, z=1.6)
    sensors += _around("efgh", [camera(60.0)], far=2.0, wide=1.0, z=1.4)
    limits: dict[str, AxisLimits] = {}
    for each in sensors:
        limits[each.name] = {"x": (-3, 3), "y": (-1.5, 1.5), "z": (0.5, 2.6), "pitch": (-20, 20)}
        if each.name in "efgh":
            limits[each.name]["yaw"] = (-270.0, 270.0)
    return study(sensors, None, {name: tuple(axes) for name, axes in limits.items()}, limits)


def traffic() -> pe.Study:
    """Two LiDARs and a camera of a car, scored by objects that occlude each other."""
    sensors = [
        sensor("a", lidar(32, 240), (0.0, 0.3, 1.7)),
        sensor("b", lidar(), (2.4, 0.0, 0.8)),
        sensor("c", camera(90.0), (0.9, 0.0, 1.5)),
    ]
    wide = {"x": (-2.6, 2.6), "y": (-1.1, 1.1), "z": (0.4, 2.2), "pitch": (-15.0, 15.0)}
    free = {name: tuple(wide) for name in "abc"}
    targets = pe.TargetRule("objects", True, 16)
    return study(sensors, body(CAR), free, dict.fromkeys("abc", wide), targets=targets)


def sixteen_free() -> pe.Study:
    """Eight LiDARs and eight cameras in boxes, nothing in their way."""
    sensors = _around("abcdefgh", [lidar(8, 60)], far=2.5, wide=1.0, z=1.8)
    sensors += _around("ijklmnop", [camera(30.0), camera(60.0)], far=2.5, wide=1.0, z=1.5)
    limits: dict[str, AxisLimits] = {}
    for each in sensors:
        limits[each.name] = {"x": (-3, 3), "y": (-1.3, 1.3), "z": (0.5, 3.0), "pitch": (-20, 20)}
        if each.name in "ijklmnop":
            limits[each.name]["yaw"] = (-270.0, 270.0)
    return study(sensors, None, {name: tuple(axes) for name, axes in limits.items()}, limits)


def sedan_of_four() -> pe.Study:
    """Two LiDARs and two cameras round the example's sedan, its real mesh, what is ahead double."""
    example = pe.load_study(SEDAN)
    sensors = [
        sensor("a", lidar(32, 240), (-0.4, 0.0, 1.8)),
        sensor("b", lidar(), (2.5, 0.0, 0.7)),
        sensor("c", camera(60.0), (0.8, 0.0, 1.6)),
        sensor("d", camera(60.0), (-1.6, 0.0, 1.5), (0.0, 0.0, 180.0)),
    ]
    free = {name: ("x", "y", "z", "pitch") for name in "abcd"}
    prior = pe.Prior.road(focus=[pe.Focus(2.0, x=(0.0, math.inf))])
    return study(sensors, example.vehicle, free, prior=prior)


def six_in_slots() -> pe.Study:
    """Three LiDARs and three cameras that share sixteen slots on a roof."""
    slots = []
    for k in range(16):
        angle = math.tau * k / 16
        place = (2.0 * math.cos(angle), math.sin(angle), 1.7 + 0.1 * (k % 3))
        turn = (0.0, float(3 * (k % 4)), math.degrees(angle))
        slots.append(pe.Slot(f"slot {k}", pe.Pose.from_degrees(place, turn)))
    names = "abcdef"
    sensors = [
        pe.Sensor(name, lidar() if name in "abc" else camera(90.0), slots[k].pose)
        for k, name in enumerate(names)
    ]
    mounting = pe.Mounting(mounts={"rack": pe.SlotMount(slots)}, on=dict.fromkeys(names, "rack"))
    return study(sensors, body(CAR), {}, mounting=mounting)


def three_on_roof() -> pe.Study:
    """Three LiDARs on a shuttle's roof, roll and pitch free, at least half a metre apart."""
    place = {"a": (2.5, 0.0, 2.55), "b": (-2.5, 0.6, 2.55), "c": (-2.5, -0.6, 2.55)}
    sensors = [sensor(name, lidar(), at) for name, at in place.items()]
    limits: dict[str, AxisLimits] = {
        n: {"roll": (-25.0, 25.0), "pitch": (-25.0, 25.0)} for n in place
    }
    mounting = pe.Mounting(
        mounts={"roof": pe.SurfaceMount(["hull top"], 0.15, "upright")},
        on=dict.fromkeys(place, "roof"),
    )
    free = dict.fromkeys(place, ("roll", "pitch"))
    found = study(sensors, body(SHUTTLE), free, limits, mounting=mounting)
    return replace(found, limits=pe.Limits(distance=0.5))


def cameras_around() -> pe.Study:
    """Three pairs of cameras on the sides and the front of a car, which look along the normal."""
    place = {"a": (2.31, 0.4, 0.6, 0.0), "b": (0.5, 0.91, 0.6, 90.0), "c": (-1.5, 0.91, 0.6, 90.0)}
    sensors = []
    on = {}
    for name, (x, y, z, yaw) in place.items():
        sensors.append(sensor(name, camera(90.0), (x, y, z), (0.0, 0.0, yaw)))
        sensors.append(sensor(f"{name} right", camera(90.0), (x, -y, z), (0.0, 0.0, -yaw)))
        on[name] = "nose" if name == "a" else "side"
    mounts = {
        "nose": pe.SurfaceMount(["body front"], 0.01, "facing"),
        "side": pe.SurfaceMount(["body left"], 0.01, "facing"),
    }
    mounting = pe.Mounting(mounts=mounts, on=on, pairs=[(n, f"{n} right") for n in place])
    limits: dict[str, AxisLimits] = {
        n: {"pitch": (-30.0, 30.0), "yaw": (-70.0, 70.0)} for n in place
    }
    return study(
        sensors, body(CAR), dict.fromkeys(place, ("pitch", "yaw")), limits, mounting=mounting
    )


def objects_of_five() -> pe.Study:
    """Two LiDARs and three cameras where a shuttle would have them, scored by objects."""
    sensors = [
        sensor("a", lidar(32, 240), (3.2, 1.2, 1.0)),
        sensor("b", lidar(), (-3.2, -1.2, 1.0)),
        *_around("cde", [camera(60.0), camera(90.0)], far=3.1, wide=1.1, z=2.5),
    ]
    wide = {"x": (-3.4, 3.4), "y": (-1.4, 1.4), "z": (0.4, 3.0), "pitch": (-15.0, 20.0)}
    free = {name: tuple(wide) for name in "abcde"}
    targets = pe.TargetRule("objects", False, 32)
    return study(sensors, None, free, dict.fromkeys("abcde", wide), targets=targets)


def corners_in_pairs() -> pe.Study:
    """A pair of LiDARs at the front corners, one at the rear ones of a car, two cameras ahead."""
    sensors = []
    for name, x in (("front", 2.3), ("rear", -2.3)):
        for side, y in (("", 0.9), (" right", -0.9)):
            sensors.append(sensor(f"{name}{side}", lidar(), (x, y, 0.7)))
    sensors += [sensor("wide", camera(90.0), (0.9, 0.0, 1.5))]
    sensors += [sensor("narrow", camera(30.0), (0.9, 0.2, 1.5))]
    corner = {"y": (0.5, 1.2), "z": (0.4, 1.5), "pitch": (-15.0, 15.0), "roll": (-15.0, 15.0)}
    limits: dict[str, AxisLimits] = {"front": {"x": (1.8, 2.7), **corner}}
    limits["rear"] = {"x": (-2.7, -1.8), **corner}
    limits |= {n: {"z": (1.2, 1.8), "pitch": (-20.0, 20.0)} for n in ("wide", "narrow")}
    mounting = pe.Mounting(pairs=[(n, f"{n} right") for n in ("front", "rear")])
    free = {name: tuple(axes) for name, axes in limits.items()}
    return study(sensors, body(CAR), free, limits, mounting=mounting)


def slots_and_ranges() -> pe.Study:
    """Two LiDARs that take slots on a shuttle's roof and two cameras in ranges at its ends."""
    places = [(x, y, 2.75) for x in (-2.5, 0.0, 2.5) for y in (-0.8, 0.8)]
    slots = [pe.Slot(f"slot {k}", pe.Pose(place)) for k, place in enumerate(places)]
    sensors = [pe.Sensor(name, lidar(32, 120), slots[k].pose) for k, name in enumerate("ab")]
    sensors += [sensor("c", camera(120.0), (3.1, 0.0, 1.8))]
    sensors += [sensor("d", camera(120.0), (-3.1, 0.0, 1.8), (0.0, 0.0, 180.0))]
    end = {"y": (-1.0, 1.0), "z": (0.5, 2.6), "pitch": (-10.0, 40.0)}
    mounting = pe.Mounting(mounts={"rack": pe.SlotMount(slots)}, on=dict.fromkeys("ab", "rack"))
    return study(
        sensors,
        body(SHUTTLE),
        dict.fromkeys("cd", tuple(end)),
        dict.fromkeys("cd", end),
        mounting=mounting,
    )


def tilted_ring() -> pe.Study:
    """Five LiDARs round a shuttle, all but their places free, what is at its sides double."""
    sensors = _around("abcde", [lidar(16, 120)], far=3.1, wide=1.2, z=2.0)
    turns = {"z": (0.5, 3.0), "roll": (-30.0, 30.0), "pitch": (-30.0, 30.0)}
    prior = pe.Prior.road(focus=[pe.Focus(2.0, x=(-3.0, 3.0))])
    free = dict.fromkeys("abcde", tuple(turns))
    return study(sensors, body(SHUTTLE), free, dict.fromkeys("abcde", turns), prior=prior)


@dataclass(frozen=True, slots=True)
class SearchProblem:
    """A problem: what it is, its study, how many evaluations, and how it is marked.

    "kept" ones had no part in the choice of a setting until the search became one race; "new" ones
    were written down after that, and nothing was changed since they were run.
    """

    make: Callable[[], pe.Study]
    evaluations: int
    mark: str = ""


PROBLEMS = {
    "two free": SearchProblem(two_free, 250),
    "car and pairs": SearchProblem(car_and_pairs, 250),
    "corners and rack": SearchProblem(corners_and_rack, 250),
    "shuttle of eight": SearchProblem(shuttle_of_eight, 250),
    "eight free": SearchProblem(eight_free, 500),
    "traffic": SearchProblem(traffic, 150),
    "sixteen free": SearchProblem(sixteen_free, 600, "kept"),
    "sedan of four": SearchProblem(sedan_of_four, 200, "kept"),
    "six in slots": SearchProblem(six_in_slots, 150, "kept"),
    "three on roof": SearchProblem(three_on_roof, 250, "kept"),
    "cameras around": SearchProblem(cameras_around, 300, "kept"),
    "objects of five": SearchProblem(objects_of_five, 200, "kept"),
    "corners in pairs": SearchProblem(corners_in_pairs, 300, "new"),
    "slots and ranges": SearchProblem(slots_and_ranges, 200, "new"),
    "tilted ring": SearchProblem(tilted_ring, 400, "new"),
}
