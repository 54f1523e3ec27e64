"""What our own study says: answers in sentences, and tables for the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..pages import joined, p_text, range_text, rho_text
from ..ranks import min_significant_rho
from ..results_file import Json
from .after_search.plan import START, TITLES, AfterSearchPlan
from .analysis import FRESH, HOLDS, OPEN, REFUTED, UNDECIDED, step_title
from .cameras.analysis import is_too_noisy
from .cameras.plan import CameraPlan
from .plan import ACROSS, FIXED, MIXED, StudyPlan
from .scan_curves import A_BOUNDS
from .scores import BEAMS, COVERAGE, PRIMARY

DESIGNS = {
    FIXED: "one rig: two LiDARs of 16 channels, a detector a placement",
    ACROSS: "across hardware: one, two or four LiDARs, a detector a placement",
    MIXED: "one detector for many placements",
    FRESH: "the same at placements that it never met",
}
WORDS = {START: START, "entropy": "perception entropy", "expected_ap": "expected AP in traffic"}
NO_RUNS = "Whether detectors find more at a better score is open: not all runs are done."

# The answer in short.


def short_answer(
    plan: StudyPlan, found: Json, searched: Mapping[str, Any], cameras: Mapping[str, Any]
) -> str:
    """Return what the study says in a few sentences; README and other pages have them, too.

    `found` is the analysis with what was looked for afterwards; `searched` and `cameras` are those
    of the runs before and after a search, and of those with cameras.
    """
    after, verdict = found["afterwards"], found["statements"][0]["verdict"]
    if verdict == OPEN or not after:
        return NO_RUNS
    unseen = ["real roads"] + ["cameras"] * (cameras["verdict"] != HOLDS)
    pairs = after["fewer_beams"]
    is_blind = pairs["wrong"][PRIMARY] and pairs["blind"]
    sentences = [
        _within_a_rig(found, verdict == HOLDS),
        "Entropy can prefer a rig with a blind sector." if is_blind else "",
        _near_and_far(plan, searched),
        f"{joined(unseen).capitalize()} are not shown.",
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def _within_a_rig(found: Json, holds: bool) -> str:
    all_round, whole = found["afterwards"]["all_round"], found["designs"][FIXED]
    rhos = [part["scores"][PRIMARY]["rho"] for part in (whole, all_round)]
    if not holds:
        return "Within one rig, detectors were not shown to find more at a better score."
    text = (
        "In our simulated LiDAR scans, within one rig, detectors find more at a better score: rho "
        f"{rhos[0]:.2f} over {whole['placements']} placements, {rhos[1]:.2f} over the "
        f"{all_round['placements']} that see all round."
    )
    as_well = whole["scores"][COVERAGE]["rho"] >= rhos[0]
    return f"{text} Coverage does as well." if as_well else text


def _near_and_far(plan: StudyPlan, searched: Mapping[str, Any]) -> str:
    """Return which search finds more near and far, where all rigs agree; else nothing."""
    rings = list(plan.precision.rings.items())
    found = [rig["by_ring"] for rig in searched["rigs"].values() if "by_ring" in rig]
    near, far = ([r[ring] for r in found] for ring in (rings[0][0], rings[-1][0]))
    is_so = near and all(row["interval"][1] < 0.0 for row in near)
    if not (is_so and all(row["interval"][0] > 0.0 for row in far)):
        return ""
    return (
        f"After searches, expected AP in traffic found more beyond {rings[-1][1][0]:g} m, entropy "
        f"within {rings[0][1][1]:g}."
    )


def answer_after_search(found: Json) -> str:
    """Return in a sentence for each objective whether its optimum finds more than the start."""
    return " ".join(_after(objective, found) for objective in found["answers"])


def _after(objective: str, found: Json) -> str:
    verdicts = {
        TITLES[name]: rig["after"][objective]["verdict"] for name, rig in found["rigs"].items()
    }
    by = f"a search by {WORDS[objective]}"
    if OPEN in verdicts.values():
        return f"Whether a detector finds more after {by} than at the start is open."
    shown = [title for title, verdict in verdicts.items() if verdict == HOLDS]
    if not shown:
        return f"It was not shown that a detector finds more after {by} than at the start."
    others = [title for title in verdicts if title not in shown]
    names = f"shown: {joined(shown)}; not shown: {joined(others)}" if others else joined(shown)
    where = f"{len(shown)} of {len(verdicts)} rigs ({names})"
    return f"After {by} a detector finds more than at the start on {where}."


def answer_of_cameras(plan: CameraPlan, found: Json) -> str:
    """Return what the study of cameras says about the primary score."""
    verdict, score = found["verdict"], plan.study.statistics.primary
    if verdict == UNDECIDED:
        return f"It says nothing about {score}: {_why_nothing(plan, found)}."
    if verdict == OPEN and found["done"] == found["planned"]:
        return "There are too few placements for a statement."
    return {
        OPEN: "There is no statement before all runs are done.",
        HOLDS: f"The better-scored placement finds more ({score}).",
        REFUTED: f"The better-scored placement finds less ({score}).",
    }[verdict]


def _why_nothing(plan: CameraPlan, found: Json) -> str:
    if is_too_noisy(plan, found):
        return (
            f"the two seeds of a placement agree too little (rho {rho_text(found['seed_rho'])}, "
            f"wanted {plan.min_seed_rho:g}) or too little is found (mean AP "
            f"{found['mean_ap']:.3f}, wanted {plan.min_ap:g})"
        )
    smallest = min_significant_rho(found["placements"])
    limit = "" if smallest is None else f", and only rho from {smallest:.2f} on would be one"
    return f"over {found['placements']} placements its correlation is not significant{limit}"


def answer_of_curves(classes: Mapping[str, Json]) -> str:
    """Return for which classes the curves are better than the shipped ones, and than none."""
    judged = {name: row["rmse"]["judged"] for name, row in classes.items()}
    before = [n for n, (shipped, own) in judged.items() if own < shipped]
    by_mean = [n for n, row in classes.items() if judged[n][1] < row["rmse"]["judged_by_mean"]]
    flat = [n for n, row in classes.items() if row["a_interval"][0] <= A_BOUNDS[0]]

    def of(names: Sequence[str]) -> str:
        return "all classes" if len(names) == len(classes) else joined([f"{n}s" for n in names])

    text = (
        f"There, their error is below that of the shipped curves for {of(before)}, and below that "
        f"of the mean AP of the odd placements for {of(by_mean)}."
    )
    if not flat:
        return text
    return (
        f"{text} The interval of a reaches the bound of the fit, {A_BOUNDS[0]:g}, for {of(flat)}: "
        "there the curve says little more than whether a beam meets it."
    )


# Tables.


def with_interval(figures: Mapping[str, Any] | None, key: str = "rho") -> str:
    """Return a rank correlation, or a share, and its interval; a dash where there is none."""
    if not figures:
        return "-"
    texts = [
        rho_text(v) if key == "rho" else "-" if v is None else f"{v:.2f}"
        for v in (figures[key], *figures["interval"])
    ]
    return f"{texts[0]} ({texts[1]} to {texts[2]})"


def statements(found: Json) -> list[list[str]]:
    """Return the lines of the table of the plan's statements."""
    lines = []
    for row in found["statements"]:
        figures, changed = row["figures"], row["sign_changes"]
        key = "share" if "share" in figures else "rho"
        text = f"{key} {with_interval(figures, key)}" if figures else "-"
        text += f", p {p_text(figures['p'])}" if "p" in figures else ""
        marks = f"; sign changes: {joined(changed)}" if changed else ""
        lines.append([row["statement"], text, row["verdict"] + marks])
    return lines


