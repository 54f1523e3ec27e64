"""The file of published camera rigs: poses, lenses and AP, checked as they are read.

No row of it is kept: results have its digest, statistics, and our own scores.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import Floats, Number, Table, read_bytes
from pe_core.base.setting import OneOf
from pe_core.base.values import ANY, vector

from ..results_file import read_json

FAMILY = ("R1", "R1-c6", "R1-c10", "R1-f", "R1-r", "R1-t")
"""One rig and what was changed of it."""
APART = tuple(f"R{k}" for k in range(1, 10))
"""The rigs of which none is another one varied."""
JUDGED = APART[1:]
"""Those that a curve, fitted to the family, is judged on."""
RIGS = (*FAMILY, *JUDGED)
DETECTORS = ("BEVDet", "BEVFusion")
OUTCOMES = ("car", "adult", "mAP")
IMAGE = (1280, 720)
SHARE = Number(0.0, 1.0)
FIELD = Number(1.0, 179.0, unit="degrees", noun="angle")
SIZES_M = {
    "vehicle.audi.etron": (4.856, 2.033),
    "vehicle.audi.tt": (4.181, 1.994),
    "vehicle.carlamotors.firetruck": (8.580, 2.901),
    "vehicle.carlamotors.european_hgv": (7.924, 2.865),
}
"""Length and width of CARLA's vehicles, as the plan has them."""
PLATE_M = 0.3
"""Height of the plate that is the body: all cameras are above it."""
CARS = ("vehicle.audi.etron", "vehicle.audi.tt")


@dataclass(frozen=True)
class PublishedRig:
    """A rig of the file: its vehicle, and its cameras as this project has them."""

    name: str
    vehicle: str
    rig: pe.Rig

    @property
    def pixels_per_degree(self) -> float:
        """1280 over the horizontal field in degrees, mean over the cameras."""
        cameras = [sensor.model for sensor in self.rig if isinstance(sensor.model, pe.Camera)]
        return float(np.mean([camera.width / math.degrees(camera.hfov) for camera in cameras]))

    @property
    def height(self) -> float:
        """Mean height of the cameras above the ground [m]."""
        return float(np.mean([sensor.pose.position[2] for sensor in self.rig]))

    @property
    def rivals(self) -> dict[str, float]:
        """The simplest alternatives to a score, by name."""
        return {
            "number of cameras": float(len(self.rig)),
            "pixels per degree": self.pixels_per_degree,
            "mean height": self.height,
        }


@dataclass(frozen=True)
class PublishedRigs:
    """All rigs of the file in the order of `RIGS`, their AP, and the digest of the file.

    `by_detector` has the AP (R,) by detector and outcome.
    """

    rigs: Sequence[PublishedRig]
    by_detector: Mapping[str, Mapping[str, Floats]]
    digest: str

    def ap(self, outcome: str) -> Floats:
        """Return the mean AP of the detectors, (R,)."""
        return np.mean([by_outcome[outcome] for by_outcome in self.by_detector.values()], axis=0)


def positions_of(names: Sequence[str]) -> list[int]:
    """Return the positions of rigs in `RIGS`."""
    return [RIGS.index(name) for name in names]


def read_rigs(path: Path, detectors: Sequence[str] = DETECTORS) -> PublishedRigs:
    """Return the rigs of a file and the AP of some detectors; `InputError` where it has others."""
    table = Table(read_json(path), str(path))
    rigs = table.at("rigs", {})
    if set(rigs.table) != set(RIGS):
        raise InputError(path, "rigs", ", ".join(RIGS), ", ".join(rigs.table))
    aps = table.at("ap", {})
    found: dict[str, dict[str, Floats]] = {}
    for detector in detectors:
        if detector not in aps:
            raise InputError(path, "ap", f"the detector {detector}", ", ".join(aps.table))
        of_detector = aps.at(detector, {})
        rows = [of_detector.at(name, {}) for name in RIGS]
        found[detector] = {
            outcome: np.array([row.number(outcome, rule=SHARE) for row in rows])
            for outcome in OUTCOMES
        }
    read = [_rig(rigs.at(name, {}), name) for name in RIGS]
    return PublishedRigs(read, found, hashlib.sha256(read_bytes(path)).hexdigest())


def _rig(row: Table, name: str) -> PublishedRig:
    vehicle = row.text("vehicle", rule=OneOf(tuple(SIZES_M)))
    cameras = [_camera(table, number) for number, table in enumerate(row.at("cameras", []).items)]
    return PublishedRig(name, vehicle, pe.Rig(cameras))


def _three(table: Table, key: str) -> tuple[float, ...]:
    return vector(table.source, table.field(key), table.raw(key), count=3, rule=ANY)


def _camera(table: Table, number: int) -> pe.Sensor:
    hfov = table.number("hfov_deg", rule=FIELD)
    x, y, z = _three(table, "position")
    roll, pitch, yaw = _three(table, "rotation")
    if z < PLATE_M:
        raise table.error(f"z of at least {PLATE_M:g} m, above the plate", f"{z:g}", "position")
    model = pe.Camera(f"pinhole of {hfov:g} deg", *IMAGE, math.radians(hfov))
    return pe.Sensor(f"camera {number}", model, pe.Pose.from_degrees((x, y, z), (roll, pitch, yaw)))
