"""The page of ``python -m studies.published``: what was published and compared, and the order of all sections.

A section states what the results show only through `ValidityResults.verdict`, which notes the
statement.
"""

from __future__ import annotations

import math

from ..wording import joined, table, wrapped
from .correlations import MAIN_CLASS, ValidityResults, min_significant_rho
from .findings import by_class, by_condition, conclusion, over_both_papers, ranges
from .published import Paper, papers
from .scores import BODY_M, CANDIDATES

TITLE = "# Do the scores rank placements as detectors do?"


def page(results: ValidityResults, own: str) -> str:
    """Return the page as Markdown; `own` is the answer of our own study."""
    return wrapped([_head(results, own), *(section(results) for section in SECTIONS)])


def _head(results: ValidityResults, own: str) -> str:
    """Return the title, and the answers in short."""
    counts = joined([f"{len(p.placements)} placements in {p.short}" for p in papers()])
    return f"""
{TITLE}

[Our own study](own/README.md), with detectors trained at placements that it draws itself: {own}

A score of sensor placements is useful if detectors find more when they are trained and tested with the
better-scored placement. Such results are published for few placements: {counts}, each
with four detectors. The rest of this page compares the scores of this project with those results. `python -m studies.published`
writes it; every figure is in [results.json](results.json), and every verdict follows from the figures.

In short: {_significant(results)} {_opposite(results)} {_height(results)}
"""


def _significant(results: ValidityResults) -> str:
    always, sometimes = results.significant(), results.sometimes_significant()
    if always:
        text = f"**over both papers, the correlation of {joined(always)} is significant.**"
    elif sometimes:
        text = (
            f"**over both papers, the correlation of {joined(sometimes)} is significant, but not with "
            "every treatment of doubtful placements.**"
        )
    else:
        text = "**over both papers, no score has a significant correlation.**"
    return results.verdict("head: significant", text)


def _opposite(results: ValidityResults) -> str:
    names = results.opposite_in_papers()
    if not names:
        text = "No score has correlations of opposite sign in the two papers."
    else:
        text = (
            f"Of {len(results.main_tests)} scores, {len(names)} have correlations of opposite sign in "
            f"the two papers, for {MAIN_CLASS}s."
        )
    return results.verdict("head: opposite", text)


def _height(results: ValidityResults) -> str:
    rho = [results.correlation_of(paper, MAIN_CLASS, "mean height")["mean"] for paper in papers()]
    figures = joined([f"{r:+.2f} in {p.short}" for r, p in zip(rho, papers(), strict=True)])
    of_height = f"rho of the mean height with the AP of {MAIN_CLASS}s: {figures}"
    if rho[0] * rho[1] < 0.0:
        text = (
            "The papers themselves disagree on the simplest question, how high LiDARs should be "
            f"mounted ({of_height}), so no score that rewards height can agree with both."
        )
    else:
        text = f"The papers agree on the mean height ({of_height})."
    return results.verdict("head: height", text)


def evidence(results: ValidityResults) -> str:
    """Return what was published, and how little it is."""
    return f"""
## The evidence

{table(["paper", "placements", "LiDARs", "classes", "detectors", "conditions"], [_paper_line(p) for p in papers()])}

{"".join(_notes(paper) for paper in papers())}
Both are simulations in CARLA with four LiDARs of 16 channels, and they have authors in common. A sample is
one placement: four detectors that were trained on the same eight placements are four observations of eight
samples. Over {len(papers()[0].placements)} placements, a rank correlation (Spearman's rho) is significant (less than
5 % of all permutations reach it) from {min_significant_rho(8):.2f} on; over 4, the number of different LiDAR layouts
in the second paper, no rho is significant.

![Mean height of the LiDARs against AP of cars, in both papers](height.png)

*AP of cars against the mean height of the LiDARs: mean over the detectors, each scaled from its worst to
its best placement. Filled: level placements; hollow: rolled ones.*
"""


def _paper_line(paper: Paper) -> list[str]:
    lidar, detectors = paper.lidar, list(next(iter(paper.ap.values())))
    lidars = f"{lidar['channels']:.0f} channels, {lidar['low_deg']:g} to {lidar['high_deg']:g} deg"
    return [
        f"{paper.citation} ({paper.repository})",
        str(len(paper.placements)),
        lidars,
        ", ".join(paper.classes.values()),
        ", ".join(detectors),
        ", ".join(paper.ap).replace("_", " "),
    ]


def _notes(paper: Paper) -> str:
    source = f"- {paper.short}, source of the figures: {paper.read}.\n"
    return source + "".join(f"- {paper.short}: {note}\n" for note in paper.notes)


