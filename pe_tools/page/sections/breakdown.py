"""The score by class and by zone, and for objects: AP, points and reach by class."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import pe_core as pe

from ... import advice
from ..markup import capitalized, coverage_bar, entropy_bar, escaped, number, percent, signed, table
from ..report_context import ReportContext, Section

PART_HEADS = ("share of objects", "coverage", "entropy [nats]")


def by_class_and_zone(context: ReportContext) -> Section:
    """Return coverage and entropy of every class and zone, with the values before a search.

    On a page of several studies that were only scored, the comparison contains these values.
    """
    if context.study_count > 1 and not context.was_searched:
        return Section("parts", "By class and zone", "")
    before, after = context.before, context.after
    tables = [
        _part_table(context, "Class", before.per_class, after.per_class),
        _part_table(context, "Zone", before.per_zone, after.per_zone),
    ]
    bars = "The bar of entropy is full for an unseen part and empty for the best possible value"
    tick = "; the dark tick marks the value before the search" if context.was_searched else ""
    zones = "Zones overlap: halves of the ground, and rings around the vehicle."
    inside = f'{"".join(tables)}<p class="note">{bars}{tick}. {zones}</p>'
    return Section("parts", "By class and zone", inside)


def _part_table(
    context: ReportContext,
    title: str,
    before: Mapping[str, pe.PartScore],
    after: Mapping[str, pe.PartScore],
) -> str:
    heads = [title, *PART_HEADS, *(["change"] if context.was_searched else [])]
    caption = f"{title}: coverage and entropy"
    return table(caption, heads, _part_rows(context, before, after))


def _part_rows(
    context: ReportContext, before: Mapping[str, pe.PartScore], after: Mapping[str, pe.PartScore]
) -> Iterator[list[str]]:
    for name, part in after.items():
        was = before.get(name) if context.was_searched else None
        yield [
            capitalized(advice.WHERE.get(name, name)),
            percent(part.share, 1),
            coverage_bar(part.coverage, was.coverage if was else None),
            entropy_bar(part.entropy, was.entropy if was else None),
            *([signed(part.entropy - was.entropy)] if was else []),
        ]


def objects(context: ReportContext) -> Section:
    """Return AP, points and reach by class of a study scored on objects; else nothing."""
    score = context.after.objects
    if score is None:
        return Section("objects", "Objects", "")
    sample = advice.objects_looked_at(score)
    error = f"{number(score.ap_stderr, 3)}"
    brief = f"Expected AP {number(score.ap, 3)}, standard error {error}, on {sample}."
    tables = f"{_class_table(score)}{_reach_table(score)}"
    return Section("objects", "Objects", f"<p>{escaped(brief)}</p>{tables}")


def _class_table(score: pe.ObjectScore) -> str:
    thresholds = next(iter(score.per_class.values())).points if score.per_class else {}
    heads = ["", "AP", "Standard error", *(f"{n} points or more" for n in thresholds)]
    rows = [
        [
            capitalized(name),
            number(of_class.ap, 3),
            number(of_class.ap_stderr, 3),
            *(percent(share, 1) for share in of_class.points.values()),
        ]
        for name, of_class in score.per_class.items()
    ]
    return table("Expected AP, and the share of objects with at least so many points", heads, rows)


def _reach_table(score: pe.ObjectScore) -> str:
    classes = score.per_class
    heads = ["", *map(capitalized, classes)]
    directions = next(iter(classes.values())).reach if classes else {}
    rows = [
        [
            capitalized(direction),
            *(advice.lone_reach(of_class.reach[direction]) for of_class in classes.values()),
        ]
        for direction in directions
    ]
    return table("Reach: distance up to which a lone object has AP 0.5 or more", heads, rows)
