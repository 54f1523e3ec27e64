"""Values of the engine in words: what is stored and handed on are the values, each front end asks
here for the texts."""

import math
from collections.abc import Callable, Container, Mapping, Sequence
from typing import Any

from pe_core.base.values import shown_share
from pe_core.scoring.requirements import Reason, VerdictSummary
from pe_core.scoring.sight import shown_end

PARTS_NAMED = 3  # So many parts of the vehicle are named in a warning
REASONS = {
    "too few": "too few on it",
    "in part": "seen in part at most",
    "not counted": "of a kind that does not count",
}  # Texts of the codes that are not their own text


def percent(share: float, digits: int | None = None) -> str:
    """Return a share, 0 to 1, in percent with `digits` decimals: "81.4%"; less than 1 is less than
    100%. Without `digits`: "85%" as in a sentence, with one decimal for shares near 0 or 1: "0.4%".
    """
    if digits is not None:
        return f"{100.0 * shown_share(share, digits):.{digits}f}%"
    value = 100.0 * share
    if 0.0 < value < 0.05:
        return "under 0.1%"
    if 99.95 <= value < 100.0:
        return "over 99.9%"
    return f"{value:.1f}%" if 0.0 < value < 9.95 or 99.5 <= value < 100.0 else f"{value:.0f}%"


def metres(length: float) -> str:
    """Return a length [m] as "5 cm", "1.45 m" or "84 m"."""
    if abs(length) < 0.995:
        return f"{100.0 * length:.0f} cm"
    return f"{length:.2f} m" if abs(length) < 9.995 else f"{length:.0f} m"


def degrees(width: float) -> str:
    """Return the width of a blind sector [deg], rounded up: "303.7 deg", or "none"."""
    return f"{shown_end(width):.1f} deg" if width else "none"


def times(factor: float) -> str:
    """Return a factor as "12 times" or "0.31 times"."""
    return f"{factor:.0f} times" if factor >= 9.5 else f"{factor:.2g} times"


def joined(texts: Sequence[str]) -> str:
    """Join texts: "a", "a and b", "a, b and c"."""
    if len(texts) < 2:
        return "".join(texts)
    return f"{', '.join(texts[:-1])} and {texts[-1]}"