def marked(name: str) -> str:
    """Return the name of a score, bold for the primary one."""
    return f"**{name}**" if name == PRIMARY else name


def states(found: Json) -> list[list[str]]:
    """Return the lines of the table of designs: what is done, and how AP and its noise are."""
    lines = []
    for name, text in DESIGNS.items():
        design = found["designs"][name]
        ap = " / ".join(f"{v:.3f}" for v in design["ap"]) if design["scores"] else "-"
        noise = f"{design['noise']:.4f}" if design.get("noise") is not None else "-"
        counts = [f"{design['done']} of {design['planned']}", str(design["placements"])]
        lines.append([text, *counts, str(design.get("seeds", "-")), ap, noise])
    return lines


def designs(found: Json, alpha: float) -> list[list[str]]:
    """Return the lines of the table of correlations: every score in every design."""
    tables = {name: found["designs"][name]["scores"] for name in DESIGNS}
    names = dict.fromkeys(score for rows in tables.values() for score in rows)

    def rho(rows: Json, score: str) -> str:
        row = rows.get(score)
        if row is None:
            return "-"
        weak = row.get("holm", row["p"]) >= alpha
        return with_interval(row) + (" n.s." if weak else "")

    return [
        [
            marked(score),
            rho(tables[FIXED], score),
            with_interval(tables[FIXED].get(score, {}).get("given_height")),
            *(rho(tables[name], score) for name in (ACROSS, MIXED, FRESH)),
        ]
        for score in names
    ]


def pairs(found: Json) -> str:
    """Return the share of pairs of other hardware that each score orders rightly."""
    rows = found["pairs"]["scores"].items()
    return "; ".join(f"{name} {with_interval(row, 'share')}" for name, row in rows)


