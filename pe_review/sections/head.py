"""The head of the page: what was asked, what came out, in three lines; the figures; the picture."""

from __future__ import annotations

from dataclasses import replace

from ..engine import advice, kinds, metric, sight
from ..figures import ARROW, change, count, joined, number, percent, percent_points, up_first
from ..markup import Markup, escaped, picture
from ..pictures.of_reviewed import named_still_of
from ..pictures.svg import STYLE
from ..reviewed import Reviewed
from ..section import Section

SIDES = {"front": "ahead", "rear": "behind", "left": "left", "right": "right"}


def head(each: tuple[Reviewed, ...]) -> Section:
    """Return the head of the page of one study; several have a head of their own."""
    if len(each) > 1:
        return Section("summary", "Summary", "")
    one = each[0]
    lines = (("Asked", asked(one)), ("Found", found(one)), ("Mind", to_mind(one)))
    brief = "".join(f"<li><b>{what}:</b> {line}</li>" for what, line in lines if line)
    inside = f'<ul class="brief">{brief}</ul>{_tiles(one)}{_picture(one)}{_scale()}'
    return Section("summary", "Summary", inside, styles=(STYLE,))


def asked(one: Reviewed) -> Markup:
    """Say what was asked: which sensors on what, where, and whether better places were sought."""
    space, prior = one.found.space, one.found.prior
    names = joined([f"a {escaped(name)}" for name in prior.class_names])
    where = f"{_span(space.x)} m ahead and behind, {_span(space.y)} m to the sides"
    end = ", and whether there are better places for them" if one.searched else ""
    return Markup(f"What {_sensors(one)} on {_vehicle(one)} see of {names}, {where}{end}.")


def found(one: Reviewed) -> Markup:
    """Say what came out."""
    after, before = one.after, one.before
    zones = sorted(after.per_zone, key=lambda zone: after.per_zone[zone].entropy)
    best, worst = (advice.WHERE.get(zones[k], zones[k]) for k in (0, -1))
    places = f" It sees best {best}, worst {worst}." if zones else ""
    if not one.searched:
        line = (
            f"{percent(after.coverage)} of where they are is seen, at {number(after.entropy)} nats"
        )
        return Markup(f"{line} of perception entropy (lower is better).{places}")
    gain = before.entropy - after.entropy
    if gain <= 0.0:
        return Markup(f"No better place was found than {number(after.entropy)} nats.{places}")
    moved = sum(a.pose != b.pose for a, b in zip(one.asked.rig, one.rig, strict=True))
    return Markup(
        f"Moving {count(moved, 'sensor')} lowers perception entropy by {number(gain)} nats to "
        f"{number(after.entropy)} (lower is better); {percent(after.coverage)} of where they are "
        f"is seen, {percent_points(after.coverage - before.coverage)}.{places}"
    )


def to_mind(one: Reviewed) -> Markup:
    """Say what to keep in mind: hidden sensors, blind ground, the costliest loss, warnings."""
    said = [*hidden(one), _blind(one), _dearest(one), _warned(one)]
    return Markup(" ".join(f"{_begun(text)}." for text in said if text))


def hidden(one: Reviewed) -> tuple[str, ...]:
    """Name the sensors that see nothing or are mostly hidden."""
    found = advice.hidden_sensors(one.rig, one.after, one.warnings)
    named = [
        replace(each, name=f"<b>{escaped(each.name)}</b>", why=escaped(each.why)) for each in found
    ]
    return advice.hidden_words(named)


def _begun(text: str) -> str:
    """Return the text of a sentence; a name at its beginning stays as it is written."""
    return text if text.startswith("<") else up_first(text)


def _blind(one: Reviewed) -> str:
    blind = one.outlook.blind
    ends = {side: blind.zone[side] for side in SIDES if blind.zone[side] != 0.0}
    what = f"what is {blind.height:g} m tall"
    if not ends:
        return f"{what} is seen all round the body"
    ways = [
        f"beyond {blind.within:g} m {SIDES[s]}"
        if end is None
        else f"{number(sight.shown_end(end), 1)} m {SIDES[s]}"
        for s, end in ends.items()
    ]
    return f"{what} is hidden from the body to {joined(ways)}"


