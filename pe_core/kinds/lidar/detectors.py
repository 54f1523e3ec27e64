"""AP curves of objects that LiDARs see."""

from __future__ import annotations

from ...metric.entropy import POINTPILLARS, ApCurve
from ..object_curves import all_carried_over

FITTED = {
    "car": ApCurve(0.237, -0.516),
    "pedestrian": ApCurve(0.163, -0.306),
    "cyclist": ApCurve(0.143, -0.022),
}
"""Fits of AP to the beams of an HDL-64E that end on the box (`pe fit` on docs/objects/*.csv):
PointRCNN's detections in KITTI's tracking sequences (from the public AB3DMOT repository), AP at 40
recalls by KITTI's overlaps (0.7 for cars, 0.5 for the others). The detector was trained on drives
that overlap with these: its AP is on the high side."""
OBJECT_CURVES = all_carried_over(POINTPILLARS) | FITTED
