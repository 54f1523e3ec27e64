"""``python -m studies.paper``: compute, compare with the paper, write the page and its plots.

results.json is checked whole when it is read, as it may be damaged; the functions here know what
the value of each task looks like.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.base import Number, Table, dump_json, write_bytes
from pe_tools.cli import DONE, Answer

from ..results_file import (
    ENTROPY,
    NOT_NEGATIVE,
    NUMBER,
    RESULTS,
    SHARE,
    ResultsFile,
    check_line,
    check_list,
    check_same_length,
    checked_effort,
    checked_entries,
    list_of,
    named_items,
    read_complete,
)
from ..task_runner import compute, print_progress
from ..wording import PAGE, check_page
from .claims import claims
from .page import TITLE, page
from .paper import CORNERS, PRIORS, ROW, STUDIES
from .plan import (
    FULL,
    QUICK,
    Effort,
    effort_from_dict,
    effort_to_dict,
    names,
    plan,
    scores_and_figures,
)
from .plots import draw_all
from .result_view import ReproductionResults

DIFFERENT = 1
"""Exit status when a claim holds under none of the priors, or a result is not reproduced."""

DIVISOR = Number(1e-9, 1.0)
"""A share that something is divided by."""
METRES, DEGREES = Number(-100.0, 100.0), Number(-360.0, 360.0)


def reproduce(args: argparse.Namespace, folder: Path) -> Answer:
    """Run the verb."""
    check_studies()
    if args.check:
        return _check_results(folder)
    folder = prepare_folder(folder)
    check_page(folder, TITLE, "python -m studies.paper")
    data = _results(args, folder)
    write_bytes(folder / PAGE, page(ReproductionResults(data)).encode())
    draw_all(data, folder)
    text = dump_json(data) if args.json else summary(data)
    return text, DONE if _agrees_with_paper(data) else DIFFERENT


def check_studies() -> None:
    """Raise `InputError` where the files of the checkout are missing."""
    if not STUDIES.is_dir():
        found = "none: studies and vehicles come with a checkout, not with the installed engine"
        raise InputError(str(STUDIES), "folder", "study files of the experiments", found)


def _check_results(folder: Path) -> Answer:
    """Compute again what needs no search, and report what is not equal."""
    data = read_results(folder / RESULTS)
    tasks = scores_and_figures(effort_from_dict(data["made"]["effort"]))
    different = []
    for done, task in enumerate(tasks, 1):
        value = json.loads(dump_json(task.function(**task.arguments)))
        equal = value == data["results"][task.name]["value"]
        print_progress(f"[{done}/{len(tasks)}] {task.name}  {'equal' if equal else 'NOT EQUAL'}")
        if not equal:
            different.append(f"not equal: {task.name}")
    equal_count = len(tasks) - len(different)
    lines = [*different, f"{equal_count} of {len(tasks)} scores and figures are equal"]
    return "\n".join(lines), DIFFERENT if different else DONE


def _results(args: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Return complete results: those of the folder, or computed ones."""
    if args.page_only:
        return read_results(folder / RESULTS)
    effort = QUICK if args.quick else FULL
    results = compute(folder, effort, check_value, partial(plan, effort), args.workers)
    return with_claims(results, effort)


def with_claims(results: ResultsFile, effort: Effort) -> dict[str, Any]:
    """Write the complete results, with the paper's claims; return their data."""
    return results.save(claims=[claim.to_dict() for claim in claims(results.values, effort)])


def summary(data: Mapping[str, Any]) -> str:
    """Return the claims in a few lines, for people."""
    results, lines = ReproductionResults(data), []
    for claim in data["claims"]:
        verdict = "holds" if claim["holds"] else "DOES NOT HOLD"
        verdict = verdict if results.is_decided(claim) else "not decided"
        lines.append(
            f"{verdict:13}  {claim['text']} ({claim['where']}, {claim['prior']}): "
            f"{claim['better']} {claim['better_entropy']:.4f}, "
            f"{claim['worse']} {claim['worse_entropy']:.4f}"
        )
    return "\n".join(lines)


def _agrees_with_paper(data: Mapping[str, Any]) -> bool:
    """Return whether every claim holds under at least one of the priors."""
    holding = {c["text"] for c in data["claims"] if c["holds"]}
    return holding == {c["text"] for c in data["claims"]}


def read_results(path: Path) -> dict[str, Any]:
    """Read a complete results.json.

    Raises
    ------
    InputError
        When it is not one, of another version, damaged, or its claims do not follow from its
        values.
    """
    table = read_complete(path, ("claims",))
    efforts = {"full": FULL, "quick": QUICK}
    data = {name: effort_to_dict(effort) for name, effort in efforts.items()}
    effort = efforts[checked_effort(table, data, "python -m studies.paper")]
    entries = checked_entries(table, check_value)
    values = {name: entry["value"] for name, entry in entries.items()}
    _check_complete(path, set(names(effort, values)), set(values))
    claimed = [claim.to_dict() for claim in claims(values, effort)]
    if table.raw("claims") != json.loads(dump_json(claimed)):
        raise InputError(path, "claims", "those that follow from the results", "other claims")
    return dict(table.data)


