"""How the results were made."""

from __future__ import annotations

from ...words import table
from ..facts import ValidityFacts


def made(facts: ValidityFacts) -> str:
    """Return commit, machine, versions, cost."""
    of = facts.made
    versions = f"perception-entropy {of['version']}, Python {of['python']}, NumPy {of['numpy']}"
    lines = [
        ["machine", of["machine"]],
        ["versions", versions],
        [
            "cost",
            f"{len(facts.seconds)} tasks, {sum(facts.seconds.values()) / 60:.0f} minutes of one processor",
        ],
    ]
    return f"""
## How it was made

{table(["commit", of["commit"]], lines)}

Again: `pe validate` (or `pe validate --quick`, in a minute, on fewer voxels and objects: not for
figures). `pe validate --page-only` writes page and plots of the results that are there. The published
figures are in `pe_report/data/published_placements.json`.
"""
