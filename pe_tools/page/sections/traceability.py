"""Traceability: sources and limits of the numbers, and everything needed to reproduce them."""

import platform
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import metric
from pe_core import sensors as kinds

from ... import advice, jobs
from ..markup import TEMPLATES, number
from ..report_context import ReportContext

PAPER = "Ma, Liu and Li, “Perception Entropy”, ICRA 2021"
CURVE_SOURCES = {
    metric.POINTPILLARS: f"PointPillars on KITTI, moderate; {PAPER}",
    metric.RTM3D: f"RTM3D on KITTI, moderate; {PAPER}",
}
"""Sources of the AP curves that come with the engine."""
PRIOR_SOURCES = {
    "road": (
        "that of a road: positions of each class are fitted to the boxes that CenterPoint finds in "
        "the 150 validation scenes of nuScenes; sizes are from nuScenes, Argoverse 2 and Waymo"
    ),
    "highway": (
        "that of a motorway: distances are fitted to KITTI tracking and Argoverse 2; lanes and the "
        "shares of the classes are assumptions, not data"
    ),
    "uniform": "uniform: every voxel of the space has the same weight",
    "boxes": "given by labelled boxes of the study",
}
VALIDITY = "over both papers, no score has a significant correlation"
"""The conclusion of `VALIDITY_PAGE`, word for word."""
VALIDITY_PAGE = "docs/validity/README.md"


def assumptions(contexts: tuple[ReportContext, ...]) -> dict[str, Any]:
    """Return the sources of AP curves and prior; they are the same for all studies."""
    study = contexts[0].study
    model = contexts[0].study.model
    sensors = [sensor for context in contexts for sensor in context.rig]
    curves = {kinds.kind_of(s).label: model.curve(s.kind) for s in sensors}
    own = {(s.name, s.curve) for s in sensors if s.curve is not None}
    rows = [*curves.items(), *sorted(own, key=lambda item: item[0])]
    prior_source = PRIOR_SOURCES.get(study.prior.model, study.prior.model)
    boxes = study.prior.boxes
    objects_source = ""
    if contexts[0].after.objects is not None or contexts[0].outcome.in_traffic is not None:
        objects_source = kinds.curve_source(model.model)
    return {
        "curves": [
            [name, number(c.a, 3), number(c.b, 3), CURVE_SOURCES.get(c, "given by the study")]
            for name, c in rows
        ],
        "objects_source": objects_source,
        "prior_source": prior_source if boxes is None else f"{prior_source} ({boxes.source})",
        "validity": VALIDITY,
        "validity_page": VALIDITY_PAGE,
    }


def copy_script() -> tuple[str, ...]:
    """Return the program of the buttons that copy a study."""
    return ((TEMPLATES / "copy.js").read_text("utf-8"),)


def reproduction(context: ReportContext) -> dict[str, Any]:
    """Return versions, digests and the study itself; after a search also the best placement."""
    files = {("The study", "study"): context.start}
    if context.was_searched:
        files = {
            ("The study as given", "study"): context.start,
            ("The study with the best placement", "found"): context.study,
        }
    return {
        "versions": {
            "perception-entropy": pe.__version__,
            "Python, NumPy": f"{platform.python_version()}, {np.__version__}",
            **context.versions,
        },
        "samples_text": advice.objects_looked_at,
        "study_digest": jobs.fingerprint(context.start),
        "files": [(*names, jobs.study_text(study)) for names, study in files.items()],
    }
