"""`pe sensors`: the catalogue, one of its entries, and the AP curves of whole objects."""

import argparse

from pe_core import catalog
from pe_core.sensors import CURVE_MODELS, KINDS, curve_source, detectors, fitted_curves, kind_of

from .study_source import StudyFiles
from .terminal import DONE, Answer


def show_sensors(_: StudyFiles, args: argparse.Namespace) -> Answer:
    """List the catalogue, or the AP curves by model; or show one sensor with its channels."""
    if args.curves:
        return "\n".join(_curve_lines()), DONE
    if not args.name:
        return "\n".join(f"{e.kind:7} {e.name}" for e in catalog.entries().values()), DONE
    model = catalog.load(args.name)
    kind = kind_of(model)
    plot = kind.plot(model)
    lines = [args.name, *kind.data_sheet(model)]
    lines.append(f"source          {catalog.entries()[args.name].source}")
    return "\n".join([*lines, *(["", *plot] if plot else [])]), DONE


def _curve_lines() -> list[str]:
    """Return the AP curves of whole objects by model, and where they hold."""
    lines = ["AP = a ln m + b, m: of an object; --set ap.model=NAME"]
    own = {kind.name: kind.object_curves for kind in KINDS.values() if kind.curve.a > 0.0}
    for name in CURVE_MODELS:
        lines += ["", f"{name}: {curve_source(name)}"]
        rows = detectors()[name].rows if name in detectors() else {}
        for kind, curves in (fitted_curves(name) or own).items():
            for each, curve in curves.items():
                line = f"  {kind:11} {each:11}a {curve.a:6.4f}  b {curve.b:+7.4f}"
                if row := rows.get(kind, {}).get(each):
                    line += f"  RMSE {row.rmse:.3f}, m {row.m[0]:g} to {row.m[1]:g}"
                lines.append(line)
    return lines
