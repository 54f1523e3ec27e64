"""Build pages: for the verb ``review``, for studies in memory, and beside the results of a search.
A folder of search results is read back to the outcome that the search had."""

import argparse
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import pe_core as pe
from pe_core import base as text
from pe_core import search
from pe_core import study as studies
from pe_core.search.goals import HIGHER_IS_BETTER, OBJECTIVES, label_of

from .. import advice, jobs
from .. import cli as app
from ..sensitivity import sensitivity_from_dict
from .document import PAGE, html_file, page_bytes, write_page
from .markup import capitalized, render
from .pictures.charts import four_digits, pareto_plot
from .report_context import MAX_STUDIES, About, ReportContext

INTERRUPTED = "no page was written"
OWN_VERSIONS = ("perception-entropy", "numpy", "python")
"""Programs whose versions the page lists by itself."""
A_RESULT = "the result of a search by this version"
MAX_RESULT_BYTES = 1 << 28  # Size limit of a result.json that is read
DesignRow = Mapping[str, Any]
BELOW = "; the figures are in the table below"


@app.noted_when_interrupted(INTERRUPTED)
def review(args: argparse.Namespace) -> app.Answer:
    """Score studies and write their page; after Ctrl-C nothing is written."""
    paths = [str(Path(path).resolve()) if Path(path).is_dir() else path for path in args.studies]
    files = app.named_by_file(paths)
    folders = {name: Path(path) for name, path in files.items() if Path(path).is_dir()}

    def score(study: pe.Study) -> jobs.Outcome:
        return app.scored(app.with_options(study, args), args.workers)

    def context_of(name: str, study: pe.Study) -> ReportContext:
        outcome = outcome_of_folder(folders[name], score) if name in folders else None
        if outcome is None:
            scored = app.scored(study, args.workers)
            return ReportContext(name, scored, command=args.command_line)
        return ReportContext(name, outcome, command=command_of_folder(folders[name]))

    studies_of = {
        name: pe.load_study(Path(path) / studies.STUDY if name in folders else path)
        for name, path in files.items()
    }
    return _write(studies_of, context_of, args)


@app.noted_when_interrupted(INTERRUPTED)
def review_studies(
    by_name: Mapping[str, pe.Study],
    args: argparse.Namespace,
    versions: Mapping[str, str] | None = None,
) -> app.Answer:
    """Score studies by name and write their page. `args` are parsed options of `add_review_options`
    and of a score; `versions` are those of programs besides the engine's, by name."""

    def context_of(name: str, study: pe.Study) -> ReportContext:
        outcome = app.scored(study, args.workers)
        return ReportContext(name, outcome, command=args.command_line, versions=versions or {})

    return _write(by_name, context_of, args)


def _write(
    by_name: Mapping[str, pe.Study],
    context_of: Callable[[str, pe.Study], ReportContext],
    args: argparse.Namespace,
) -> app.Answer:
    """Score the studies and write their page; what is refused is refused before the work."""
    if len(by_name) > MAX_STUDIES:
        raise pe.InputError("command line", "STUDY", f"{MAX_STUDIES} at most", len(by_name))
    requested = {name: app.with_options(study, args) for name, study in by_name.items()}
    app.refuse_different(requested)
    about = About(args.title, args.author, args.date, args.revision)
    jobs.prepare_folder(args.output, () if args.replace else (PAGE,))
    folder = Path(args.output)
    found = (context_of(name, study) for name, study in requested.items())
    contexts = [replace(context, folder=folder) for context in found]
    path = write_page(contexts, args.output, replace=args.replace, about=about)
    return str(path), app.DONE


def write_search_page(outcome: jobs.Outcome, data: dict[str, Any], folder: Path) -> None:
    """Write the page of a search beside its results."""
    host = {k: v for k, v in data["run"]["versions"].items() if k not in OWN_VERSIONS}
    command = str(data["run"].get("command", ""))
    name = folder.resolve().name
    context = ReportContext(name, outcome, command=command, versions=host)
    jobs.add_to_result(data, folder, {PAGE: page_bytes([context])})