def _check_complete(path: Path, expected: set[str], found: set[str]) -> None:
    for name in sorted(expected - found)[:1]:
        raise InputError(path, "results", f"a complete run, with {name}", "none")
    for name in sorted(found - expected)[:1]:
        raise InputError(path, "results", "only tasks of this effort", name)


def check_value(name: str, value: Table) -> None:
    """Raise `InputError` unless a value looks like that of a task with this name."""
    kind, _, rest = name.partition("/")
    check = CHECKS.get(kind)
    if kind in ("search", "pilot"):
        _check_search(rest, value)
    elif check is not None:
        check(value)
    else:
        raise InputError(value.source, "results", "tasks of python -m studies.paper", name)
    value.finish()


def _check_score(value: Table) -> None:
    value.number("entropy", rule=ENTROPY)
    value.number("coverage", rule=DIVISOR)
    value.number("stderr", rule=NUMBER)
    per_class = named_items(value, "per_class")
    for name in per_class.names:
        per_class.number(name, rule=ENTROPY)


def _check_variation(value: Table) -> None:
    """Check a score, or the entropy alone of a setting that has no coverage."""
    if "stderr" in value:
        _check_score(value)
        return
    value.number("entropy", rule=ENTROPY)
    if value.raw("coverage") is not None:
        value.number("coverage", rule=DIVISOR)


def _check_search(rest: str, value: Table) -> None:
    """Check a search: its result has a pose for every sensor of its row."""
    row, _, start = rest.partition("/")
    if row not in ROW or start.split("/")[0] not in PRIORS:
        raise InputError(value.source, "results", "searches of the paper's rows", rest)
    value.number("entropy", rule=ENTROPY)
    value.number("coverage", rule=DIVISOR)
    value.number("start_entropy", rule=ENTROPY)
    value.number("evaluations", rule=NOT_NEGATIVE)
    placements = value.table("placements")
    for sensor in next(iter(ROW[row].starts.values())):
        pose = placements.table(sensor)
        check_list(pose, "position", METRES, 3)
        check_list(pose, "rotation", DEGREES, 3)
        pose.finish()
    placements.finish()


def _check_pitch(value: Table) -> None:
    value.number("entropy", rule=ENTROPY)
    alone = value.table("alone")
    for sensor in CORNERS["front"]:
        alone.number(sensor, rule=ENTROPY)
    alone.finish()


def _check_bound(value: Table) -> None:
    value.number("in_view", rule=DIVISOR)
    value.number("least", rule=ENTROPY)
    value.number("least_all_round", rule=ENTROPY)
    value.number("farthest_m", rule=NOT_NEGATIVE)
    value.number("nearer_than_that", rule=SHARE)
    value.number("most_unseen", rule=NUMBER)


def _check_bound_curve(value: Table) -> None:
    check_list(value, "distance_m", NOT_NEGATIVE)
    check_list(value, "entropy", ENTROPY)
    check_same_length(value, "distance_m", "entropy")


def _check_prior(value: Table) -> None:
    for name in list_of(value, "classes"):
        check_line(value, "classes", name)
    check_list(value, "height_m", NUMBER)
    check_list(value, "height", NOT_NEGATIVE)
    check_same_length(value, "height_m", "height")
    lines = {str(k): line for k, line in enumerate(list_of(value, "ground"))}
    ground = Table(lines, value.source, value.field("ground"))
    for key in lines:
        check_list(ground, key, NOT_NEGATIVE)
    check_same_length(ground, *lines)


def _check_fit(value: Table) -> None:
    for key in ("a", "b", "a_error", "b_error", "rms"):
        value.number(key, rule=NUMBER)
    m = check_list(value, "m", NOT_NEGATIVE)
    check_list(value, "ap", SHARE)
    check_list(value, "n", NOT_NEGATIVE)
    for reason in list_of(value, "left_out"):
        if reason != "":
            check_line(value, "left_out", reason)
    check_same_length(value, "m", "ap", "n", "left_out")
    if not max(m) > 0.0:
        raise value.error("m", "a measurement above 0", "none")


CHECKS: Mapping[str, Callable[[Table], None]] = {
    "printed": _check_score,
    "swapped": _check_score,
    "lidars": _check_score,
    "vary": _check_variation,
    "pitch": _check_pitch,
    "bound": _check_bound,
    "bound_curve": _check_bound_curve,
    "prior": _check_prior,
    "fit": _check_fit,
}
"""The check of a value, by the first part of its task's name."""
