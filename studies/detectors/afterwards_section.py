"""The section of the page on what was looked for afterwards, and the answer in short."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..published.findings import p_text, rho_text
from ..wording import joined, table
from .after_search.section import rings_found
from .analysis import HOLDS, OPEN
from .plan import FIXED, MIXED, StudyPlan
from .scores import BEAMS, COVERAGE, PRIMARY
from .study_page import rho_with_interval

Json = dict[str, Any]

TITLE = "## Looked for afterwards"


def short_answer(
    plan: StudyPlan, found: Json, searched: Mapping[str, Any], cameras: Mapping[str, Any]
) -> str:
    """Return what the study says in a few sentences; README and other pages have them, too.

    Parameters
    ----------
    plan : StudyPlan
    found : dict
        The analysis, with what was looked for afterwards.
    searched, cameras : mapping
        The analyses of the runs before and after a search, and of those with cameras.
    """
    after, verdict = found["afterwards"], found["statements"][0]["verdict"]
    if verdict == OPEN or not after:
        return "Whether detectors find more at a better score is open: not all runs are done."
    unseen = ["real roads"] + ["cameras"] * (cameras["verdict"] != HOLDS)
    sentences = [
        _within_a_rig(found, verdict == HOLDS),
        _blind_sector(after["fewer_beams"]),
        _after_a_search(plan, searched),
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
        f"{rhos[0]:.2f} over {whole['placements']} placements, {rhos[1]:.2f} over the {all_round['placements']} that see all round."
    )
    as_well = whole["scores"][COVERAGE]["rho"] >= rhos[0]
    return f"{text} Coverage does as well." if as_well else text


def _blind_sector(pairs: Json) -> str:
    wrong = pairs["wrong"][PRIMARY]
    return "Entropy can prefer a rig with a blind sector." if wrong and pairs["blind"] else ""


def _after_a_search(plan: StudyPlan, searched: Mapping[str, Any]) -> str:
    """Return which search finds more near and far, where all rigs agree; else nothing."""
    rings = list(plan.precision.rings.items())
    near, far = ([r[ring] for r in rings_found(searched)] for ring in (rings[0][0], rings[-1][0]))
    is_so = near and all(row["interval"][1] < 0.0 for row in near)
    if not (is_so and all(row["interval"][0] > 0.0 for row in far)):
        return ""
    return (
        f"After searches, expected AP in traffic found more beyond {rings[-1][1][0]:g} m, entropy "
        f"within {rings[0][1][1]:g}."
    )


def afterwards_section(found: Json) -> str:
    """Return the section of the page from the analysis; empty while runs are missing."""
    after = found["afterwards"]
    if not after:
        return ""
    return f"""
{TITLE}

These rows are exploratory: they were looked for when the results were known. They decide no statement, their
intervals are not corrected for how many there are, and other rows may have been looked at that are not here.

### Statement 3, the better half

{_better_half(found)}

### Placements that see all round

The {after["all_round"]["placements"]} of the {found["designs"][FIXED]["placements"]} placements of the one rig:

{_all_round(after["all_round"])}

### By distance

The same placements; the AP found in a ring, mean of the classes. *Beyond coverage*: partial rho of {PRIMARY}, given
coverage, over all {found["designs"][FIXED]["placements"]} placements; in all rings together it is {rho_with_interval(after["beyond_coverage"])}.
{_of_beyond(after)}

{_rings(after["rings"])}

### Fewer beams that find more

{_fewer_beams(after)}

### Curves on other hardware

{_curves(after["curves_across"])}

### What score and detectors share

The beams of both are cast by the same engine, on the same bodies; the scenes of the detectors have the objects and
positions of the prior that the score has. What the engine or the prior gets wrong is wrong in both, and may raise rho.
"""


def _better_half(found: Json) -> str:
    after, row = found["afterwards"]["better_half"], found["statements"][2]
    figures, mixed = row["figures"], found["designs"][MIXED]["scores"][PRIMARY]["better_half"]
    powers = joined([f"{p['share']:.2f} for a true rho of {p['rho']:.2f}" for p in after["power"]])
    low, high = (rho_text(v) for v in after["bca"])
    return f"""\
Verdict: {row["verdict"]}. The plan took an interval that contains 0 for a refutation. It is none: it leaves the sign open. So
the rule was changed when the results were known. By percentiles, as planned, rho is {rho_with_interval(figures)}. That interval
is biased: its bootstraps have a mean of {after["bootstrap_mean"]:.2f}, as placements that are drawn twice are ties. It is weak,
too: the share of such studies in which it is above 0 (power) is {powers}. Looked for afterwards: p {p_text(after["p"])}
by permutations, {low} to {high} by the corrected bootstrap (BCa), and {rho_with_interval(mixed)} for the better half of the mixed
design. Methods that are chosen after the results decide nothing."""


def _all_round(part: Json) -> str:
    vehicles = list(next(iter(part["scores"].values()))["by_vehicle"])
    lines = [
        [
            _marked(name),
            rho_with_interval(row),
            *(rho_text(row["by_vehicle"][v]) for v in vehicles),
        ]
        for name, row in part["scores"].items()
    ]
    return table(["score", "rho (95 %)", *(f"{v} alone" for v in vehicles)], lines)


def _marked(name: str) -> str:
    return f"**{name}**" if name == PRIMARY else name


def _rings(rings: Json) -> str:
    names = list(next(iter(rings.values()))["scores"])
    lines = [
        [
            ring,
            *(rho_with_interval(part["scores"][name]) for name in names),
            rho_with_interval(part["beyond_coverage"]),
        ]
        for ring, part in rings.items()
    ]
    return table(["ring", *map(_marked, names), "beyond coverage"], lines)


def _of_beyond(after: Json) -> str:
    """Return in which rings entropy says more than coverage, by the whole interval or the sign."""
    parts = {ring: part["beyond_coverage"] for ring, part in after["rings"].items()}
    shown = [ring for ring, part in parts.items() if part["interval"][0] > 0.0]
    above = [ring for ring, part in parts.items() if part["rho"] > 0.0]
    if shown:
        return f"It is shown to say more than coverage in {joined(shown)}."
    where = f"; its rho is above 0 in {joined(above)} alone" if above else ""
    return f"That it says more than coverage is shown in no ring{where}."


def _fewer_beams(after: Json) -> str:
    pairs, gain = after["fewer_beams"], after["minus_beams"]
    low, high = gain["interval"]
    others = joined([f"{name} {count}" for name, count in pairs["wrong"].items() if name != BEAMS])
    return (
        f"In {pairs['pairs']} of the {pairs['of']} pairs with different hardware, the rig with fewer beams finds more; "
        f"in {pairs['blind']} of them the other one has a blind sector ({pairs['others']} such placements, each in several pairs). Wrongly ordered, of {pairs['pairs']}: {others}. "
        f"Of all pairs, {PRIMARY}, orders {gain['share']:+.3f} ({low:+.3f} to {high:+.3f}) more of them rightly than the "
        "number of beams does."
    )


def _curves(row: Json) -> str:
    if not row:
        return "There are no curves yet."
    return (
        f"With the curves fitted to half of the one rig's placements ([below](#ap-curves-from-scans)), expected AP in "
        f"traffic, mean of the classes, of the {row['placements']} placements across hardware has an RMSE of "
        f"{row['rmse']:.3f} and rho {rho_with_interval(row)} with the AP found."
    )
