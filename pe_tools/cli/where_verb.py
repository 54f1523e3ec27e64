"""`pe where`: one more sensor scored all over the vehicle's surface."""

import argparse

from pe_core import catalog
from pe_core.base.errors import plural
from pe_core.base.files import csv_text
from pe_core.scene.rig import Sensor
from pe_core.sensors import kind_of
from pe_core.study import Study

from ..jobs import APART_M, BEST, PlaceMap, WhereJob
from ..wording import aligned
from .answers import WhereAnswer
from .interrupts import Interrupted, stop_at_first
from .run_job import drive, output_file, print_vehicle, save_text
from .study_source import StudyFiles
from .terminal import DONE, Answer, answered


def where(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Score one more sensor all over the vehicle's surface, and tell the best places."""
    return where_study(source.study(args), args)


def where_study(study: Study, args: argparse.Namespace) -> Answer:
    """Score one more sensor all over the vehicle's surface of a study."""
    table = output_file(args.output, args)
    models = {each.model.name: each.model for each in study.rig}
    model = models.get(args.model) or catalog.load(args.model)
    job = WhereJob(
        study,
        Sensor(kind_of(model).label, model),
        args.figure,
        parts=tuple(args.part),
        mount=args.mount,
        count=args.places,
        workers=args.workers,
    )
    print_vehicle(study)
    with stop_at_first(job.stop) as received:
        drive(job)
    if (found := job.found) is None:
        raise Interrupted(received.signum or 2, "no place was scored")
    rows = found.rows()
    cells = ([v if v is not None else "" for v in row.values()] for row in rows)
    unwritten = save_text(table, csv_text([[*rows[0]], *cells]))
    places = WhereAnswer(**found.to_dict())
    text = answered(args, places, place_lines(found))
    return text, unwritten or received.status(DONE)


def place_lines(found: PlaceMap) -> list[str]:
    """Return the best places as a table, with what is forbidden and how sure the figures are."""
    row = found.row
    name = found.row.figure.name
    rows = [["position [m]", "yaw [deg]", name, "change"]]
    for place in found.best(BEST, APART_M):
        value = place.value or 0.0
        at = ", ".join(f"{v:.3f}" for v in place.pose.position)
        figures = row.figure.text(value), found.change(value)
        rows.append([f"({at})", f"{place.pose.rotation_deg[2]:.0f}", *figures])
    free = sum(each.value is not None for each in found.places)
    head = f"{found.sensor.model.name} at {free:,} of {len(found.places):,} places"
    lines = [f"{head}; without it {name} {row.figure.text(found.base)}", *aligned(rows)]
    lines += [f"{plural(n, 'place')} forbidden: {why}" for why, n in found.reasons().items()]
    if found.error:
        lines.append(
            f"standard error of a change: {row.figure.text(found.error)}, less at these places"
        )
    return lines
