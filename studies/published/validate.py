"""Compute the scores, correlate them, write the page and its plots."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from pe_core import InputError, prepare_folder
from pe_core.base import Table, dump_json, write_bytes
from pe_tools.cli import DONE, Answer

from ..paper.reproduce import check_studies
from ..results_file import (
    ENTROPY,
    NOT_NEGATIVE,
    RESULTS,
    SHARE,
    check_names,
    checked_effort,
    checked_entries,
    named_items,
    read_complete,
    read_json,
)
from ..task_runner import compute
from ..wording import PAGE, check_page
from .correlations import ValidityResults, correlations, over_papers
from .findings import rho_text
from .page import TITLE, page
from .plots import draw_all
from .scores import BASE, variants
from .tasks import FULL, QUICK, ValidityEffort, names, plan

CONCLUSIONS = ("correlations", "over_papers")
"""The keys of results.json that follow from the scores."""


def validate(args: argparse.Namespace, folder: Path) -> Answer:
    """Run the verb."""
    check_studies()
    folder = prepare_folder(folder)
    check_page(folder, TITLE, "python -m studies.published")
    data = _results(args, folder)
    results = ValidityResults(data)
    write_bytes(folder / PAGE, page(results, own_answer(folder)).encode())
    draw_all(data, folder)
    return dump_json(data) if args.json else summary(results), DONE


def own_answer(folder: Path) -> str:
    """Return the answer of our own study, whose results are in a folder of its own within."""
    path = folder / "own" / RESULTS
    return str(read_json(path)["answer"]) if path.exists() else "it is not done here."


def _results(args: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Return complete results: those of the folder, or computed ones."""
    if args.page_only:
        return read_results(folder / RESULTS)
    effort = QUICK if args.quick else FULL
    results = compute(folder, effort, check_value, partial(plan, effort), args.workers)
    return results.save(**conclusions(results.values, effort))


def conclusions(values: Mapping[str, Any], effort: ValidityEffort) -> dict[str, Any]:
    """Return what follows from the scores: correlations, and the test over both papers."""
    varied = [choice for choice in variants(effort.all_variants) if choice != BASE]
    return {"correlations": correlations(values, varied), "over_papers": over_papers(values)}


def summary(results: ValidityResults) -> str:
    """Return the test over both papers in a few lines, for people."""
    return "\n".join(
        f"{row['score']:34} {' '.join(map(rho_text, row['rho']))}  mean {rho_text(row['mean'])}"
        f"  p {row['p']:.3f}  after Holm {row['holm']:.3f}"
        for row in results.main_tests
    )


def read_results(path: Path) -> dict[str, Any]:
    """Read a complete results.json.

    Raises
    ------
    InputError
        When it is not one, of another version, damaged, or its correlations do not follow from its
        scores.
    """
    table = read_complete(path, CONCLUSIONS)
    efforts = {"full": FULL, "quick": QUICK}
    effort = efforts[
        checked_effort(
            table, {k: vars(e) for k, e in efforts.items()}, "python -m studies.published"
        )
    ]
    entries = checked_entries(table, check_value)
    different = set(names(effort)) ^ set(entries)
    if different:
        raise InputError(
            path, "results", "results of a complete run", f"a different {min(different)}"
        )
    values = {name: entry["value"] for name, entry in entries.items()}
    for key, value in conclusions(values, effort).items():
        if table.raw(key) != json.loads(dump_json(value)):
            raise InputError(path, key, "those that follow from the scores", "others")
    return dict(table.data)


def check_value(name: str, value: Table) -> None:
    """Raise `InputError` unless a value looks like that of a task with this name."""
    kind = name.partition("/")[0]
    if kind == "voxels":
        check_names(value)
        for prior in value.names:
            _check_voxel_score(value.table(prior))
    elif kind == "objects":
        _check_object_score(value)
    else:
        raise InputError(value.source, "results", "tasks of python -m studies.published", name)


def _check_voxel_score(score: Table) -> None:
    for part in (score, *_parts(score)):
        part.number("entropy", rule=ENTROPY)
        part.number("coverage", rule=SHARE)
        part.finish()


def _check_object_score(score: Table) -> None:
    for part in (score, *_parts(score)):
        part.number("entropy", rule=ENTROPY)
        part.number("stderr", rule=NOT_NEGATIVE)
        part.number("ap", rule=SHARE)
        part.finish()


def _parts(score: Table) -> list[Table]:
    """Return the parts of a score by class."""
    classes = named_items(score, "per_class")
    return [classes.table(name) for name in classes.names]