def outcome_of_folder(
    folder: Path, score: Callable[[pe.Study], jobs.Outcome]
) -> jobs.Outcome | None:
    """Return the outcome of the search in a folder; None if the folder contains no search. Start
    and end are scored again, because result.json does not contain all of a score; the history of
    the search is read from the file. A damaged file, or one of another version, raises
    `InputError`."""
    if not (folder / studies.SEARCH).exists() or not (folder / studies.RESULT).exists():
        return None
    checkpoint, path = jobs.read_search(folder), folder / studies.RESULT
    start = checkpoint.study
    best = start.with_rig(pe.load_study(folder / studies.STUDY).rig)
    try:
        result = _result_of(folder)
        figure = jobs.searched_figure(start)
        history = []
        for row in result["history"]:
            tables = [row["placements"][sensor.name] for sensor in start.rig]
            poses = [pe.Pose.from_degrees(table["position"], table["rotation"]) for table in tables]
            value = figure.to_figure(float(row[figure.key]))
            numbers = int(row["evaluation"]), int(row["round"])
            history.append(jobs.HistoryRow(*numbers, value, start.rig.with_poses(poses)))
        robustness = None
        if (table := result.get("robustness")) is not None:
            off = table["position"], math.radians(table["angle"])
            errors = search.Tolerance(*off, draws=table["draws"])
            stands = (search.RigRobustness(**table[which]) for which in ("before", "after"))
            robustness = search.Robustness(errors, int(table["samples"]), *stands)
        sure = sensitivity_from_dict(result.get("sensitivity"), start.rig)
        starts = tuple(
            jobs.StartEnd(
                str(table["name"]),
                figure.to_figure(float(table[figure.key])),
                int(table["evaluations"]),
            )
            for table in result.get("starts", ())
        )
        in_traffic = None
        if figure.higher_is_better and (table := result.get(figure.key)) is not None:
            from_dict = pe.ObjectScore.from_dict
            in_traffic = from_dict(table["before"]), from_dict(table["after"])
        reason, scatter = str(result.get("stop_reason") or ""), result.get("seed_scatter")
        warnings = tuple(
            replace(advice.Advice(**table), amount=tuple(table["amount"]))
            for table in result["warnings"]
        )
        figures = None
        if (table := result.get("figures")) is not None:
            told = [advice.KeyFigures.from_dict(table[which]) for which in ("before", "after")]
            figures = told[0], told[1]
        evaluations, stopped = int(result["evaluations"]), bool(result["stopped"])
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, pe.InputError):
            raise
        raise pe.InputError(path, "file", A_RESULT, "another file") from None
    first = score(start)
    last = first if best.rig == start.rig else score(best)
    scores = first.after, last.after
    return jobs.Outcome(
        "optimize",
        *(start, best, *scores, tuple(history), evaluations, stopped, 0.0, warnings),
        inputs=checkpoint.inputs,
        evaluated=checkpoint.evaluated,
        robustness=robustness,
        verdicts=last.verdicts,
        conditions=last.conditions,
        sensitivity=sure,
        starts=starts,
        stop_reason=reason,
        seed_scatter=None if scatter is None else float(scatter),
        in_traffic=in_traffic,
        figures=figures,
    )


def command_of_folder(folder: Path) -> str:
    """Return the command line that produced a folder of results; empty if it is not recorded."""
    run = _result_of(folder).get("run")
    return str(run.get("command", "")) if isinstance(run, dict) else ""


def _result_of(folder: Path) -> dict[str, Any]:
    path = folder / studies.RESULT
    result = text.parse_json(path, text.read_bytes(path, MAX_RESULT_BYTES))
    if not isinstance(result, dict):
        raise pe.InputError(path, "file", A_RESULT, "another file")
    return result


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
    columns = [*names, *(name for name in OBJECTIVES if name in shared and name not in names)]
    values = {name: [_figure(design, name) or 0.0 for design in front] for name in columns}
    best = {name: (max if name in HIGHER_IS_BETTER else min)(values[name]) for name in columns}
    labels = {}
    for name in columns:
        label, unit = label_of(name)
        unit = unit or (str(data.get("currency") or "") if name == "price" else "")
        better = "higher is better" if name in HIGHER_IS_BETTER else "lower is better"
        labels[name] = f"{label} [{unit}], {better}" if unit else f"{label}, {better}"
    with_requirements = any("requirements_met" in design for design in front)
    heads = ["design", *(labels[name].split(",")[0] for name in columns)]
    titles = [capitalized(label_of(name)[0]) for name in names]
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
                f"{label_of(x)[0]} against {label_of(y)[0]}{BELOW}",
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
