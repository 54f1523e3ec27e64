"""The page of our own study, from its saved results alone; verdicts are computed, none is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..published.findings import p_text, rho_text
from ..wording import joined, range_text, table, wrapped
from .analysis import FRESH, HOLDS, OPEN, REFUTED, UNDECIDED, step_title
from .plan import ACROSS, FIXED, MIXED, StudyPlan
from .scores import PRIMARY

Json = dict[str, Any]

TITLE = "# Does a better score find more? Our own study"
DESIGNS = {
    FIXED: "One rig: two LiDARs of 16 channels, a detector a placement",
    ACROSS: "Across hardware: one, two or four LiDARs, a detector a placement",
    MIXED: "One detector for many placements",
    FRESH: "The same detector at placements that it never met",
}
SO_FAR = "so far"


def page(plan: StudyPlan, results: Json, runs: Mapping[str, Json], *more: str) -> str:
    """Return the page as Markdown.

    Parameters
    ----------
    plan : StudyPlan
    results : mapping
        The analysis.
    runs : mapping
        Results by the name of the run.
    *more : str
        The sections on AP curves, searches, cameras and results of others.
    """
    sections = [
        _head(plan, results),
        _statements(results),
        *(_design(name, results["designs"][name]) for name in DESIGNS),
        _pairs(plan, results["pairs"]),
        _steps(results["steps"]),
        *more,
        _runs(runs),
        _again(),
    ]
    return wrapped(section for section in sections if section)


def _head(plan: StudyPlan, results: Json) -> str:
    done, planned = results["runs"]["done"], results["runs"]["planned"]
    quick = (
        "These are the results of `--quick`: they show that everything runs, and nothing else.\n\n"
        if plan.digest.startswith("quick")
        else ""
    )
    return f"""
{TITLE}

{quick}**What is unreal.** Still scenes without motion, rain or intensity; objects at positions that do not depend
on each other; shapes of a few solids; a small detector, trained with hundreds of scenes, that is asked for centres and
not for sizes. In the plain world the ground is flat and there are no houses, which favours height. Absolute AP is
no prediction for a product.

**The answer.** {results["answer"]} {_by_the_plan(results)}

{done} of {planned} runs are done. The study was fixed before the first of them: [plan](plan.md). `python -m studies.detectors
--resume` does the next ones and writes this page; every figure is computed from the files in the folder `runs`.
"""


def _by_the_plan(results: Json) -> str:
    """Return the verdicts of the plan in three sentences; open until the runs are done."""
    verdicts = [row["verdict"] for row in results["statements"]]
    return f"By the plan: {_within(verdicts[0])} {_good(verdicts[2:4])} {_across(verdicts[4:])}{_beams(results)}"


def _beams(results: Json) -> str:
    """Return that the number of beams does as well, unless more was shown; or nothing."""
    gain = results["afterwards"].get("minus_beams")
    if not gain or gain["interval"][0] > 0.0:
        return ""
    return " That it orders other hardware better than the number of beams does was not shown."


def _within(verdict: str) -> str:
    return {
        HOLDS: "within one rig, placements with a lower perception entropy find more.",
        REFUTED: "within one rig, perception entropy does not say which placement finds more.",
        OPEN: "whether placements of one rig with a lower perception entropy find more is open: "
        "not all runs of this design are done.",
    }[verdict]


def _good(verdicts: Sequence[str]) -> str:
    if OPEN in verdicts:
        return "Whether it still does among good placements, and beyond height, is open, too."
    shown = {HOLDS: "still holds", REFUTED: "does not hold", UNDECIDED: "is not decided"}[
        verdicts[0]
    ]
    says = "says" if verdicts[1] == HOLDS else "was not shown to say"
    return (
        f"Among the better half of the placements this {shown}; entropy {says} more than the "
        "height of the LiDARs."
    )


def _across(verdicts: Sequence[str]) -> str:
    if OPEN in verdicts:
        return "Whether it may be compared across hardware is open."
    first = {
        HOLDS: "Across hardware it may be compared",
        REFUTED: "Across hardware it misleads",
        UNDECIDED: "Whether it may be compared across hardware is not decided",
    }[verdicts[0]]
    second = {
        HOLDS: "expected AP in traffic is better there",
        REFUTED: "expected AP in traffic is worse there",
        UNDECIDED: "no difference from expected AP in traffic was shown",
    }[verdicts[1]]
    return f"{first}; {second}."


def _statements(results: Json) -> str:
    lines = [
        [row["statement"], _figures(row["figures"]), _verdict(row)] for row in results["statements"]
    ]
    return f"""
