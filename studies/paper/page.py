"""The page of ``python -m studies.paper``: its first and last section, and the order of all sections.

Every number on the page comes from results.json. A section states what the results show only
through `ReproductionResults.verdict`, which notes the statement: a test changes the results and
checks that every verdict changes with them.
"""

from __future__ import annotations

from pe_core.metric import H_BLIND

from ..wording import ABOUT_M, FIGURE_NATS, compared, how_many, joined, range_text, wrapped
from .claims import TEXTS
from .experiment_1 import experiment_1, sensitivity
from .experiment_2 import experiment_2
from .experiments_3_and_4 import experiment_3, experiment_4, pitch
from .paper import PRIORS, ROWS
from .plan import CAMERA_ROWS
from .result_view import (
    CORNER_ROWS,
    ROOF_ROWS,
    ReproductionResults,
    distances_from_the_paper,
    ends_like_the_paper,
    height_differences,
)
from .tables import ap_curve, orderings, priors, rows

TITLE = "# The paper's experiments, reproduced"


def page(results: ReproductionResults) -> str:
    """Return the page as Markdown."""
    return wrapped(section(results) for section in SECTIONS)


def head(results: ReproductionResults) -> str:
    """Return the title, and the answer in short."""
    return f"""
{TITLE}

T. Ma, Z. Liu and Y. Li, *Perception Entropy: A Metric for Multiple Sensors Configuration Evaluation
and Design*, ICRA 2021: Table II and the pitch figure, row by row, with the reasons for differences.
Lower is better. [metric.md](../metric.md) has the equations, and our choices where the paper does not specify
something. `python -m studies.paper` writes this page; every figure on it is in [results.json](results.json), and every
verdict follows from the figures.

In short: {_orderings(results)}; {_mounting_places(results)}{_figures(results)}. The paper's prior comes from a road
test that is not public; ours are `road` (fitted to public driving data), `uniform` and `highway`. At the placements
that the paper prints:

{_orderings_by_priors(results)}

{_lidar_rows(results)} {_camera_rows(results)}
"""


def _by_priors(results: ReproductionResults) -> tuple[list[str], list[str], list[str]]:
    """Return the orderings that hold under all priors, under some, and under none."""
    holding, others = {}, {}
    for key in TEXTS:
        if key != "pitch":
            holding[key], others[key] = results.priors_holding(key, "printed")
    under_all = [key for key in holding if not others[key]]
    under_some = [key for key in holding if holding[key] and others[key]]
    return under_all, under_some, [key for key in holding if not holding[key]]


def _orderings(results: ReproductionResults) -> str:
    groups = _by_priors(results)
    where = ("under every prior", "under some of the priors", "under none")
    counts = [f"{len(keys)} {words}" for keys, words in zip(groups, where, strict=True) if keys]
    text = f"of the {sum(map(len, groups))} orderings, {joined(counts)} are as in the paper"
    return results.verdict("head: orderings", text)


def _mounting_places(results: ReproductionResults) -> str:
    """Return where the searches of LiDARs end: what was tested, and how far from the paper's."""
    texts = []
    if rows := results.searched(ROOF_ROWS):
        off = range_text(distances_from_the_paper(results, rows))
        end = results.verdict("head: above the roof", _ends(results, rows, "end above the roof"))
        texts.append(
            f"of the {len(rows)} searched rows with a LiDAR on a roof, {end}, {off} m from the paper's place"
        )
    if rows := results.searched(CORNER_ROWS):
        off = f"{max(map(abs, height_differences(results, rows))):.2f}"
        where = f"end at the paper's corners, to {ABOUT_M} m"
        end = results.verdict("head: corners", _ends(results, rows, where))
        texts.append(f"of the {len(rows)} on a bus, {end}, their heights up to {off} m off")
    return "".join(f"{text}; " for text in texts)


def _ends(results: ReproductionResults, rows: list[str], where: str) -> str:
    """Return how many of some rows end where the paper mounts."""
    return f"{how_many(sum(ends_like_the_paper(results, row) for row in rows), len(rows))} {where}"


def _figures(results: ReproductionResults) -> str:
    near = [r for r in ROWS if abs(results.entropy(r.name) - r.entropy) <= FIGURE_NATS]
    count = how_many(len(near), len(ROWS))
    text = f"of the {len(ROWS)} absolute figures, {count} are equal to the paper's to {FIGURE_NATS} nats"
    return results.verdict("head: figures", f"{text} under `{PRIORS[0]}`")


