"""Height of the scan centre of LiDARs above the base of their housing.

Data sets and robot descriptions have the pose of the base; a score needs the centre of the scan.
"""

from __future__ import annotations

import re

SCAN_ABOVE_BASE_M = {
    "VLP-16": 0.0377,
    "VLS-128": 0.06611,
    "HDL-32E": 0.09081,
    "Pandar40P": 0.047,
    "OT128": 0.09,
    "XT32": 0.0464,
    "QT128": 0.0582,
    "QT128C2X": 0.0582,
    "QT64": 0.0504,
}
"""By a word of the model's name: `base_scan_joint` of tier4's sensor_component_description
(03ba094) for Hesai, VLP-16 and VLS-128, of tier4's velodyne_simulator (daf518d) for HDL-32E."""
WORD = re.compile(r"[^\s()/]+")


def scan_above_base(model: str | None) -> float:
    """Return the height of a model's scan centre above its base [m]; 0 if it is not known."""
    words = WORD.findall(model or "")
    return next((SCAN_ABOVE_BASE_M[word] for word in words if word in SCAN_ABOVE_BASE_M), 0.0)
