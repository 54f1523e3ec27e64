"""The page of our own study, from its saved results alone; all verdicts are computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..pages import render
from ..results_file import Json
from . import findings, segmentation
from .after_search.plan import START, AfterSearchPlan
from .analysis import Results
from .cameras.plan import CameraPlan
from .plan import AFTER_SEARCH, CAMERAS, StudyPlan
from .scores import PRIMARY

OWN = "."
"""The folder of the study of LiDARs, from that of all."""
TITLE = "# Does a better score find more? Our own study"


@dataclass(frozen=True)
class Plans:
    """The plans of the studies of LiDARs, of cameras, and before and after a search."""

    own: StudyPlan
    cameras: CameraPlan
    searches: AfterSearchPlan


@dataclass(frozen=True)
class Study:
    """The three studies: plans, what follows from their runs, and these results by folder."""

    plans: Plans
    found: Json
    of_cameras: Json
    searched: Json
    runs: Mapping[str, Results]

    def trainings(self, name: str) -> str:
        """Return how the trainings of a study went; empty where none is done."""
        return findings.trainings(self.runs[name]) if self.runs[name] else ""


def page(study: Study, outside: Mapping[str, Json]) -> str:
    """Return the page as Markdown; `outside` has the scores of Place3D's placements."""
    plan, found = study.plans.own, study.found
    values = {
        "t": findings,
        "found": found,
        "quick": plan.digest.startswith("quick"),
        "alpha": plan.statistics.alpha,
        "tie": plan.statistics.tie_ap,
        "primary": PRIMARY,
        "trainings": study.trainings(OWN),
        "searched": _searched(study),
        "camera": _cameras(study),
        "outside": segmentation.tables(outside, plan.statistics, plan.seed) if outside else {},
    }
    return render(Path(__file__).parent, values, interval_of=findings.with_interval)


def _searched(study: Study) -> Json:
    found = study.searched
    after = [rig["placements"] for rig in found["rigs"].values()]
    placed = any(
        row["entropy"] is not None for rig in after for what, row in rig.items() if what != START
    )
    return {
        "placed": placed,
        "done": found["done"],
        "planned": found["planned"],
        "answer": findings.answer_after_search(found),
        "lines": findings.searches(study.plans.searches, found),
        "by_ring": findings.searches_by_ring(found),
        "rings": list(study.plans.own.precision.rings),
        "trainings": study.trainings(AFTER_SEARCH),
    }


def _cameras(study: Study) -> Json:
    plan, found = study.plans.cameras, study.of_cameras
    return {
        "plan": plan,
        "count": sum(plan.count.values()),
        "found": found,
        "answer": findings.answer_of_cameras(plan, found),
        "lines": findings.cameras(found),
        "trainings": study.trainings(CAMERAS),
    }