def _orderings_by_priors(results: ReproductionResults) -> str:
    """Return a list of the orderings by the priors under which they hold."""
    under_all, under_some, under_none = _by_priors(results)
    lines = []
    if under_all:
        text = f"- Hold under every prior: {'; '.join(TEXTS[k] for k in under_all)}."
        lines.append(results.verdict("head: everywhere", text))
    for key in under_some:
        yes, no = results.priors_holding(key, "printed")
        text = f"- Holds under {joined(yes)}, not under {joined(no)}: {TEXTS[key]}."
        lines.append(results.verdict(f"head: {key}", text))
    lines += [results.verdict(f"head: {k}", f"- Holds under none: {TEXTS[k]}.") for k in under_none]
    pitch = "holds" if results.printed_claim("pitch")["holds"] else "does not hold"
    lines.append(results.verdict("head: pitch", f"- The pitch figure {pitch}: {TEXTS['pitch']}."))
    return "\n".join(lines)


def _lidar_rows(results: ReproductionResults) -> str:
    """Return how the LiDAR rows compare with the printed figures, and why."""
    pairs = [
        (results.entropy(row.name, prior), row.entropy)
        for row in ROWS
        if row.name in (*ROOF_ROWS, *CORNER_ROWS)
        for prior in PRIORS
    ]
    words = [compared(ours, printed, FIGURE_NATS) for ours, printed in pairs]
    link = "([experiment 1](#experiment-1-pandar64-and-hdl-64e))"
    why = f"whole beams are counted, and a voxel without a beam costs {H_BLIND:.2f} nats {link}"
    if set(words) == {"higher"}:
        text = f"The LiDAR rows are higher than printed under every prior: {why}."
    elif set(words) == {"lower"}:
        text = "The LiDAR rows are lower than printed under every prior."
    else:
        counts = [f"{words.count(word)} {word}" for word in dict.fromkeys(words)]
        text = f"The LiDAR rows' figures, compared with the printed ones: {joined(counts)}; {why}."
    return results.verdict("head: LiDAR rows", text)


def _camera_rows(results: ReproductionResults) -> str:
    """Return whether the printed formula can give the camera rows at all."""
    beyond = [
        results[f"bound/{row}/{prior}"]["least_all_round"] > printed
        for row, printed in ((r.name, r.entropy) for r in ROWS if r.name in CAMERA_ROWS)
        for prior in PRIORS
    ]
    link = "([experiment 2](#experiment-2-60-and-120-degree-cameras))"
    if all(beyond):
        text = "The printed formula cannot give the camera rows under any of these priors"
    else:
        text = f"The bound allows {beyond.count(False)} of {len(beyond)} camera figures"
    return results.verdict("head: camera rows", f"{text} {link}.")


def how_made(results: ReproductionResults) -> str:
    """Return commit, machine, seeds and cost."""
    made, effort = results.made, results.effort
    searches = results.search_seconds()
    total = sum(results.seconds.values())
    voxels = "the whole grid of 64 million voxels"
    if effort.samples:
        voxels = f"{effort.samples:,} voxels sampled from the prior"
    seeds = ", ".join(str(s) for s in effort.seeds)
    return f"""
## How it was made

| | |
| --- | --- |
| commit | {made["commit"]} |
| machine | {made["machine"]} |
| versions | perception-entropy {made["version"]}, Python {made["python"]}, NumPy {made["numpy"]} |
| scores | of {voxels} |
| searches | Algorithm 1: seven rounds of {effort.candidates} candidates, each evaluated on {effort.search_samples:,} voxels |
| seeds | {seeds} |
| cost | {len(searches)} searches and {len(results.seconds) - len(searches)} other tasks, {total / 60:.0f} minutes of one processor |
| one search | of one row, candidates on sampled voxels: {min(searches) / 60:.1f} to {max(searches) / 60:.1f} minutes on one processor; "around an hour" in the paper is its whole optimization, which is other work |

To repeat it: `python -m studies.paper`, or `python -m studies.paper --quick`, which takes a minute and gives the orderings alone.
`python -m studies.paper --check` computes again what needs no search, and compares it with results.json digit by digit.
"""


SECTIONS = (
    head,
    orderings,
    rows,
    experiment_1,
    experiment_2,
    experiment_3,
    experiment_4,
    pitch,
    sensitivity,
    ap_curve,
    priors,
    how_made,
)
"""In the order of the page."""
