"""The page of our own study, from its saved results alone; all verdicts are computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..pages import render, rho_text, sentence
from ..ranks import min_significant_rho
from ..results_file import Json
from .afterwards import outside
from .analysis import FRESH, Results, is_too_noisy, step_title
from .plan import ACROSS, FIXED, MIXED, OWN, Plan, rings_of
from .scan_curves import A_BOUNDS
from .scores import PRIMARY

TITLE = "# Does a better score find more? Our own study"
PAGE, ANSWERS = (Path(__file__).with_name(f"{name}.md.j2") for name in ("page", "answers"))
DESIGNS = {
    FIXED: "one rig: two LiDARs of 16 channels, a detector a placement",
    ACROSS: "across hardware: one, two or four LiDARs, a detector a placement",
    MIXED: "one detector for many placements",
    FRESH: "the same at placements that it never met",
}


@dataclass(frozen=True)
class Study:
    """The studies of LiDARs, of cameras and before and after a search.

    Plans, what follows from their runs, and the results of these, by folder.
    """

    plans: Mapping[str, Plan]
    found: Mapping[str, Json]
    runs: Mapping[str, Results]


def short_answer(plan: Plan, found: Json, searched: Json, cameras: Json) -> str:
    """Return what the study says in a few sentences; README and other pages have them, too.

    `found` is the analysis with what was looked for afterwards; `searched` and `cameras` are those
    of the runs before and after a search, and of those with cameras.
    """
    return sentence(ANSWERS, "short_answer", rings_of(plan), found, searched, cameras)


def answer_after_search(found: Json) -> str:
    """Return in a sentence for each objective whether its optimum finds more than the start."""
    return sentence(ANSWERS, "after_search", found)


def answer_of_cameras(plan: Plan, found: Json) -> str:
    """Return what the study of cameras says about the primary score."""
    return sentence(ANSWERS, "of_cameras", plan.statistics, found, *_why_nothing(plan, found))


def _why_nothing(plan: Plan, found: Json) -> tuple[bool, float | None]:
    """Return whether cameras find too little for a statement, and the least rho for one."""
    least = min_significant_rho(found["placements"]) if found["scores"] else None
    return bool(found["scores"]) and is_too_noisy(plan, found), least


def page(study: Study, scores_outside: Mapping[str, Json]) -> str:
    """Return the page as Markdown; `scores_outside` are those of Place3D's placements."""
    plan = study.plans[OWN]
    found = study.found[OWN]
    cameras = study.found["cameras"]
    rule = plan.statistics
    camera_plan = study.plans["cameras"]
    too_noisy, least_rho = _why_nothing(camera_plan, cameras)
    values = {
        "found": found,
        "quick": plan.digest.startswith("quick"),
        "alpha": rule.alpha,
        "tie": rule.tie_ap,
        "primary": PRIMARY,
        "designs": DESIGNS,
        "scores_of_all": dict.fromkeys(s for n in DESIGNS for s in found["designs"][n]["scores"]),
        "plot_name": plot_name,
        "step_title": step_title,
        "rings": rings_of(plan),
        "least_a": A_BOUNDS[0],
        "searched": study.found["after_search"],
        "cameras": cameras,
        "camera_plan": camera_plan,
        "too_noisy": too_noisy,
        "least_rho": least_rho,
        "runs": study.runs,
        "outside": outside(scores_outside, rule, plan.seed) if scores_outside else {},
    }
    return render(PAGE, values, interval_of=with_interval)


def with_interval(figures: Mapping[str, Any] | None, key: str = "rho") -> str:
    """Return a rank correlation, or a share, and its interval; a dash where there is none."""
    if not figures:
        return "-"
    texts = [
        rho_text(v) if key == "rho" else "-" if v is None else f"{v:.2f}"
        for v in (figures[key], *figures["interval"])
    ]
    return f"{texts[0]} ({texts[1]} to {texts[2]})"


def plot_name(design: str) -> str:
    """Return the file name of a design's plot."""
    return f"{design.replace(', ', '_')}.png"
