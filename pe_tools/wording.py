"""Values of the engine in words: what is stored and handed on are the values, each front end asks
here for the texts.
"""

from __future__ import annotations

from collections.abc import Mapping

from pe_core.scoring.requirements import Reason, VerdictSummary

REASONS = {
    "too few": "too few on it",
    "in part": "seen in part at most",
    "not counted": "of a kind that does not count",
}
"""Texts of the codes that are not their own text."""


def reason_text(reason: Reason) -> str:
    """Say why a sensor does not see a body: a part of the vehicle, or "out of view", ..."""
    return reason.part or REASONS.get(reason.code, reason.code)


def unseen_text(unseen_by: Mapping[str, Reason]) -> str:
    """Say why sensors, by name, do not see a body: "roof (left, right); out of view (rear)"."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in unseen_by.items():
        by_reason.setdefault(reason_text(reason), []).append(name)
    return "; ".join(f"{text} ({', '.join(names)})" for text, names in by_reason.items())


def margin_text(verdict: VerdictSummary, noun: str = "") -> str:
    """Say a margin: "0.42 m", "fails 0.15 m inside", "blind 0.40 m2, at least 0.30 m".

    `noun` stands before the margin of a requirement that is met.
    """
    parts = [] if verdict.blind_m2 is None else [f"blind {verdict.blind_m2:.2f} m2"]
    if verdict.margin_m is not None:
        at_least = "at least " if verdict.margin_at_least else ""
        grows, fails = f"{noun}{at_least}{verdict.margin_m:.2f} m", f"{-verdict.margin_m:.2f} m"
        parts.append(grows if verdict.met else f"fails {fails} inside")
    elif verdict.blind_m2 is None and not verdict.met:
        parts.append(f"fails at {verdict.failing:,} of {verdict.samples:,} places")
    return ", ".join(parts)


def verdict_text(verdict: VerdictSummary) -> str:
    """Say a verdict in a line: "geometric check after R159 Annex 3: met, margin 0.42 m"."""
    what = f"geometric check after {verdict.check}" if verdict.check else verdict.name
    parts = ["met" if verdict.met else "not met", margin_text(verdict, "margin ")]
    parts.append(f"in {verdict.condition}" if verdict.condition else "")
    preview = " (preview)" if verdict.preview else ""
    return f"{what}: {', '.join(filter(None, parts))}{preview}"
