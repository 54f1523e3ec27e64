"""The findings on the page of ``python -m studies.published``: the test, the correlations, what they support."""

from __future__ import annotations

from ..wording import joined, table
from .correlations import (
    LAYOUTS,
    LEVEL,
    MAIN_CLASS,
    MIN_AGREEMENT,
    SIGNIFICANCE,
    Record,
    ValidityResults,
    common_classes,
    detectors_disagree,
)
from .published import CLEAN, Paper, papers
from .scores import variants


def over_both_papers(results: ValidityResults) -> str:
    """Return the test over both papers, a table for each treatment of doubtful placements."""
    first, second = papers()
    return f"""
## The test

For each score: Spearman's rho with the AP of {MAIN_CLASS}s in each paper (clean results, mean over the
detectors); the mean of the two; its exact two-sided p, which is the share of all permutations of the
placements, in each paper separately, that give a mean as far from zero; and p after Holm's correction for the
{len(results.main_tests)} scores compared. A rho above zero has the right sign. Bold: below {SIGNIFICANCE:.0%}.

{"".join(_test_table(results, treatment) for treatment in results.treatments)}
![Rank correlation of every score with both papers](over_papers.png)

*Dots: {first.short} and {second.short}, cars, with the fixed choices; bars: the range when the choices are
varied. Between the dashed lines, a single rho over eight placements is not significant.*
"""


def _test_table(results: ValidityResults, treatment: tuple[str, str]) -> str:
    titles = ["score", *(p.short for p in papers()), "mean", "p", "p after Holm"]
    lines = [_test_line(results, treatment, row) for row in results.tests_of(treatment)]
    return f"### {treatment_text(treatment)}\n\n{table(titles, lines)}\n\n"


def treatment_text(treatment: tuple[str, str]) -> str:
    """Return in words how the doubtful placements are treated."""
    reading, selection = treatment
    if selection == LEVEL:
        return "Without the rolled placements"
    if selection == LAYOUTS:
        return "The second paper's four LiDAR layouts, cameras averaged"
    return f"All placements, rolls in {reading}"


def _test_line(results: ValidityResults, treatment: tuple[str, str], row: Record) -> list[str]:
    p_holm = p_text(row["holm"])
    if row["holm"] < SIGNIFICANCE:
        p_holm = f"**{p_holm}**"
    rhos = [rho_text(value) for value in (*row["rho"], row["mean"])]
    name = f"test: {row['score']}, {', '.join(treatment)}"
    return [row["score"], *rhos, p_text(row["p"]), results.verdict(name, p_holm)]


def rho_text(value: float | None) -> str:
    """Return a rho as text; a dash where the score is the same for all placements."""
    return "-" if value is None else f"{round(value, 2) + 0.0:+.2f}"


def p_text(p: float) -> str:
    """Return a p value as text."""
    return f"{p:.3f}" if p >= 0.001 else "< 0.001"


def by_class(results: ValidityResults) -> str:
    """Return the correlations with clean results, a table for each class of each paper."""
    tables = (_class_table(results, paper, cls) for paper in papers() for cls in paper.classes)
    return f"""
## Every class and detector

{treatment_text(results.treatments[0])}; clean results. The last line of each table is an upper limit: how
similarly the detectors themselves rank the placements (mean rho of each detector with the mean ranks of the
others). Where it is below {MIN_AGREEMENT:g}, the detectors prefer different placements and no score can agree
with all of them; the table is *in italics* and its column in the plot is grey.

![Rank correlation by class](by_class.png)

{"".join(tables)}"""


def _class_table(results: ValidityResults, paper: Paper, cls: str) -> str:
    rows = results.correlations_of(paper, cls)
    detectors = list(rows[0]["by_detector"])
    lines = [_class_line(row, detectors) for row in rows]
    agreement = f"{rows[0]['agreement']:+.2f}"
    lines.append(["detectors with each other", *([""] * len(detectors)), agreement, ""])
    titles = ["score", *detectors, "mean", "p"]
    return f"### {paper.short}: {paper.classes[cls]}\n\n{table(titles, lines)}\n\n"


def _class_line(row: Record, detectors: list[str]) -> list[str]:
    rhos = [rho_text(row["by_detector"][name]) for name in detectors]
    p = "-" if row["p"] is None else p_text(row["p"])
    cells = [*rhos, rho_text(row["mean"]), p]
    if detectors_disagree(row):
        cells = [f"*{cell}*" for cell in cells]
    return [row["score"], *cells]


