"""By class and by zone: bars with figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..bars import coverage_bar, entropy_bar
from ..engine import advice, pe
from ..figures import change, percent, up_first
from ..markup import table
from ..reviewed import Reviewed
from ..section import Section

HEADS = ("share of all", "seen", "entropy [nats]")


def parts(one: Reviewed) -> Section:
    """Return coverage and entropy of every class and zone, with those before a search.

    Of several studies the comparison has those of the scores, in one table.
    """
    if one.beside > 1 and not one.searched:
        return Section("parts", "By class and zone", "")
    tables = [
        _table(one, "What is looked for", one.before.per_class, one.after.per_class),
        _table(one, "Where it is", one.before.per_zone, one.after.per_zone),
    ]
    note = "A full bar of entropy is blind, an empty one the best there is"
    tick = "; the dark tick is where it was before the search" if one.searched else ""
    zones = "Zones overlap: halves of the ground, and rings round the vehicle."
    inside = f'{"".join(tables)}<p class="note">{note}{tick}. {zones}</p>'
    return Section("parts", "By class and zone", inside)


def _table(
    one: Reviewed,
    title: str,
    before: Mapping[str, pe.PartScore],
    after: Mapping[str, pe.PartScore],
) -> str:
    heads = [title, *HEADS, *(["change"] if one.searched else [])]
    return table(f"{title}: how much is seen, and how well", heads, _rows(one, before, after))


def _rows(
    one: Reviewed, before: Mapping[str, pe.PartScore], after: Mapping[str, pe.PartScore]
) -> Iterator[list[str]]:
    for name, part in after.items():
        was = before.get(name) if one.searched else None
        yield [
            up_first(advice.WHERE.get(name, name)),
            percent(part.share),
            coverage_bar(part.coverage, was.coverage if was else None),
            entropy_bar(part.entropy, was.entropy if was else None),
            *([change(part.entropy - was.entropy)] if was else []),
        ]