## The statements of the plan

The plan says when each holds and when it is refuted. *Open*: runs are missing, and figures are those so far.

{table(["statement", "figures", "verdict"], lines)}

Statements 3 and 4 have another rule than in the plan since the results are known: an interval that contains 0
refutes neither of them any more. It changes the verdict of statement 3 ([why](#looked-for-afterwards)).
"""


def _verdict(row: Json) -> str:
    """Return the verdict of a statement, marked where a step changes the sign of its rho."""
    changed = row["sign_changes"]
    return row["verdict"] + (f"; sign changes: {joined(changed)}" if changed else "")


def _figures(figures: Json) -> str:
    if not figures:
        return "-"
    is_share = "share" in figures
    value = figures["share"] if is_share else figures["rho"]
    text = (
        f"{'share' if is_share else 'rho'} {_value(value, is_share)} {_interval(figures, is_share)}"
    )
    return f"{text}, p {p_text(figures['p'])}" if "p" in figures else text


def _value(value: float | None, is_share: bool = False) -> str:
    if is_share:
        return "-" if value is None else f"{value:.2f}"
    return rho_text(value)


def rho_with_interval(figures: Json) -> str:
    """Return a rank correlation and its interval."""
    return f"{rho_text(figures['rho'])} {_interval(figures)}"


def _interval(figures: Json | None, is_share: bool = False) -> str:
    if not figures:
        return "-"
    low, high = figures["interval"]
    return f"({_value(low, is_share)} to {_value(high, is_share)})"


def _design(name: str, found: Json) -> str:
    state = f"{found['done']} of {found['planned']} runs, {found['placements']} placements"
    head = f"## {DESIGNS[name]}\n\n"
    if not found["scores"]:
        return f"{head}{state}: too few for figures."
    done = found["done"] == found["planned"]
    lowest, middle, highest = found["ap"]
    noise = found["noise"]
    of_noise = "" if noise is None else f" The standard deviation over the seeds is {noise:.4f}."
    lines = [_line(score, row) for score, row in found["scores"].items()]
    titles = [
        "score",
        "rho (95 %)",
        "p",
        "p after Holm",
        "given height",
        "height given it",
        "better half",
    ]
    return f"""
{head}{state}{"" if done else f"; figures {SO_FAR}"}. AP from {lowest:.3f} by {middle:.3f} (median) to {highest:.3f}, seeds
averaged: {found["seeds"]}.{of_noise}

{table(titles, lines)}

![AP against scores]({plot_name(name)})

*A dot is a placement; a bar reaches from its lowest to its highest seed.*

![Pairs ordered rightly by their difference]({pairs_plot_name(name)})

*Pairs of placements on one vehicle: the share that a score orders as AP does.*
"""


def _line(score: str, row: Json) -> list[str]:
    given, height, half = (row.get(k) for k in ("given_height", "height_given", "better_half"))
    holm = row.get("holm")
    return [
        f"**{score}**" if score == PRIMARY else score,
        rho_with_interval(row),
        p_text(row["p"]),
        "-" if holm is None else p_text(holm),
        *(rho_with_interval(part) if part else "-" for part in (given, height, half)),
    ]


def plot_name(design: str) -> str:
    """Return the file name of a design's plot."""
    return f"{design.replace(', ', '_')}.png"


def pairs_plot_name(design: str) -> str:
    """Return the file name of the plot of a design's pairs."""
    return f"pairs_{plot_name(design)}"


def _pairs(plan: StudyPlan, pairs: Json) -> str:
    head = "## Pairs of placements with different hardware\n\n"
    state = f"{pairs['done']} of {pairs['planned']} runs"
    if not pairs["scores"]:
        return f"{head}{state}: too few for figures."
    lines = [
        [score, f"{_value(row['share'], True)} {_interval(row, True)}"]
        for score, row in pairs["scores"].items()
    ]
    so_far = "" if pairs["done"] == pairs["planned"] else f"; figures {SO_FAR}"
    return f"""
{head}{state}{so_far}. Pairs on one vehicle that differ in AP by at least {plan.statistics.tie_ap:g}: the
share that a score orders rightly. Chance: 0.50.

{table(["score", "share (95 %)"], lines)}
"""


def _steps(steps: Sequence[Json]) -> str:
    if not steps:
        return ""
    parts = [_step(step) for step in steps]
    between = "\n\n" if any(step["scores"] for step in steps) else "\n"
    return f"## Steps towards reality\n\n{_of_steps(steps)}{between.join(parts)}"


def _of_steps(steps: Sequence[Json]) -> str:
    """Return in a sentence how the primary score does in all steps that have figures."""
    rows = [step["scores"][PRIMARY] for step in steps if step["scores"]]
    if not rows:
        return ""
    above, whole = (
        sum((value or 0.0) > 0.0 for value in values)
        for values in ([row["rho"] for row in rows], [row["interval"][0] for row in rows])
    )
    return (
        f"*{PRIMARY}*: rho is above 0 in {above} of {len(rows)} steps "
        f"({joined([rho_text(row['rho']) for row in rows])}), its whole interval in {whole}. The steps decide no "
        "statement; their placements are few.\n\n"
    )


def _step(step: Json) -> str:
    title, state = step_title(step), f"{step['done']} of {step['planned']} runs"
    if not step["scores"]:
        return f"- {title}: {state}."
    lines = [
        [
            f"**{score}**" if score == PRIMARY else score,
            *(rho_with_interval(part) for part in (row, row["plain"])),
        ]
        for score, row in step["scores"].items()
    ]
    titles = ["score", "rho (95 %)", "plain world, grid detector"]
    done = step["done"] == step["planned"]
    order = step["order"]
    return f"""\
### {title[0].upper()}{title[1:]}

{state}{"" if done else f"; figures {SO_FAR}"}, {step["placements"]} placements, seeds averaged: {step["seeds"]}. Rho of the
AP here and the AP of the same placements in the plain world with the grid detector: {rho_with_interval(order)}.

{table(titles, lines)}"""


def _runs(runs: Mapping[str, Json]) -> str:
    if not runs:
        return ""
    hours = sum(run["seconds"] for run in runs.values()) / 3600.0
    libraries = sorted({f"TensorFlow {run['made']['tensorflow']}" for run in runs.values()})
    return f"""
## The runs

{trainings_text(runs)} {hours:.1f} processor hours in all; {joined(libraries)}.
"""


def trainings_text(runs: Mapping[str, Json]) -> str:
    """Return how the trainings of some runs went, and what they took, in words."""
    epochs = range_text([run["training"]["epochs"] for run in runs.values()], 0)
    unfinished = sum(not run["training"]["converged"] for run in runs.values())
    middle = sorted(run["seconds"] for run in runs.values())[len(runs) // 2] / 60.0
    commits = sorted({run["made"]["commit"] for run in runs.values()})
    return (
        f"{epochs} epochs; {unfinished} of {len(runs)} runs had not converged at the last epoch that "
        f"the plan allows. {middle:.1f} minutes of one processor a run (median). Commit: {joined(commits)}."
    )


def _again() -> str:
    return """
## Again

`pip install -e '.[studies]'`, then `python -m studies.detectors --output FOLDER`: all runs, in the order of the
plan. Delete the file of a run, and `--resume` does it again. `--runs N` does the next N; `--page-only` writes
the page; `--quick` shows with three placements that everything runs. `--cameras` does the runs of cameras
instead, `--after-search` those before and after a search.
"""