def comparison(results: ValidityResults) -> str:
    """Return which scores are compared, and what was chosen for them."""
    lines = [[c.name, c.about] for c in CANDIDATES]
    authors_scores = [f"{name} ({p.short})" for p in papers() for name in p.surrogates]
    lines.append(
        [", ".join(authors_scores), "the authors' own scores of their placements, as published"]
    )
    size = " x ".join(f"{side:g}" for side in BODY_M)
    effort = results.effort
    voxels = f"{effort.samples:,} voxels" if effort.samples else "all 64 million voxels"
    return f"""
## What is compared

The scores, the choices that they need and the tests were written down before the first score
was correlated with a result (commit d08156a). Nothing was changed afterwards because of its effect on a
correlation. Two things were changed after a first quick run: the last of the four tables of the test was added,
and fewer scenes are scored, to save time. We were not blind: a first analysis with other code, before this page
was planned, had shown that height has opposite effects in the two papers. Entropies are taken with a minus sign,
so that a higher value is better for all scores.

{table(["score", "what it is"], lines)}

The same for both papers: the space and the prior of a new study; a body of {size} m, the box of
the simulated Lincoln MKZ; the AP curves that come with the project (for [objects](../objects.md) by class, for
[voxels](../metric.md) the paper's). A score is compared with the AP of a class by its part for that class; the
uniform prior, which has no classes, and the height have no such part. Voxel scores are of {voxels}, and
in traffic of {effort.traffic_samples:,} in each of {effort.traffic_scenes} scenes; object scores are of {effort.scenes:,} scenes with about
19 objects each, either each object alone or all occluding each other. Voxel scores in traffic treat the other
road users as part of the vehicle's body: a voxel inside one of them is not counted.
"""


TRUE_RHO = (0.3, 0.5, 0.7, 0.9)
"""True correlations that a further experiment is planned for."""
Z_TWO_SIDED, Z_POWER = 1.959964, 0.841621
"""Normal quantiles: 5 % two-sided, and a power of 80 %."""
SPEARMAN_VARIANCE = 1.06
"""Variance of Fisher's z of Spearman's rho, times n - 3 (Fieller, Hartley and Pearson 1957)."""
GPU_HOURS = 10
"""Assumed cost of a training."""
SEEDS, DETECTORS = 3, 2


def further_experiment(results: ValidityResults) -> str:
    """Return which experiment would give an answer, and what it would cost."""
    lines = [
        [
            f"{rho:g}",
            str(placements_for(rho)),
            f"{trainings_for(rho)}",
            f"{trainings_for(rho) * GPU_HOURS:,}",
        ]
        for rho in TRUE_RHO
    ]
    titles = ["true rho", "placements", "trainings", "GPU hours, at 10 each"]
    return f"""
## Which experiment would give an answer

More placements, not more detectors. To find a rank correlation significant (5 %, two-sided) with a
power of 80 %, by Fisher's z with a variance of 1.06/(n - 3), takes:

{table(titles, lines)}

- **Which placements**: sampled so that height, spread of the LiDARs over the roof, and number of beams on
objects are not correlated (a Latin hypercube over them, roof, fenders and bumpers, rolled and level);
a quarter of them in pairs that perception entropy and object entropy rank in opposite order.
- **Which runs**: {DETECTORS} detectors, {SEEDS} seeds each, on the same logs for every placement, so that the variance
between training runs is known; the published tables have one run each. Two sensors as well as four.
- **What is written down first**: the score of every placement, one primary class, one test.
- **Cost**: trainings in the table are placements x {DETECTORS} detectors x {SEEDS} seeds. Neither paper gives the cost of a
training; {GPU_HOURS} GPU hours are our assumption, and the last column follows from it. The data are rendered once
for each placement: CARLA replays the same routes with other sensors.
"""


def placements_for(rho: float) -> int:
    """Return how many placements are needed to find a true rho significant, with a power of 80 %."""
    needed = ((Z_TWO_SIDED + Z_POWER) / math.atanh(rho)) ** 2
    return 3 + math.ceil(SPEARMAN_VARIANCE * needed)


def trainings_for(rho: float) -> int:
    """Return how many trainings that number of placements needs."""
    return placements_for(rho) * DETECTORS * SEEDS


def how_made(results: ValidityResults) -> str:
    """Return commit, machine, versions, cost."""
    made = results.made
    versions = (
        f"perception-entropy {made['version']}, Python {made['python']}, NumPy {made['numpy']}"
    )
    minutes = sum(results.seconds.values()) / 60
    lines = [
        ["machine", made["machine"]],
        ["versions", versions],
        ["cost", f"{len(results.seconds)} tasks, {minutes:.0f} minutes of one processor"],
    ]
    return f"""
## How it was made

{table(["commit", made["commit"]], lines)}

To repeat it: `python -m studies.published`, or `python -m studies.published --quick`, which takes a minute on fewer voxels and objects; its
figures are not meant to be used. `python -m studies.published --page-only` writes page and plots from stored results. The published
figures are in `studies/published/data/published_placements.json`.
"""


SECTIONS = (
    evidence,
    comparison,
    over_both_papers,
    by_class,
    ranges,
    by_condition,
    conclusion,
    further_experiment,
    how_made,
)
"""In the order of the page."""
