"""The tables of all orderings and all rows, and what the experiments' sections share."""

from __future__ import annotations

from ..claims import TEXTS
from ..facts import Facts, label, placement_text, printed_text
from ..paper import PRIORS, ROW, ROWS
from ..words import joined, table


def orderings(facts: Facts) -> str:
    """Return the table of verdicts."""
    lines = []
    for key, text in TEXTS.items():
        printed = [_cell(facts, key, "printed", prior) for prior in PRIORS]
        searched = [_cell(facts, key, "searched", prior) for prior in PRIORS]
        told = [f"{c} ({p})" for c, p in zip(searched, PRIORS, strict=True) if c]
        lines.append([text, *printed, "; ".join(told)])
    titles = ["ordering", *(f"printed, {prior}" for prior in PRIORS), "our search"]
    return f"""
## Orderings

{table(titles, lines)}

The first figure of each pair is of the rig that the paper finds better. Priors are compared at the
paper's printed placements; for experiment 4 and "front doubled" the weights are the paper's, doubled
ahead.
"""


def _cell(facts: Facts, key: str, where: str, prior: str) -> str:
    """Return both figures of an ordering, and whether it holds."""
    found = [
        c for c in facts.claims if (c["experiment"], c["where"], c["prior"]) == (key, where, prior)
    ]
    if not found:
        return ""
    (claim,) = found
    verdict = "holds" if claim["holds"] else "**does not hold**"
    told = f"{verdict}: {claim['better_entropy']:.4f}, {claim['worse_entropy']:.4f}"
    return facts.say(f"table: {key}, {where}, {prior}", told)


def rows(facts: Facts) -> str:
    """Return Table II with our figures."""
    lines = []
    for row in ROWS:
        ours = [
            f"{facts.entropy(row.name, p):.4f} ({facts[f'printed/{row.name}/{p}']['coverage']:.0%})"
            for p in PRIORS
        ]
        best = f"{facts.best(row.name)['entropy']:.4f}" if facts.searched(row.name) else ""
        mean = facts.spread(row.name) if facts.searched(row.name) else ""
        lines.append([label(row.name), f"{row.entropy:.4f}", *ours, best, mean])
    titles = ["row", "paper", *PRIORS, f"best search, {PRIORS[0]}", "mean of the seeds"]
    return f"""
## Table II

Perception entropy [nats] at the paper's printed placement under each prior, with the share of the
prior that any sensor sees; and where Algorithm 1 ends from a neutral start under `{PRIORS[0]}`.

{table(titles, lines)}

![Entropy of each row, the paper's and ours](rows.png)

Filled marks in the pictures below are the ends of our searches, one a seed; hollow ones are the
paper's. Lines show where a sensor's x axis points.
"""


def placements(facts: Facts, names: list[str]) -> str:
    """Return where the paper's sensors are, and ours; and pictures."""
    lines = []
    for name in names:
        ours = placement_text(facts.best(name)["placements"]) if facts.searched(name) else ""
        lines.append([label(name), printed_text(name), ours])
    titles = ["row", "paper: (x, y, z) m, pitch", "ours, best seed"]
    pictures = "\n".join(
        f"![{ROW[name].label}: the paper's placement and ours](placements_{name}.png)"
        for name in names
    )
    return f"{table(titles, lines)}\n\n{pictures}"


def same(facts: Facts, key: str) -> str:
    """Return whether an ordering is the paper's, at its placements and in our search."""
    yes, no = facts.holding(key, "printed")
    other = "the reverse" if facts.reversed(key, no) else "not"
    if not no:
        text = "the same under every prior"
    elif yes:
        text = f"the same under {joined(yes)}, {other} under {joined(no)}"
    else:
        text = f"{other} under every prior" if other != "not" else "under no prior the same"
    found, lost = facts.holding(key, "searched")
    if found and not lost:
        text += f", {'and' if yes else 'but the same'} in our own search"
    elif lost and not found:
        text += f", {'and' if not yes else 'but'} not in our own search"
    return facts.say(f"ordering {key}", f"{text}.")
