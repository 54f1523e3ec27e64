"""The title, and the answer in short."""

from __future__ import annotations

from pe_core.metric import H_BLIND

from ..claims import TEXTS
from ..facts import Facts
from ..paper import PRIORS, ROWS
from ..places import CORNER_ROWS, ROOF_ROWS, at_the_papers_place, searched
from ..words import FIGURE_NATS, against, how_many, joined

CAMERA_ROWS = ("2_60deg", "2_120deg")


def head(facts: Facts) -> str:
    """Return the title, and the answer in short."""
    return f"""
# The paper's experiments, reproduced

T. Ma, Z. Liu and Y. Li, *Perception Entropy: A Metric for Multiple Sensors Configuration Evaluation
and Design*, ICRA 2021, Table II and the pitch figure, row by row: the same, or different and why.
Lower is better. [metric.md](../metric.md) has the equations and what is done where the paper leaves
room. `pe reproduce` writes this page; every figure on it is in [results.json](results.json), and every
verdict follows from them.

In short: {_orderings(facts)}; {_mounted(facts)}{_absolute(facts)}. Its prior comes from a road test that is not
public; ours are `road` (fitted to public driving data), `uniform` and `highway`. At the paper's printed placements:

{_list(facts)}

{_lidars(facts)} {_cameras(facts)}
"""


def _by_priors(facts: Facts) -> tuple[list[str], list[str], list[str]]:
    """Orderings that hold under all priors, under some, and under none."""
    keys = [key for key in TEXTS if key != "pitch"]
    held = {key: facts.holding(key, "printed") for key in keys}
    every = [key for key in keys if not held[key][1]]
    some = [key for key in keys if all(held[key])]
    return every, some, [key for key in keys if not held[key][0]]


def _orderings(facts: Facts) -> str:
    every, some, never = _by_priors(facts)
    total = len(every) + len(some) + len(never)
    parts = [
        (every, "under every prior"),
        (some, "under some of the priors"),
        (never, "under none"),
    ]
    counted = [f"{len(keys)} {where}" for keys, where in parts if keys]
    told = f"of the {total} orderings, {joined(counted)} come out as in the paper"
    return facts.say("head: orderings", told)


def _mounted(facts: Facts) -> str:
    rows = searched(facts, (*ROOF_ROWS, *CORNER_ROWS))
    if not rows:
        return ""
    there = sum(at_the_papers_place(facts, row) for row in rows)
    told = f"the LiDARs of {how_many(there, len(rows))} searched rows end at its mounting places; "
    return facts.say("head: mounting places", told)


def _absolute(facts: Facts) -> str:
    near = [r for r in ROWS if abs(facts.entropy(r.name) - r.entropy) <= FIGURE_NATS]
    told = f"of the {len(ROWS)} absolute figures, {how_many(len(near), len(ROWS))} come out to {FIGURE_NATS} nats"
    return facts.say("head: figures", f"{told} under `{PRIORS[0]}`")


def _list(facts: Facts) -> str:
    """Return the orderings by where they hold."""
    every, some, never = _by_priors(facts)
    lines = []
    if every:
        told = f"- Hold under every prior: {'; '.join(TEXTS[k] for k in every)}."
        lines.append(facts.say("head: everywhere", told))
    for key in some:
        yes, no = facts.holding(key, "printed")
        told = f"- Holds under {joined(yes)}, not under {joined(no)}: {TEXTS[key]}."
        lines.append(facts.say(f"head: {key}", told))
    lines += [facts.say(f"head: {k}", f"- Holds under none: {TEXTS[k]}.") for k in never]
    pitch = "holds" if facts.claim("pitch", "printed")["holds"] else "does not hold"
    lines.append(facts.say("head: pitch", f"- The pitch figure {pitch}: {TEXTS['pitch']}."))
    return "\n".join(lines)


def _lidars(facts: Facts) -> str:
    """Say how the LiDAR rows compare with the printed figures, and what that is due to."""
    pairs = [
        (facts.entropy(row.name, prior), row.entropy)
        for row in ROWS
        if row.name in (*ROOF_ROWS, *CORNER_ROWS)
        for prior in PRIORS
    ]
    found = [against(ours, printed, FIGURE_NATS) for ours, printed in pairs]
    link = "([experiment 1](#experiment-1-pandar64-and-hdl-64e))"
    why = f"whole beams are counted and what no beam meets costs {H_BLIND:.2f} nats {link}"
    if set(found) == {"higher"}:
        told = f"The LiDAR rows come out higher than printed under every prior: {why}."
    elif set(found) == {"lower"}:
        told = "The LiDAR rows come out lower than printed under every prior."
    else:
        counted = (f"{found.count(word)} {word}" for word in dict.fromkeys(found))
        told = f"Of the LiDAR rows' figures, {joined(list(counted))} than or as printed: {why}."
    return facts.say("head: LiDAR rows", told)


def _cameras(facts: Facts) -> str:
    """Say whether the printed formula can give the camera rows at all."""
    beyond = [
        facts[f"bound/{row}/{prior}"]["least_all_round"] > printed
        for row, printed in ((r.name, r.entropy) for r in ROWS if r.name in CAMERA_ROWS)
        for prior in PRIORS
    ]
    link = "([experiment 2](#experiment-2-60-and-120-degree-cameras))"
    if all(beyond):
        told = "The camera rows cannot be had from the printed formula under any of these priors"
    else:
        told = f"The bound leaves room for {beyond.count(False)} of {len(beyond)} camera figures"
    return facts.say("head: camera rows", f"{told} {link}.")
