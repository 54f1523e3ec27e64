"""Key figures and a known rig's score in words, as the read-out and the panel tell them."""

from __future__ import annotations

from ..engine import advice, pe
from .background import Anchor, ShownFigures

MINUS = "\N{MINUS SIGN}"
WAITING = "Blind ground, reach, AP: being worked out"
BEFORE = "Before this move: "
NOTABLE = 0.0005
"""Entropies nearer than this read the same [nats]."""


def figure_lines(found: ShownFigures) -> tuple[str, str]:
    """Return two lines: blind ground; reach and AP. Those of before a move say so."""
    now, before = found.now, found.before
    if now is None:
        return WAITING, ""
    lines = blind_line(now, before), found_line(now, before)
    if found.current:
        return lines
    blind, reach = (f"{BEFORE}{line}" if line else "" for line in lines)
    return blind, reach


def blind_line(now: advice.KeyFigures, before: advice.KeyFigures | None) -> str:
    """Return "81.2 m² blind to 0.5 m tall (−3.1)"."""
    what = f"blind to what is {now.height:g} m tall" if now.height else "blind to what lies flat"
    by = None if before is None else now.blind_m2 - before.blind_m2
    return f"{now.blind_m2:.1f} m² {what}{change(by, 1)}"


def found_line(now: advice.KeyFigures, before: advice.KeyFigures | None) -> str:
    """Return "Pedestrian found to 47 m ahead (+2), expected AP 0.62"; empty on objects."""
    if now.class_name is None or now.reach_m is None:
        return ""
    by = None if before is None or before.reach_m is None else now.reach_m - before.reach_m
    sign = "\N{GREATER-THAN OR EQUAL TO} " if now.at_least else ""
    to = f"to {sign}{now.reach_m:.0f} m ahead" if now.reach_m else "nowhere ahead"
    line = f"{now.class_name.capitalize()} found {to}{change(by, 0)}"
    if now.expected_ap is None:
        return line
    known = before is not None and before.expected_ap is not None
    by = now.expected_ap - before.expected_ap if known else None
    return f"{line}, AP {now.expected_ap:.2f}{change(by, 2)}"


def change(by: float | None, digits: int) -> str:
    """Return " (+1.2)"; nothing where it cannot be seen."""
    text = "" if by is None else f"{by:+.{digits}f}"
    return f" ({text.replace('-', MINUS)})" if text.strip("+-0.") else ""


def anchor_line(anchor: Anchor, now: pe.Glance) -> str:
    """Return "nuScenes here: 2.867 nats; this is 0.229 worse"."""
    by = now.entropy - anchor.glance.entropy
    word = f"{abs(by):.3f} {'worse' if by > 0.0 else 'better'}" if abs(by) >= NOTABLE else "alike"
    return f"{anchor.title} here: {anchor.glance.entropy:.3f} nats; this is {word}"