def _dearest(one: Reviewed) -> str:
    scores = one.after.per_sensor
    if len(scores) < 2:
        return "it is the only sensor, so nothing is seen when it fails"
    name = max(scores, key=lambda name: scores[name].lost)
    lost = number(scores[name].lost)
    return f"when <b>{escaped(name)}</b> fails most is lost, {lost} nats"


def _warned(one: Reviewed) -> str:
    if not one.warnings:
        return ""
    return f'<a href="#advice">{count(len(one.warnings), "warning")}</a>'


def _sensors(one: Reviewed) -> str:
    """Return "2 LiDARs and 1 camera", by the rig's kinds."""
    of_kind = [kinds.kind_of(sensor) for sensor in one.rig]
    named = []
    for kind in dict.fromkeys(of_kind):
        word = kind.label if of_kind.count(kind) == 1 else kind.plural
        named.append(f"{of_kind.count(kind)} {word.lower() if word.istitle() else word}")
    return escaped(joined(named))


def _vehicle(one: Reviewed) -> str:
    vehicle = one.vehicle
    if vehicle is None:
        return "no vehicle, so that nothing hides anything,"
    size = vehicle.bounds[1] - vehicle.bounds[0]
    name = (one.found.mesh or "a vehicle").replace("\\", "/").rpartition("/")[2]
    return f"{escaped(name)} ({' × '.join(number(side) for side in size.tolist())} m)"


def _span(bounds: tuple[float, float]) -> str:
    low, high = bounds
    return f"{high:g}" if low == -high else f"{number(low, 0)} to {number(high, 0)}"


def _tiles(one: Reviewed) -> str:
    before, after = one.before, one.after
    gained = after.coverage - before.coverage
    tiles = [
        _tile("Perception entropy", number(after.entropy), "nats", _entropy_was(one)),
        _tile("Seen of where objects are", percent(after.coverage), "", _than(one, gained)),
        _tile("Blind at the body, 0.5 m tall", *_farthest(one)),
        _tile("Worst loss of one sensor", *_worst_loss(one)),
    ]
    return f'<dl class="tiles">{"".join(tiles)}</dl>'


def _tile(what: str, figure: str, unit: str, below: str) -> str:
    unit = f" <small>{unit}</small>" if unit else ""
    return (
        f'<div><dt>{what}</dt><dd class="large">{figure}{unit}</dd>'
        f'<dd class="than">{below}</dd></div>'
    )


def _entropy_was(one: Reviewed) -> str:
    if not one.searched:
        error = f" ± {number(one.after.stderr, 3)}" if one.after.stderr else ""
        return f"lower is better{error}"
    gain = one.after.entropy - one.before.entropy
    return f"{number(one.before.entropy)} {ARROW} {number(one.after.entropy)}, {change(gain)}"


def _than(one: Reviewed, gained: float) -> str:
    if not one.searched:
        return "by at least one sensor"
    return f"{percent(one.before.coverage)} before, {percent_points(gained)}"


def _farthest(one: Reviewed) -> tuple[str, str, str]:
    zone = one.outlook.blind.zone
    away = {side: float("inf") if end is None else end for side, end in zone.items()}
    side = max(away, key=lambda side: away[side])
    if away[side] == 0.0:
        return "none", "", "all round, within 10 m"
    end = zone[side]
    figure = "&gt; 10" if end is None else number(sight.shown_end(end), 1)
    return figure, "m", f"{SIDES[side]}, the farthest"


def _worst_loss(one: Reviewed) -> tuple[str, str, str]:
    scores = one.after.per_sensor
    name = max(scores, key=lambda name: scores[name].lost)
    return change(scores[name].lost), "nats", escaped(name)


def _picture(one: Reviewed) -> str:
    if one.picture is None:
        return named_still_of(one, f"The vehicle with {_sensors(one)}")
    return picture(one.picture, f"The vehicle with {_sensors(one)} and what they see")


def _scale() -> str:
    return (
        '<p class="note">Perception entropy is how uncertain a detector is of what is there, '
        "averaged over the places where objects are expected. What nobody sees has "
        f"{number(metric.H_BLIND, 1)} nats, what is seen best {number(metric.H_BEST, 1)}. "
        "One nat is a factor of about 1.6 in the detector's spread.</p>"
    )
