"""`pe sensors`: the catalogue, one of its entries, and the AP curves of whole objects."""

import argparse
from collections.abc import Iterator
from itertools import groupby

from pe_core import catalog
from pe_core.sensors import CURVE_MODELS, KINDS, curve_source, detectors, fitted_curves, kind_of

from .answers import CatalogAnswer, CatalogRow, CurveRow, CurvesAnswer, SensorAnswer
from .study_source import StudyFiles
from .terminal import DONE, Answer, answered


def show_sensors(_: StudyFiles, args: argparse.Namespace) -> Answer:
    """List the catalogue, or the AP curves by model; or show one sensor with its channels."""
    if args.curves:
        return answered(args, CurvesAnswer(tuple(_curves())), _curve_lines()), DONE
    if not args.name:
        rows = tuple(map(_row, catalog.entries().values()))
        return answered(args, CatalogAnswer(rows), (f"{e.kind:7} {e.name}" for e in rows)), DONE
    model = catalog.load(args.name)
    kind = kind_of(model)
    plot = kind.plot(model)
    entry = catalog.entries()[args.name]
    sheet = tuple(kind.data_sheet(model))
    lines = [args.name, *sheet, f"source          {entry.source}"]
    shown = SensorAnswer(_row(entry), entry.table, sheet)
    return answered(args, shown, [*lines, *(["", *plot] if plot else [])]), DONE


def _row(entry: catalog.Entry) -> CatalogRow:
    return CatalogRow(entry.name, entry.kind, entry.source)


def _curves() -> Iterator[CurveRow]:
    """Yield the AP curves of whole objects; a model without its own has the kinds'."""
    own = {kind.name: kind.object_curves for kind in KINDS.values() if kind.curve.a > 0.0}
    for name in CURVE_MODELS:
        for kind, curves in (fitted_curves(name) or own).items():
            for each, curve in curves.items():
                yield CurveRow(name, kind, each, a=curve.a, b=curve.b, source=curve_source(name))


def _curve_lines() -> list[str]:
    """Return the AP curves of whole objects by model, and where they hold."""
    lines = ["AP = a ln m + b, m: of an object; --set ap.model=NAME"]
    for name, curves in groupby(_curves(), key=lambda curve: curve.model):
        lines += ["", f"{name}: {curve_source(name)}"]
        rows = detectors()[name].rows if name in detectors() else {}
        for each in curves:
            line = f"  {each.kind:11} {each.of_class:11}a {each.a:6.4f}  b {each.b:+7.4f}"
            if row := rows.get(each.kind, {}).get(each.of_class):
                line += f"  RMSE {row.rmse:.3f}, m {row.m[0]:g} to {row.m[1]:g}"
                if row.a_interval is not None:
                    low, high = row.a_interval
                    line += f", a {low:.3f} to {high:.3f} (95 %)"
            lines.append(line)
    return lines
