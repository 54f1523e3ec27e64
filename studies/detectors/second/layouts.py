"""Scenes from logs of real traffic: boxes stand on flat ground, with the shapes of other scenes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pe_core import InputError

from ...road.logs import CLASSES as OF_LOGS
from ...road.logs import Log, read_logs
from ..placements import vehicle
from ..plan import StudyPlan
from ..scenes import CLASSES, Scene, Things, assembled

LAYOUTS = "layouts"
"""The world of part 3, and the name of its design."""
EVERY_FRAMES = 20
"""A frame every 2 s: logs have 10 Hz."""
BOLLARD = "bollard"


class Layouts:
    """The scenes of a folder of logs; calling it returns a scene, as `scenes.scene` does."""

    def __init__(self, folder: Path) -> None:
        self.logs = [log.every(EVERY_FRAMES) for log in read_logs(folder)]
        self._frames = [
            (log, int(frame)) for log in self.logs for frame in np.unique(log.objects.scenes)
        ]
        self._scenes: dict[tuple[str, int], Scene] = {}
        if not any(np.isin(log.objects.labels, _labels(CLASSES)).any() for log in self.logs):
            raise InputError(folder, "category", f"boxes of {', '.join(CLASSES)}", "none")

    def __len__(self) -> int:
        return len(self._frames)

    def __call__(
        self, plan: StudyPlan, vehicle_name: str, split: str, world: str, number: int
    ) -> Scene:
        """Return a scene by its number; plan, split and world do not matter."""
        key = vehicle_name, number
        if key not in self._scenes:
            log, frame = self._frames[number]
            objects = _things(log, frame, vehicle_name, CLASSES)
            bollards = _things(log, frame, vehicle_name, (BOLLARD,))
            self._scenes[key] = assembled(objects, bollards, None, [])
        return self._scenes[key]


def _labels(names: tuple[str, ...]) -> list[int]:
    return [OF_LOGS.index(name) for name in names]


def _things(log: Log, frame: int, vehicle_name: str, names: tuple[str, ...]) -> Things:
    """Return the boxes of some classes whose circle does not meet that round the vehicle."""
    boxes = log.objects
    wanted = (boxes.scenes == frame) & np.isin(boxes.labels, _labels(names))
    low, high = (corner[:2] for corner in vehicle(vehicle_name).bounds)
    away = np.hypot(*(boxes.centers[:, :2] - (low + high) / 2.0).T)
    radii = np.hypot(boxes.sizes[:, 0], boxes.sizes[:, 1]) / 2.0
    kept = np.flatnonzero(wanted & (away > radii + np.hypot(*(high - low)) / 2.0))
    feet = boxes.centers[kept] * (1.0, 1.0, 0.0)
    return Things(
        [OF_LOGS[k] for k in boxes.labels[kept]], feet, boxes.sizes[kept], boxes.yaws[kept]
    )
