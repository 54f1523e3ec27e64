"""Warnings, and the score in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..engine import advice, pe
from ..markup import escaped
from ..reviewed import Reviewed
from ..section import Section


def told(one: Reviewed) -> Section:
    """Return what is odd about the study, and what its score says in words."""
    warned = "".join(_warning(each) for each in one.warnings)
    odd = warned or "<p>Nothing odd was found about vehicle and mounting.</p>"
    said = advice.words(one.after, one.rig, one.vehicle, one.outlook, one.warnings)
    inside = f"{_simplified(one)}{odd}<h3>In words</h3>{''.join(_lines(said))}"
    return Section("advice", "What to look at", inside)


def _warning(each: pe.Advice) -> str:
    who, text = each.line[: -len(each.text)], each.text
    return f'<p class="warned"><b>{escaped(who)}</b>{escaped(text)}</p>'


def _simplified(one: Reviewed) -> str:
    shown, error = one.shown_vehicle
    if shown is None or one.vehicle is None or shown is one.vehicle:
        return ""
    return (
        f'<p class="note">Beams were cast at all {len(one.vehicle.triangles):,} triangles of the '
        f"vehicle. This page draws {len(shown.triangles):,} of them; no point of its surface is "
        f"more than {1000.0 * error:.0f} mm off.</p>"
    )


def _lines(said: Sequence[str]) -> Iterator[str]:
    """Yield a list; lines that go on about a sensor stand below it."""
    yield '<ul class="plain">'
    below = False
    for number, line in enumerate(said):
        if line.startswith(" "):
            yield "" if below else "<ul>"
            below = True
        elif number:
            yield f"{'</ul>' if below else ''}</li>"
            below = False
        yield f"<li>{escaped(line.strip())}{'</li>' if below else ''}"
    yield f"{'</ul>' if below else ''}{'</li>' if said else ''}</ul>"