def ranges(results: ValidityResults) -> str:
    """Return the range of each score's correlation when the choices are varied."""
    choices = [choice.name for choice in variants(results.effort.all_variants) if choice.name]
    if not choices:
        return ""
    titles = ["score", *(f"{p.short}, lowest to highest" for p in papers())]
    lines = [
        [name, *(_range(results.correlation_of(p, MAIN_CLASS, name)) for p in papers())]
        for name in (row["score"] for row in results.main_tests)
    ]
    return f"""
## The choices, varied

One at a time: {"; ".join(choices)}. Mean rho with the AP of {MAIN_CLASS}s,
{treatment_text(results.treatments[0]).lower()}, over the fixed choices and all of these.

{table(titles, lines)}
"""


def _range(row: Record) -> str:
    return f"{rho_text(row['lowest'])} to {rho_text(row['highest'])}"


def by_condition(results: ValidityResults) -> str:
    """Return the correlations with results under corruptions of the point clouds."""
    tables = [_condition_table(results, paper) for paper in papers() if len(paper.ap) > 1]
    return f"""
## In bad weather

The first paper also has the AP of {MAIN_CLASS}s of detectors that were trained on clean point clouds and tested
on corrupted ones. Mean rho over the detectors, {treatment_text(results.treatments[0]).lower()}; *italics* where the
detectors do not agree among themselves. The scores do not model weather.

{"".join(tables)}"""


def _condition_table(results: ValidityResults, paper: Paper) -> str:
    conditions = [c for c in paper.ap if c != CLEAN]
    rows = {c: results.correlations_of(paper, MAIN_CLASS, c) for c in conditions}
    names = [row["score"] for row in rows[conditions[0]]]
    lines = [[n, *(_mean_cell(rows[c][k]) for c in conditions)] for k, n in enumerate(names)]
    agreements = [f"{rows[c][0]['agreement']:+.2f}" for c in conditions]
    lines.append(["detectors with each other", *agreements])
    titles = ["score", *(c.replace("_", " ") for c in conditions)]
    return f"{table(titles, lines)}\n\n"


def _mean_cell(row: Record) -> str:
    text = rho_text(row["mean"])
    return f"*{text}*" if detectors_disagree(row) else text


def conclusion(results: ValidityResults) -> str:
    """Return what the results support, and what they do not."""
    return f"""
## What this supports, and what it does not

{_significant(results)}
{_best_and_worst(results)}
{_height(results)}
{_disagreements(results)}
- **Not covered by these results**: placements far from a roof (all of these are within a metre of
each other on a roof rack), LiDARs with other channels, real roads, and differences of a few
centimetres. A score may be right or wrong about those.
- **How to use the scores until then**: as what they are, numbers of beams and pixels on
voxels or objects under a stated prior, together with the maps of what is not seen; not as a promise of AP.
"""


def _significant(results: ValidityResults) -> str:
    always, sometimes = results.significant(), results.sometimes_significant()
    limit = f"{SIGNIFICANCE:.0%} after Holm's correction"
    text = f"- **Significant over both papers** ({limit}, with every treatment of doubtful placements): "
    text += f"{joined(always)}." if always else "none."
    if sometimes:
        text += f" With some of the treatments only: {joined(sometimes)}."
    return results.verdict("conclusion: significant", text)


def _best_and_worst(results: ValidityResults) -> str:
    rows = [row for row in results.main_tests if row["mean"] is not None]
    best = max(rows, key=lambda row: row["mean"])
    worst = min(rows, key=lambda row: row["mean"])
    positive = [row["score"] for row in rows if min(row["rho"]) > 0.0]
    text = (
        f"- **Between the scores**: mean rho ranges from {worst['mean']:+.2f} ({worst['score']}) to "
        f"{best['mean']:+.2f} ({best['score']}); positive in both papers: "
        f"{joined(positive) if positive else 'none'}. With so few placements these differences may be "
        "due to chance: the order of the scores is not a result."
    )
    return results.verdict("conclusion: best and worst", text)


def _height(results: ValidityResults) -> str:
    rho = [results.correlation_of(paper, MAIN_CLASS, "mean height")["mean"] for paper in papers()]
    if rho[0] * rho[1] >= 0.0:
        text = "- **Height** has the same effect in both papers."
    else:
        text = (
            "- **Height** has opposite effects in the two papers. In the second one the tallest layout "
            "has four LiDARs on one mast, 20 cm apart: the effect of height cannot be separated there "
            "from the effect of having all LiDARs in one place, nor from anything that comes with it."
        )
    return results.verdict("conclusion: height", text)


def _disagreements(results: ValidityResults) -> str:
    disagreements = [
        f"{paper.classes[cls]} in {paper.short}"
        for paper in papers()
        for cls in common_classes()
        if detectors_disagree(results.correlations_of(paper, cls)[0])
    ]
    if not disagreements:
        text = "- **By class**: the detectors agree with each other on all classes."
    else:
        text = (
            f"- **By class**: the detectors do not agree with each other on {joined(disagreements)}. "
            "No score can be right for all of them there."
        )
    return results.verdict("conclusion: classes", text)
