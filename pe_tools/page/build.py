"""Build the page: for the verb ``review``, for studies in memory, and beside a search's results.

A folder of search results is read back to the outcome that the search had.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pe_core as pe
from pe_core import base as text
from pe_core import search
from pe_core import study as studies

from .. import cli as app
from .. import jobs
from ..sensitivity import sensitivity_from_dict
from .document import PAGE, page_bytes, write_page
from .report_context import MAX_STUDIES, About, ReportContext

INTERRUPTED = "no page was written"
OWN_VERSIONS = ("perception-entropy", "numpy", "python")
"""Programs whose versions the page lists by itself."""
A_RESULT = "the result of a search by this version"
MAX_RESULT_BYTES = 1 << 28
"""Size limit of a result.json that is read."""


def review(args: argparse.Namespace) -> app.Answer:
    """Score studies and write their page; after Ctrl-C nothing is written."""
    with app.noted_when_interrupted(INTERRUPTED):
        return _review(args)


def _review(args: argparse.Namespace) -> app.Answer:
    paths = [str(Path(path).resolve()) if Path(path).is_dir() else path for path in args.studies]
    files = app.named_by_file(paths)
    _check_count(len(files))
    requested = {name: app.with_options(_read_study(path), args) for name, path in files.items()}
    app.refuse_different(requested)
    _check_output(args)
    contexts = []
    for name, study in requested.items():
        outcome = _search_outcome(files[name], args) or app.scored(study, args.workers)
        was_searched = outcome.kind == "optimize"
        command = command_of_folder(Path(files[name])) if was_searched else args.command_line
        contexts.append(ReportContext(name, outcome, command=command))
    return _write(contexts, args)


def review_studies(
    by_name: Mapping[str, pe.Study],
    args: argparse.Namespace,
    versions: Mapping[str, str] | None = None,
) -> app.Answer:
    """Score studies by name and write their page.

    Parameters
    ----------
    by_name : mapping of str to Study
    args : Namespace
        Parsed options of `add_review_options` and of a score.
    versions : mapping of str, optional
        Versions of programs besides the engine's, by name.
    """
    with app.noted_when_interrupted(INTERRUPTED):
        return _review_studies(by_name, args, versions)


def _review_studies(
    by_name: Mapping[str, pe.Study],
    args: argparse.Namespace,
    versions: Mapping[str, str] | None,
) -> app.Answer:
    _check_count(len(by_name))
    requested = {name: app.with_options(study, args) for name, study in by_name.items()}
    app.refuse_different(requested)
    _check_output(args)
    contexts = []
    for name, study in requested.items():
        outcome = app.scored(study, args.workers)
        origin = {"command": args.command_line, "versions": versions or {}}
        contexts.append(ReportContext(name, outcome, **origin))
    return _write(contexts, args)


def write_search_page(outcome: pe.Outcome, data: dict[str, Any], folder: Path) -> None:
    """Write the page of a search beside its results."""
    host = {k: v for k, v in data["run"]["versions"].items() if k not in OWN_VERSIONS}
    command = str(data["run"].get("command", ""))
    name = folder.resolve().name
    context = ReportContext(name, outcome, command=command, versions=host)
    jobs.add_to_result(data, folder, {PAGE: page_bytes([context])})


def _check_count(study_count: int) -> None:
    if study_count > MAX_STUDIES:
        raise pe.InputError("command line", "STUDY", f"{MAX_STUDIES} at most", study_count)


def _check_output(args: argparse.Namespace) -> None:
    """Refuse a folder that cannot be written before the work; make it after the input is read."""
    _about(args)
    pe.prepare_folder(args.output, () if args.replace else (PAGE,))


def _write(contexts: Sequence[ReportContext], args: argparse.Namespace) -> app.Answer:
    path = write_page(contexts, args.output, replace=args.replace, about=_about(args))
    return str(path), app.DONE


def _about(args: argparse.Namespace) -> About:
    return About(args.title, args.author, args.date, args.revision)


def _read_study(path: str) -> pe.Study:
    """Read a study file, or the study of a folder of results."""
    return pe.load_study(Path(path) / studies.STUDY if Path(path).is_dir() else path)


def _search_outcome(path: str, args: argparse.Namespace) -> pe.Outcome | None:
    """Return the outcome of the search in a folder; None if the path is not such a folder."""

    def score(study: pe.Study) -> pe.Outcome:
        return app.scored(app.with_options(study, args), args.workers)

    return outcome_of_folder(Path(path), score) if Path(path).is_dir() else None


def outcome_of_folder(folder: Path, score: Callable[[pe.Study], pe.Outcome]) -> pe.Outcome | None:
    """Return the outcome of the search in a folder; None if the folder contains no search.

    Start and end are scored again, because result.json does not contain all of a score; the
    history of the search is read from the file.

    Raises
    ------
    InputError
        When a file of the search is damaged, or was written by another version.
    """
    if not (folder / studies.SEARCH).exists() or not (folder / studies.RESULT).exists():
        return None
    checkpoint, path = jobs.read_search(folder), folder / studies.RESULT
    start = checkpoint.study
    best = start.with_rig(pe.load_study(folder / studies.STUDY).rig)
    try:
        result = _result_of(folder)
        figure = jobs.searched_figure(start)
        history = tuple(_history_row(start.rig, row, figure) for row in result["history"])
        robustness = _robustness(result.get("robustness"))
        sure = sensitivity_from_dict(result.get("sensitivity"), start.rig)
        starts = tuple(_start_end(table, figure) for table in result.get("starts", ()))
        in_traffic = _in_traffic(result.get(figure.key) if figure.higher_is_better else None)
        reason = str(result.get("stop_reason") or "")
        warnings = tuple(_advice(table) for table in result["warnings"])
        blind = result["blind_ground_m2"]
        blind_m2 = float(blind["before"]), float(blind["after"])
        evaluations, stopped = int(result["evaluations"]), bool(result["stopped"])
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, pe.InputError):
            raise
        raise pe.InputError(path, "file", A_RESULT, "another file") from None
    first = score(start)
    last = first if best.rig == start.rig else score(best)
    scores = first.after, last.after
    return pe.Outcome(
        "optimize",
        *(start, best, *scores, history, evaluations, stopped, 0.0, warnings),
        inputs=checkpoint.inputs,
        evaluated=checkpoint.evaluated,
        robustness=robustness,
        verdicts=last.verdicts,
        conditions=last.conditions,
        sensitivity=sure,
        starts=starts,
        stop_reason=reason,
        in_traffic=in_traffic,
        blind_m2=blind_m2,
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


def _in_traffic(table: Any) -> tuple[pe.ObjectScore, pe.ObjectScore] | None:
    if table is None:
        return None
    before, after = (pe.ObjectScore.from_dict(table[which]) for which in ("before", "after"))
    return before, after


def _start_end(table: Mapping[str, Any], figure: jobs.SearchedFigure) -> jobs.StartEnd:
    value = figure.to_figure(float(table[figure.key]))
    return jobs.StartEnd(str(table["name"]), value, int(table["evaluations"]))


def _history_row(
    rig: pe.Rig, row: Mapping[str, Any], figure: jobs.SearchedFigure
) -> jobs.HistoryRow:
    tables = [row["placements"][sensor.name] for sensor in rig]
    poses = [pe.Pose.from_degrees(table["position"], table["rotation"]) for table in tables]
    numbers = int(row["evaluation"]), int(row["round"])
    value = figure.to_figure(float(row[figure.key]))
    return jobs.HistoryRow(*numbers, value, rig.with_poses(poses))


def _robustness(table: Mapping[str, Any] | None) -> search.Robustness | None:
    if table is None:
        return None
    errors = search.Tolerance(table["position"], math.radians(table["angle"]), draws=table["draws"])
    stands = (search.RigRobustness(**table[which]) for which in ("before", "after"))
    return search.Robustness(errors, int(table["samples"]), *stands)


def _advice(table: Mapping[str, Any]) -> pe.Advice:
    return replace(pe.Advice(**table), amount=tuple(table["amount"]))