def aligned(table: Sequence[Sequence[str]], figures: Container[int] = ()) -> list[str]:
    """Return rows of cells as lines: columns of `figures` to the right, all others to the left."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = []
    for cells in table:
        each = enumerate(zip(cells, widths, strict=True))
        padded = (c.rjust(w) if k in figures else c.ljust(w) for k, (c, w) in each)
        lines.append("  ".join(padded).rstrip())
    return lines


def off_by(position: float, angle: float) -> str:
    """Describe mounting errors [m, rad], 1 sigma: "mounted 1 cm and 0.3 deg off"."""
    turned = f"{math.degrees(angle):.2g} deg"
    moved = f"{1000.0 * position:.2g} mm" if position < 0.00995 else metres(position)
    named = [*[moved] * (position > 0.0), *[turned] * (angle > 0.0)]
    return f"mounted {' and '.join(named)} off"


def warning_text(code: str, part: str | None, values: Mapping[str, Any]) -> str:
    """Say a warning (`pe_tools.advice.Advice`) in a sentence, without the name of its subject.
    `part` is the part of the vehicle that causes it. A code without a text stands for itself."""
    return WARNINGS[code](part, **values) if code in WARNINGS else code.replace("_", " ")


def _requirement(_part: str | None, name: str, against: Sequence[str] | None) -> str:
    text = f"{name} is not met; no placement was found that keeps all requirements"
    if against is None:
        return f"{text}, and none of one sensor elsewhere that meets this one alone"
    if not against:
        return f"{text}, though none stands against it: a longer search may"
    return f"{text}: the nearest placement that meets it breaks {', '.join(against)}"


def _housing(_part: str | None, size: Sequence[float], parts: Sequence[str]) -> str:
    sides = " x ".join(f"{100.0 * side:.0f}" for side in size)
    named = ", ".join(parts[:PARTS_NAMED]) + (", ..." if len(parts) > PARTS_NAMED else "")
    return f"its housing ({sides} cm) cuts into {named}"


def _occluded(part: str | None, share: float, part_share: float, unit: str) -> str:
    if share - part_share > 0.005:
        return f"{percent(share)} of its {unit} are occluded, {percent(part_share)} by {part}"
    return f"{percent(share)} of its {unit} are occluded by {part}"


def _size(
    _part: str | None, size: Sequence[float], factor: float, unit: str | None, has_floor: bool
) -> str:
    x, y, z = size
    found = f"{metres(x)} long, {metres(y)} wide and {metres(z)} high is no vehicle"
    if not max(size):
        return "all of it is one point"
    fix = f"scaled by {factor:g} it would be as long as a car"
    if unit is not None:
        long, wide, high = (metres(factor * w) for w in size)
        fix = f"if these are {unit}, scale by {factor:g}: {long} x {wide} x {high}"
    return f"{found}; {'is a floor part of its mesh? Or, ' if has_floor else ''}{fix}"


def _faces(_part: str | None, turn: float, length: float, width: float, is_named: bool) -> str:
    if not is_named:
        return (
            f"it lies along y ({metres(width)} wide, {metres(length)} long) but forward is +x: "
            "turn it by 90 or -90 deg; its shape does not tell which end is the front"
        )
    side = {180.0: "backwards (-x)", -90.0: "left (+y)", 90.0: "right (-y)"}[turn]
    return f"it faces {side} by its parts' names; forward is +x: turn it by {turn:g} deg"


def _not_centred(_part: str | None, axis: str, off: float) -> str:
    if axis == "x":
        return f"not centred: its middle is {metres(abs(off))} off the origin, at x = {off:.1f} m"
    side = f"{metres(abs(off))} to the {'left' if off > 0.0 else 'right'} of y = 0"
    return f"not centred: its axis is {side}; mirror images of sensors would be off the vehicle"


WARNINGS: Mapping[str, Callable[..., str]] = {
    "fragile": lambda _, rise, position, angle, tolerant: (
        f"{off_by(position, angle)} (1 sigma) it is {rise:.2f} nats worse on average"
        + ("" if tolerant else "; a search with a tolerance looks for one that is less fragile")
    ),
    "requirement": _requirement,
    "figure": lambda _, name, told: (
        f"{name} cannot be kept as wanted: no placement that was tried has it; the best: {told}"
    ),
    "coincides": lambda _, others: (
        f"{joined(others)} {'is' if len(others) == 1 else 'are'} at the same place, within 1 cm; "
        "each of them counts: remove what is an alternative"
    ),
    "range_term": lambda _, curves: (
        f"{joined(curves)} with c: AP = a ln m - c ln R + b, not the paper's; compare these scores "
        "with such scores alone"
    ),
    "returns": lambda _: (
        "as measured in real traffic, not each beam as in the paper: compare these scores with "
        "such scores alone"
    ),
    "below_ground": lambda part, state, depth, parts: (
        f"state {state!r} drives {part!r}{f' and {parts - 1} more parts' if parts > 1 else ''} "
        f"through the ground, {depth:.2f} m deep"
    ),
    "covered": lambda part, state, share: (
        f"in state {state!r}, {part!r} covers {share:.0%} of what it sees, beyond that as drawn"
    ),
    "cover": lambda part, db, share: (
        f"the cover {part} takes {db:g} dB one way from {percent(share)} of its field"
    ),
    "inside": lambda _: "it is inside the body and sees next to nothing",
    "clear": lambda _, gap: f"it floats {metres(gap)} off the vehicle; mount it on a surface",
    "underground": lambda _, depth: f"it is {metres(depth)} under the ground",
    "outside": lambda _, x, y, z: f"it is outside the perception space, at ({x:g}, {y:g}, {z:g}) m",
    "upside_down": lambda _, kind: f"the {kind} is upside down",
    "housing": _housing,
    "looks_at": lambda part, distance: f"it looks at {part} from {metres(distance)}",
    "occluded": _occluded,
    "room": lambda part: (
        f"{part} is as large as a room: a floor or a studio that belongs to no vehicle?"
    ),
    "size": _size,
    "width": lambda _, width, factor: (
        f"{metres(width)} wide is more than roads allow; scaled by {factor:g} it would be as long "
        "as a car"
    ),
    "on_tail": lambda _, height, length: (
        f"taller ({metres(height)}) than long ({metres(length)}): does it stand on its tail?"
    ),
    "on_side": lambda _: (
        "its left half mirrors its right one from top to bottom: does it lie on its side?"
    ),
    "on_roof": lambda _: "its wheels are on top: does it lie on its roof?",
    "faces": _faces,
    "height": lambda _, bottom: (
        f"it stands {metres(-bottom)} deep in the ground, z = 0"
        if bottom < 0.0
        else f"it floats {metres(bottom)} above the ground, z = 0"
    ),
    "not_centred": _not_centred,
    "missing": lambda _, names, path: f"{', '.join(names)} is missing: there is no {path}",
    "driver": lambda part, paths, is_allowed: (
        f"{f'{part}: ' if part else ''}the driver of its {', '.join(paths)} did not run"
        + ("" if is_allowed else ": Python in drivers is not allowed in this file")
    ),
    "units": lambda _: "one unit is not one metre in this scene: nothing can be scored",
    "hidden_vehicle": lambda _, collection, how, is_whole: (
        f"the vehicle collection {collection} is {how}: nothing of it is scored"
        if is_whole
        else f"the vehicle's collection {collection} is {how}: it is not scored"
    ),
    "instanced_sensors": lambda _, names, collection: (
        f"{', '.join(names)}: in the instanced collection {collection}, so not scored; make the "
        "instance real (Object > Apply)"
    ),
    "refused": lambda _, field, found, expected: f"its {field} is {found}; expected {expected}",
}  # How warnings are said, by code: of the part of the vehicle and the warning's values


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
    """Say a margin: "0.42 m", "fails in the outer 0.15 m", "blind 0.40 m2, at least 0.30 m". `noun`
    stands before the margin of a requirement that is met."""
    parts = [] if verdict.blind_m2 is None else [f"blind {verdict.blind_m2:.2f} m2"]
    if verdict.margin_m is not None:
        at_least = "at least " if verdict.margin_at_least else ""
        grows = f"{noun}{at_least}{verdict.margin_m:.2f} m"
        fails = f"{-verdict.margin_m:.2f} m"
        parts.append(grows if verdict.met else f"fails in the outer {fails}")
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
