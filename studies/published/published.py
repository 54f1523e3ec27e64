"""Published placements and the AP of detectors on them, as the papers have them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe

from ..results_file import read_json

TABLE = Path(__file__).parent / "data" / "published_placements.json"
DEGREES, RADIANS = "degrees", "radians"
READINGS = (DEGREES, RADIANS)
"""The units that a printed roll may have."""
CLEAN = "clean"


@dataclass(frozen=True)
class Paper:
    """A paper's placements and results, as the table of data has them.

    `read` names the tables that figures were read from, `notes` what is uncertain about them;
    `classes` has the paper's names of the classes. All LiDARs are equal. AP is by condition,
    detector, class and placement; `surrogates` are the authors' own scores, higher for better.
    """

    id: str
    short: str
    citation: str
    repository: str
    read: str
    notes: tuple[str, ...]
    classes: Mapping[str, str]
    lidar: Mapping[str, float]
    placements: Mapping[str, list[dict[str, Any]]]
    ap: Mapping[str, Mapping[str, Mapping[str, Mapping[str, float]]]]
    surrogates: Mapping[str, Mapping[str, Mapping[str, float]]]

    def rolled(self, placement: str) -> bool:
        """Return whether a placement has a LiDAR with a printed roll."""
        return any("roll_printed" in sensor for sensor in self.placements[placement])

    def readings(self, placement: str) -> tuple[str, ...]:
        """Return the readings that differ for a placement: one if it has no rolls."""
        return READINGS if self.rolled(placement) else READINGS[:1]

    def rig(self, placement: str, reading: str) -> pe.Rig:
        """Return a placement's sensors, with its printed rolls in the unit of a reading."""
        sensors = (self._sensor(row, reading) for row in self.placements[placement])
        return pe.Rig(list(sensors))

    def height(self, placement: str) -> float:
        """Return the mean height of the LiDARs [m]."""
        rows = self.placements[placement]
        return float(np.mean([row["position"][2] for row in rows if row["kind"] == "lidar"]))

    def _sensor(self, row: Mapping[str, Any], reading: str) -> pe.Sensor:
        if row["kind"] == "camera":
            rotation = (0.0, 0.0, row["yaw_deg"])
            return pe.Sensor(
                row["name"], _camera(row), pe.Pose.from_degrees(row["position"], rotation)
            )
        printed = row.get("roll_printed", 0.0)
        roll = printed if reading == DEGREES else math.degrees(printed)
        pose = pe.Pose.from_degrees(row["position"], (roll, 0.0, 0.0))
        return pe.Sensor(row["name"], self._lidar, pose)

    @property
    def _lidar(self) -> pe.Lidar:
        data = self.lidar
        channels = int(data["channels"])
        elevations = np.radians(np.linspace(data["low_deg"], data["high_deg"], channels))
        name = f"{self.short} LiDAR"
        return pe.Lidar(name, elevations, int(data["azimuth_count"]), data["max_range_m"])


def _camera(row: Mapping[str, Any]) -> pe.Camera:
    (width, height), hfov_deg = row["image"], row["hfov_deg"]
    return pe.Camera(f"camera of {hfov_deg} deg", width, height, math.radians(hfov_deg))


@cache
def papers() -> tuple[Paper, ...]:
    """Return the papers of the project's table of published placements."""
    return tuple(
        Paper(**{**row, "notes": tuple(row["notes"])}) for row in read_json(TABLE)["papers"]
    )


def paper_of(name: str) -> Paper:
    """Return a paper by its id."""
    return next(paper for paper in papers() if paper.id == name)
