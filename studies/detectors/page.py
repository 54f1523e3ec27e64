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
from .plan import StudyPlan
from .scores import PRIMARY

TITLE = "# Does a better score find more? Our own study"


@dataclass(frozen=True)
class Study:
    """The three studies: plans, what follows from their runs, and the results of these."""

    plan: StudyPlan
    cameras: CameraPlan
    searches: AfterSearchPlan
    found: Json
    of_cameras: Json
    searched: Json
    runs: Results
    camera_runs: Results
    after_runs: Results


def page(study: Study, outside: Mapping[str, Json]) -> str:
    """Return the page as Markdown; `outside` has the scores of Place3D's placements."""
    plan, found, rule = study.plan, study.found, study.plan.statistics
    replaced, groups = found["history"]["replaced"], found["history"]["groups"].values()
    values = {
        "t": findings,
        "found": found,
        "quick": plan.digest.startswith("quick"),
        "alpha": rule.alpha,
        "tie": rule.tie_ap,
        "primary": PRIMARY,
        "changes": [row["after"] - row["before"] for row in replaced.values()],
        "alone": [sum(g[key] for g in groups) for key in ("plan_alone", "runs")],
        "trainings": findings.trainings(study.runs) if study.runs else "",
        "searched": _searched(study),
        "camera": _cameras(study),
        "outside": segmentation.tables(outside, rule, plan.seed) if outside else {},
    }
    return render(Path(__file__).parent, values, interval_of=findings.with_interval)


def _searched(study: Study) -> Json:
    found, runs = study.searched, study.after_runs
    after = [rig["placements"] for rig in found["rigs"].values()]
    placed = any(
        row["entropy"] is not None for rig in after for what, row in rig.items() if what != START
    )
    return {
        "placed": placed,
        "done": found["done"],
        "planned": found["planned"],
        "answer": findings.answer_after_search(found),
        "lines": findings.searches(study.searches, found),
        "by_ring": findings.searches_by_ring(found),
        "rings": list(study.plan.precision.rings),
        "trainings": findings.trainings(runs) if runs else "",
    }


def _cameras(study: Study) -> Json:
    plan, found = study.cameras, study.of_cameras
    return {
        "plan": plan,
        "count": sum(plan.count.values()),
        "found": found,
        "answer": findings.answer_of_cameras(plan, found),
        "lines": findings.cameras(found),
        "trainings": findings.trainings(study.camera_runs) if study.camera_runs else "",
    }
