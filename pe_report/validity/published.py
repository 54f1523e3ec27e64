"""The published placements and what detectors reached on them: facts, read from the papers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe

from ..read import read_json

TABLE = Path(__file__).resolve().parent.parent / "data" / "published_placements.json"
DEGREES, RADIANS = "degrees", "radians"
READINGS = (DEGREES, RADIANS)
"""How a printed roll may be meant."""
CLEAN = "clean"


@dataclass(frozen=True)
class Paper:
    """A paper's placements and results.

    Attributes
    ----------
    id, short, citation, repository, read : str
        What it is called, and where its figures were read.
    notes : tuple of str
        What is not sure about them.
    classes : mapping
        Our classes to the paper's.
    lidar : mapping
        The LiDARs, all alike.
    placements : mapping
        Name to sensors.
    ap : mapping
        AP by condition, detector, class, placement.
    surrogates : mapping
        The authors' own scores by name, class, placement; higher is better.
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
        """Whether a placement has a LiDAR with a printed roll."""
        return any("roll_printed" in sensor for sensor in self.placements[placement])

    def readings(self, placement: str) -> tuple[str, ...]:
        """Return the readings that differ for a placement: one where nothing is rolled."""
        return READINGS if self.rolled(placement) else READINGS[:1]

    def rig(self, placement: str, reading: str) -> pe.Rig:
        """Return a placement's sensors, with its printed rolls read one way."""
        sensors = (self._sensor(row, reading) for row in self.placements[placement])
        return pe.Rig(list(sensors))

    def height(self, placement: str) -> float:
        """Mean height of the LiDARs [m]."""
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
        of = self.lidar
        elevations = np.radians(np.linspace(of["low_deg"], of["high_deg"], int(of["channels"])))
        return pe.Lidar(
            f"{self.short} LiDAR", elevations, int(of["azimuth_count"]), of["max_range_m"]
        )


def _camera(row: Mapping[str, Any]) -> pe.Camera:
    (width, height), hfov_deg = row["image"], row["hfov_deg"]
    return pe.Camera(f"camera of {hfov_deg} deg", width, height, math.radians(hfov_deg))


@cache
def papers() -> tuple[Paper, ...]:
    """Return the papers of the project's table."""
    return tuple(
        Paper(**{**row, "notes": tuple(row["notes"])}) for row in read_json(TABLE)["papers"]
    )


def paper_of(name: str) -> Paper:
    """Return a paper by its id."""
    return next(paper for paper in papers() if paper.id == name)
