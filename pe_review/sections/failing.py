"""When one sensor fails."""

from __future__ import annotations

from ..bars import bar
from ..engine import advice
from ..failing import Failure, failures
from ..figures import change, percent
from ..markup import Markup, escaped, table
from ..reviewed import Reviewed
from ..section import Section

HEADS = ("without", "entropy rises by [nats]", "no longer seen", "hurts most")


def failing(one: Reviewed) -> Section:
    """Return what the loss of each sensor costs."""
    lost = failures(one)
    if not lost:
        text = "There is one sensor: when it fails, nothing is seen."
        return Section("failing", "When one fails", f"<p>{text}</p>")
    most = max(max(failure.rise for failure in lost), 1e-9)
    rows = [_row(failure, most) for failure in lost]
    inside = f"<p>{_words(lost)}</p>{table('The rig without each sensor', HEADS, rows)}"
    return Section("failing", "When one fails", inside)


def _words(lost: tuple[Failure, ...]) -> str:
    first, last = lost[0], lost[-1]
    where = f", most of all {advice.WHERE.get(first.zone, first.zone)}" if first.zone else ""
    line = (
        f"Dearest is <b>{escaped(first.sensor)}</b>: without it entropy rises by "
        f"{change(first.rise)} nats{where}."
    )
    if first is last:
        return line
    return f"{line} Least is lost with <b>{escaped(last.sensor)}</b>, {change(last.rise)} nats."


def _row(failure: Failure, most: float) -> list[str]:
    where = advice.WHERE.get(failure.zone, failure.zone)
    hurts = f"{where} ({change(failure.zone_rise)} nats)" if failure.zone else "nowhere"
    risen: Markup = bar(change(failure.rise), failure.rise / most)
    return [failure.sensor, risen, percent(max(failure.uncovered, 0.0)), hurts]
