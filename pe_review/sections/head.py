"""The head of the page: what was asked, what came out, in three lines."""

from __future__ import annotations

from ..markup import escaped
from ..reviewed import Reviewed
from ..section import Section


def head(each: tuple[Reviewed, ...]) -> Section:
    """Return the head."""
    lines = "".join(f"<p>{escaped(_line(one))}</p>" for one in each)
    names = "".join(f"<li>{escaped(s.name)}</li>" for one in each for s in one.rig)
    return Section("summary", "Summary", f"{lines}<ul>{names}</ul>")


def _line(one: Reviewed) -> str:
    score = one.after
    return f"{one.name}: entropy {score.entropy:.3f} nats, {score.coverage:.1%} seen"
