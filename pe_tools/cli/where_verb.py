"""`pe where`: one more sensor scored all over the vehicle's surface."""

import argparse

from pe_core import catalog
from pe_core.base import dump_json
from pe_core.base.errors import plural
from pe_core.base.files import csv_text
from pe_core.base.table_reader import finite
from pe_core.scene.rig import Sensor
from pe_core.sensors import kind_of
from pe_core.study import Study

from ..jobs import APART_M, BEST, PLACE_FIGURES, PlaceMap, WhereJob
from ..wording import aligned
from .command import add_curve_option, count_up_to, with_curves
from .interrupts import Interrupted, stop_at_first
from .run_job import drive, output_file, print_vehicle, save_text
from .terminal import DONE, Answer


def add_where_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``where`` to a parser."""
    add = parser.add_argument
    add("--model", required=True, metavar="NAME", help="the sensor's model (pe sensors lists them)")
    where = parser.add_mutually_exclusive_group()
    about = "a part of the vehicle, in place of all; any number"
    where.add_argument("--part", action="append", default=[], metavar="NAME", help=about)
    about = "a mount of the study: its surface, stand-off and orientation"
    where.add_argument("--mount", default="", metavar="NAME", help=about)
    add("--figure", choices=PLACE_FIGURES, default="entropy", metavar="|".join(PLACE_FIGURES))
    counts = ", ".join(f"{key} {row.places:,}" for key, row in PLACE_FIGURES.items())
    add("--places", type=count_up_to(20_000, 1), metavar="N", help=f"how many ({counts})")
    add("--workers", type=count_up_to(1024), metavar="N", help="processes (default: all)")
    add("--json", action="store_true", help="print JSON")
    add("-o", "--output", metavar="FILE", help="write all places to a CSV file")
    add("--replace", action="store_true", help="replace a file that is there")
    add_curve_option(parser)


def where(study: Study, args: argparse.Namespace) -> Answer:
    """Score one more sensor all over the vehicle's surface, and tell the best places."""
    table = output_file(args.output, args)
    study = with_curves(study, args)
    models = {each.model.name: each.model for each in study.rig}
    model = models.get(args.model) or catalog.load(args.model)
    options = {"parts": tuple(args.part), "mount": args.mount, "count": args.places}
    sensor = Sensor(kind_of(model).label, model)
    job = WhereJob(study, sensor, args.figure, **options, workers=args.workers)
    print_vehicle(study)
    with stop_at_first(job.stop) as received:
        drive(job)
    if (found := job.found) is None:
        raise Interrupted(received.signum or 2, "no place was scored")
    rows = found.rows()
    cells = ([v if v is not None else "" for v in row.values()] for row in rows)
    unwritten = save_text(table, csv_text([[*rows[0]], *cells]))
    text = dump_json(finite(found.to_dict())) if args.json else "\n".join(place_lines(found))
    return text, unwritten or received.status(DONE)


def place_lines(found: PlaceMap) -> list[str]:
    """Return the best places as a table, with what is forbidden and how sure the figures are."""
    row, name = found.row, found.row.figure.name
    rows = [["position [m]", "yaw [deg]", name, "change"]]
    for place in found.best(BEST, APART_M):
        value = place.value or 0.0
        at = ", ".join(f"{v:.3f}" for v in place.pose.position)
        figures = row.figure.text(value), row.change(value - found.base)
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