def steps(found: Json) -> list[list[str]]:
    """Return the lines of the table of steps towards reality."""
    lines = []
    for step in found["steps"]:
        row, state = step["scores"].get(PRIMARY), f"{step['done']} of {step['planned']}"
        cells = ["-"] * 4
        if row:
            figures = step["order"], row, row["plain"]
            cells = [str(step["placements"]), *map(with_interval, figures)]
        lines.append([step_title(step), state, *cells])
    return lines


def steps_above(found: Json) -> str:
    """Return in a sentence how the primary score does in all steps that have figures."""
    rows = [step["scores"][PRIMARY] for step in found["steps"] if step["scores"]]
    above = sum((row["rho"] or 0.0) > 0.0 for row in rows)
    whole = sum((row["interval"][0] or 0.0) > 0.0 for row in rows)
    return f"rho is above 0 in {above} of {len(rows)} steps, its whole interval in {whole}"


def rings(found: Json) -> list[list[str]]:
    """Return the lines of the table of rings."""
    return [
        [ring, *map(with_interval, part["scores"].values()), with_interval(part["beyond_coverage"])]
        for ring, part in found["afterwards"]["rings"].items()
    ]


def curves(found: Json) -> list[list[str]]:
    """Return the lines of the table of AP curves from scans."""

    def limits(interval: Sequence[float]) -> str:
        return "{:.3f} to {:.3f}".format(*interval)

    return [
        [
            name,
            *(f"{row[key]:.3f} ({limits(row[f'{key}_interval'])})" for key in ("a", "b")),
            "{:.3f}, **{:.3f}**".format(*row["rmse"]["judged"])
            + f" ({limits(row['rmse_interval'])})",
            f"{row['rmse']['judged_by_mean']:.3f}",
        ]
        for name, row in found["ap_curves"]["classes"].items()
    ]


def searches(plan: AfterSearchPlan, found: Json) -> list[list[str]]:
    """Return the lines of the table of placements before and after a search."""
    lines = []
    for rig in plan.rigs:
        of_rig = found["rigs"][rig.name]
        for what, row in of_rig["placements"].items():
            scores = [
                "-" if row[k] is None else f"{row[k]:.3f}" for k in ("entropy", "expected_ap")
            ]
            done = [v for v in row["ap"] if v is not None]
            ap = f"{sum(done) / len(done):.3f}" if done else "-"
            more = difference(of_rig["after"].get(what))
            lines.append([TITLES[rig.name], WORDS[what], *scores, ap, more])
    return lines


def searches_by_ring(found: Json) -> list[list[str]]:
    """Return the lines of the differences between the searches by ring; empty until all is done."""
    rigs = {TITLES[name]: rig.get("by_ring") for name, rig in found["rigs"].items()}
    return [[title, *map(difference, row.values())] for title, row in rigs.items() if row]


def difference(row: Json | None) -> str:
    """Return a difference of AP and its interval."""
    if row is None or row["mean"] is None:
        return "-"
    limits = " ({:+.3f} to {:+.3f})".format(*row["interval"]) if row["interval"] else ""
    return f"{row['mean']:+.3f}{limits}"


def cameras(found: Json) -> list[list[str]]:
    """Return the lines of the table of the study of cameras."""
    return [
        [
            score,
            with_interval(row),
            p_text(row["p"]),
            p_text(row.get("holm")),
            rho_text(found["all_round"].get(score)),
        ]
        for score, row in found["scores"].items()
    ]


def trainings(runs: Mapping[str, Json]) -> str:
    """Return how the trainings of some runs went, and what they took, in words."""
    epochs = range_text([run["training"]["epochs"] for run in runs.values()], 0)
    unfinished = sum(not run["training"]["converged"] for run in runs.values())
    middle = sorted(run["seconds"] for run in runs.values())[len(runs) // 2] / 60.0
    hours = sum(run["seconds"] for run in runs.values()) / 3600.0
    commits = sorted({run["made"]["commit"] for run in runs.values()})
    return (
        f"{epochs} epochs; {unfinished} of {len(runs)} runs had not converged at the last epoch "
        f"that the plan allows. {middle:.1f} minutes of one processor a run (median), {hours:.1f} "
        f"hours in all. Commit: {joined(commits)}."
    )


def plot_name(design: str) -> str:
    """Return the file name of a design's plot."""
    return f"{design.replace(', ', '_')}.png"


def wrong_pairs(found: Json) -> str:
    """Return how many of the pairs in which fewer beams find more each score orders wrongly."""
    wrong = found["afterwards"]["fewer_beams"]["wrong"]
    return joined([f"{name} {count}" for name, count in wrong.items() if name != BEAMS])
