"""The section of the page on detectors before and after a search, from saved results alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...wording import joined, table
from ..analysis import HOLDS, OPEN, REFUTED
from ..study_page import trainings_text
from .plan import START, TITLES, AfterSearchPlan
from .searches import FOLDER, PLACEMENTS

Json = dict[str, Any]

TITLE = "## After a search: does the optimum find more?"
WORDS = {"entropy": "perception entropy", "expected_ap": "expected AP in traffic"}
VERDICTS = {HOLDS: "finds more", REFUTED: "finds no more", OPEN: "open"}


def after_search_section(plan: AfterSearchPlan, found: Json, runs: Mapping[str, Json]) -> str:
    """Return the section of the page.

    Parameters
    ----------
    plan : AfterSearchPlan
    found : mapping
        The analysis.
    runs : mapping
        Results by the name of the run.
    """
    missing = found["done"] < found["planned"]
    told = f"\n{trainings_text(runs)}\n" if runs else ""
    return f"""
{TITLE}

By a plan of its own: [before and after a search](after_search.md). Detectors at the start of two searches and at what
they found ([placements]({FOLDER}/{PLACEMENTS})); LiDARs alone. {found["done"]} of {found["planned"]} runs are
done{"; figures so far" if missing and runs else ""}. **{answer(found)}**

{_placements(plan, found)}

*AP: mean of the five classes and of the seeds, from the lowest to the highest seed. Perception entropy: lower is
better.*

{_comparisons(plan, found)}

*After minus before, of the same seed; Student's interval over the seeds, 95 %.*

{_by_ring(plan, found)}
{told}"""


def answer(found: Json) -> str:
    """Return in a sentence for each objective whether its optimum finds more than the start."""
    if set(found["answers"].values()) == {OPEN}:
        return "Whether a detector finds more with the optimum of either search than with the start is open."
    return " ".join(
        _answer(objective, verdict, found) for objective, verdict in found["answers"].items()
    )


def _answer(objective: str, verdict: str, found: Json) -> str:
    after = f"after a search by {WORDS[objective]}"
    if verdict == OPEN:
        return f"Whether a detector finds more {after} than at the start is open."
    shown, others = (
        [
            TITLES[name]
            for name, rig in found["rigs"].items()
            if (rig["after"][objective]["verdict"] == HOLDS) == wanted
        ]
        for wanted in (True, False)
    )
    if not shown:
        return f"It was not shown that a detector finds more {after} than at the start."
    where = f"{len(shown)} of {len(shown) + len(others)} rigs"
    names = f"shown: {joined(shown)}; not shown: {joined(others)}" if others else joined(shown)
    return f"A{after[1:]} a detector finds more than at the start on {where} ({names})."


def _placements(plan: AfterSearchPlan, found: Json) -> str:
    lines = [
        [
            TITLES[rig.name],
            START if what == START else WORDS[what],
            _number(row["entropy"], 3),
            _number(row["expected_ap"], 3),
            _aps(row["ap"]),
        ]
        for rig in plan.rigs
        for what, row in found["rigs"][rig.name]["placements"].items()
    ]
    titles = ["rig", "placement", "perception entropy", "expected AP in traffic", "AP"]
    return table(titles, lines)


def _comparisons(plan: AfterSearchPlan, found: Json) -> str:
    lines = [
        [TITLES[rig.name], WORDS[objective], _difference(row), VERDICTS[row["verdict"]]]
        for rig in plan.rigs
        for objective, row in found["rigs"][rig.name]["after"].items()
    ]
    return table(["rig", "search by", "difference of AP (95 %)", "the optimum"], lines)


def rings_found(found: Mapping[str, Any]) -> list[Json]:
    """Return by rig and ring how much more is found after the one search than after the other."""
    return [rig["by_ring"] for rig in found["rigs"].values() if "by_ring" in rig]


def _by_ring(plan: AfterSearchPlan, found: Json) -> str:
    """Return the differences between the searches by ring, which no plan asked for."""
    rows = rings_found(found)
    if not rows:
        return ""
    first, last = (WORDS[plan.objectives[k]] for k in (0, -1))
    rings = list(plan.study.precision.rings)
    lines = [
        [TITLES[rig.name], *(_difference(row[ring]) for ring in rings)]
        for rig, row in zip(plan.rigs, rows, strict=True)
    ]
    return (
        f"Looked for afterwards, by distance: AP after the search by {last} minus AP after that by {first}.\n\n"
        f"{table(['rig', *rings], lines)}"
    )


def _difference(row: Json) -> str:
    if row["mean"] is None:
        return "-"
    if row["interval"] is None:
        return f"{row['mean']:+.3f}"
    low, high = row["interval"]
    return f"{row['mean']:+.3f} ({low:+.3f} to {high:+.3f})"


def _aps(values: list[float | None]) -> str:
    done = [v for v in values if v is not None]
    if not done:
        return "-"
    spread = f" ({min(done):.3f} to {max(done):.3f})" if len(done) > 1 else ""
    return f"{sum(done) / len(done):.3f}{spread}"


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
