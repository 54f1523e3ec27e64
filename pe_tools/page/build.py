"""Build pages: for the verb ``review``, for studies in memory, beside the results of a search."""

import argparse
from collections.abc import Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

import pe_core as pe
from pe_core.search import FIGURES, figure_of

from .. import cli as app
from .. import jobs
from .document import PAGE, html_file, page_bytes, write_page
from .markup import render
from .pictures.charts import four_digits, pareto_plot
from .report_context import MAX_STUDIES, About, ReportContext

INTERRUPTED = "no page was written"
OWN_VERSIONS = ("perception-entropy", "numpy", "python")
"""Programs whose versions the page lists by itself."""
DesignRow = Mapping[str, Any]
BELOW = "; the figures are in the table below"


@app.noted_when_interrupted(INTERRUPTED)
def review_studies(
    by_name: Mapping[str, pe.Study],
    args: argparse.Namespace,
    versions: Mapping[str, str] | None = None,
) -> app.Answer:
    """Score studies by name and write their page; what is refused is refused before the work.
    `args` are the parsed options of the verb; `versions` are those of programs besides the
    engine's, by name."""
    if len(by_name) > MAX_STUDIES:
        raise pe.InputError("command line", "STUDY", f"{MAX_STUDIES} at most", len(by_name))
    app.refuse_different(by_name)
    about = About(args.title, args.author, args.date, args.revision)
    folder = jobs.prepare_folder(args.output, () if args.replace else (PAGE,))
    facts: dict[str, Any] = {"command": args.command_line, "versions": versions or {}}
    contexts = [
        ReportContext(
            name, app.scored(study, args.workers), folder=folder, **_asked(study, args), **facts
        )
        for name, study in by_name.items()
    ]
    path = write_page(contexts, args.output, replace=args.replace, about=about)
    return app.answered(args, app.FilesAnswer(written=(str(path),)), [str(path)]), app.DONE


def _asked(study: pe.Study, args: argparse.Namespace) -> dict[str, Any]:
    """Return what else is asked for: free regions of sensors, and a built rig."""
    own = [name for name in args.region if name in [sensor.name for sensor in study.rig]]
    regions = tuple(app.found_region(study, name, args.workers) for name in own)
    built = None if args.built is None else app.found_built(study, args, args.built)
    return {"regions": regions, "built": built}


def write_search_page(outcome: jobs.Outcome, data: dict[str, Any], folder: Path) -> None:
    """Write the page of a search beside its results."""
    host = {k: v for k, v in data["run"]["versions"].items() if k not in OWN_VERSIONS}
    command = str(data["run"].get("command", ""))
    name = folder.resolve().name
    context = ReportContext(name, outcome, command=command, versions=host)
    jobs.add_to_result(data, folder, {PAGE: page_bytes([context])})


def write_front_page(_front: jobs.TradeOff, data: Mapping[str, Any], folder: Path) -> None:
    """Write the page of a front beside its results."""
    with jobs.FileSet(folder) as files:
        files.add(jobs.FRONT_PAGE, front_page(data))


def front_page(data: Mapping[str, Any]) -> bytes:
    """Return the page of a front."""
    names = list(data["objectives"])
    designs = [d for d in data["designs"] if all(_figure(d, name) is not None for name in names)]
    front = [design for design in designs if design["on_front"]]
    others = [design for design in designs if not design["on_front"]]
    figures = [design["figures"] for design in front]
    shared = set(figures[0]).intersection(*figures) if figures else set()
    columns = [*names, *(name for name in FIGURES if name in shared and name not in names)]
    values = {name: [_figure(design, name) or 0.0 for design in front] for name in columns}
    rows = {name: figure_of(name, str(data.get("currency") or "")) for name in columns}
    best = {name: row.best(values[name]) for name, row in rows.items()}
    labels = {name: row.heading for name, row in rows.items()}
    with_requirements = any("requirements_met" in design for design in front)
    heads = ["design", *(row.title for row in rows.values())]
    titles = [figure_of(name).label for name in names]
    body = render(
        "front.html",
        labels=titles,
        front=front,
        stopped=data["stopped"],
        notes=data.get("notes", ()),
        plots=[
            pareto_plot(
                [(_figure(d, x) or 0.0, _figure(d, y) or 0.0) for d in front],
                [(_figure(d, x) or 0.0, _figure(d, y) or 0.0) for d in others],
                (labels[x], labels[y]),
                f"{rows[x].label} against {rows[y].name}{BELOW}",
            )
            for x, y in combinations(names, 2)
        ],
        heads=[*heads, *["requirements met"] * with_requirements],
        figures=[
            [(four_digits(values[n][k]), values[n][k] == best[n]) for n in columns]
            for k in range(len(front))
        ],
        with_requirements=with_requirements,
    )
    return html_file(f"Pareto front: {', '.join(titles)}", body)


def _figure(design: DesignRow, name: str) -> float | None:
    value = design["figures"].get(name)
    return None if value is None else float(value)
