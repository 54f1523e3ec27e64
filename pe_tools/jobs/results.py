"""The result files of a run in its output folder: result.json, history.csv, study.toml, and more.
The files of a run are one set. `FileSet` writes them together, with result.json last."""

import json
import platform
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from pe_core.base.codec import record, write
from pe_core.base.errors import InputError
from pe_core.base.files import csv_text, read_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.table_reader import Table, dump_json, finite, parse_json
from pe_core.scoring.requirements import VerdictSummary
from pe_core.search import AXES, EvaluatedRig, Value
from pe_core.study.condition_table import ConditionScore, ConditionTable
from pe_core.study.file_names import (
    AREAS,
    BESIDE_RESULT,
    BOXES,
    GRID,
    HISTORY,
    MESH,
    RESULT,
    SCHEMA,
    SEARCH,
    STUDY,
)
from pe_core.study.mounting_file import areas_of, mounts_table
from pe_core.study.study import EXPECTED_AP, Study
from pe_core.version import __version__

from ..wording import percent
from .folder import PROGRAM, FileSet, Write, prepare_folder
from .job import HistoryRow, Outcome
from .result_record import BeforeOrAfter, InputsRecord, ResultRecord, RunMetadata, placements
from .searched_figure import IN_NATS, SearchedFigure
from .study_export import fingerprint, inputs_of, study_text, study_writers

T = TypeVar("T")
VIOLATION = "violation"
EntriesOfSearches = Mapping[str, Iterable[EvaluatedRig]]
"""Entries of journals by the names of their searches; empty: that of a job with one search."""


def result_names(study: Study, kind: str) -> list[str]:
    """Return the names of the files that a run of this kind (score or optimize) writes."""
    vehicle = study.vehicle is not None
    prior = study.prior
    given = [*[BOXES] * (prior.boxes is not None), *[GRID] * (prior.grid is not None)]
    areas = bool(areas_of(study.search.mounting))
    with_study = [STUDY, *[MESH] * vehicle, *[AREAS] * areas, *given]
    of_search = [HISTORY, SEARCH] * (kind == "optimize")
    return [*with_study, *of_search, RESULT]


def result_dict(outcome: Outcome, host: dict[str, str] | None = None) -> dict[str, Any]:
    """Return a run as plain JSON data.

    Everything outside `run` depends on the study alone: two runs of the same study agree in it to
    the last bit. Infinity and NaN, which JSON does not have, become null.
    """
    cached = outcome.result_cache or _result_dict(outcome)
    return {**cached, "run": record(run_record(outcome.seconds, host or {}))}


def cache_result(outcome: Outcome) -> None:
    """Have an outcome hold its result, in whichever process it will be asked for."""
    object.__setattr__(outcome, "result_cache", _result_dict(outcome))


def _result_dict(outcome: Outcome) -> dict[str, Any]:
    start = outcome.start
    study = outcome.study
    is_search = outcome.kind == "optimize"
    own = outcome.own
    of_own = None if own is None else own.figure.key
    objective = of_own if outcome.in_traffic is None else EXPECTED_AP
    robustness = outcome.robustness
    conditions = outcome.conditions
    flatness = outcome.flatness
    rounding = outcome.rounding
    agreed = outcome.consensus
    figure = outcome.figure
    made = ResultRecord(
        schema=SCHEMA,
        kind=outcome.kind,  # type: ignore[arg-type]
        seed=study.search.seed,
        entropy=outcome.after.entropy,
        coverage=outcome.after.coverage,
        before=outcome.before,
        after=outcome.after,
        placements={"before": placements(start.rig, start), "after": placements(study.rig, study)},
        mounts=mounts_table(study.rig, study.search.mounting),
        robustness=None if robustness is None else robustness.to_dict(),
        requirements=tuple(each.row for each in outcome.verdicts) or None,
        conditions=None if conditions is None else conditions.to_dict(),
        method=start.search.method if is_search else None,
        level_samples=tuple(start.level_samples) if is_search else (),
        objective=objective,
        expected_ap=_ends(outcome.in_traffic),
        value=None if own is None else {"before": own.before, "after": own.after},
        figures=_ends(outcome.figures),
        dashboard=tuple(each.row for each in outcome.dashboard),
        gain=outcome.gain if is_search else None,
        cost=outcome.cost if is_search else None,
        change_stderr=outcome.change_errors if is_search else None,
        ap_model=study.model.model,
        returns=study.returns,
        flatness=None if flatness is None else flatness.to_dict(),
        rounding=None if rounding is None else rounding.to_dict(),
        consensus=None if agreed is None else agreed.to_dict(),
        starts=tuple(
            {"name": e.name, **_value(figure, e.value), "evaluations": e.evaluations}
            for e in outcome.starts
        ),
        stop_reason=outcome.stop_reason or None,
        seed_scatter=outcome.seed_scatter,
        evaluations=outcome.evaluations,
        stopped=outcome.stopped,
        warnings=outcome.warnings,
        history=tuple(
            {
                "evaluation": row.evaluation,
                "round": row.round,
                **_value(figure, row.value),
                "placements": placements(row.rig),
            }
            for row in outcome.history
        ),
        study_sha256=fingerprint(study),
        inputs=InputsRecord(**(outcome.inputs or inputs_of(start))),
        run=run_record(outcome.seconds, {}),
    )
    return finite(record(made))  # type: ignore[no-any-return]


def _ends(both: tuple[T, T] | None) -> dict[BeforeOrAfter, T] | None:
    return None if both is None else {"before": both[0], "after": both[1]}


def score_facts(result: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a result, as `result_dict` has it, says to other programs that get the rig: the
    study's fingerprint, the figures of the dashboard, and the verdicts."""
    after = result["after"]
    verdicts = result.get("requirements") or ()
    keys = [field.name for field in fields(VerdictSummary)]
    facts = {
        "study": result["study_sha256"],
        "voxels": after["voxels"],
        "stderr": after["stderr"],
        "coverage": after["coverage"],
        "figures": result["dashboard"],
        "verdicts": [{key: row[key] for key in keys} for row in verdicts],
    }
    return finite(facts)  # type: ignore[no-any-return]


@not_noting_inputs()
def stored_result(folder: Path, study: Study) -> Mapping[str, Any] | None:
    """Return the data of the result that a folder holds; None where it is not of this study as it
    is now, or of another version of the program."""
    path = folder / RESULT
    with suppress(InputError):  # another program's file of that name, or none
        data = parse_json(path, read_bytes(path))
        if isinstance(data, dict) and is_result_of(data, study):
            return data
    return None


def is_result_of(result: Mapping[str, Any], study: Study) -> bool:
    """Whether a result is of a study as it is now, by this version of the program."""
    table = Table(result, RESULT)
    if "study_sha256" not in table or "run" not in table:
        return False
    version = table.at("run", {}).at("versions", {}).text(PROGRAM)
    return version == __version__ and table.text("study_sha256") == fingerprint(study)


def _value(figure: SearchedFigure, value: Value) -> dict[str, float | None]:
    """Return the figure of a value, null where it breaks constraints, and by how much."""
    return dict(zip((figure.key, VIOLATION), figure.cells(value), strict=True))


def run_record(seconds: float, host: Mapping[str, str]) -> RunMetadata:
    """Return the part of a result about the run: its duration, and versions of the programs."""
    own = {"perception-entropy": __version__, "numpy": np.__version__}
    versions = {**own, "python": platform.python_version(), **host}
    return RunMetadata(round(seconds, 3), versions)


def write_outcome(
    outcome: Outcome,
    folder: str | Path,
    host: dict[str, str] | None = None,
    later: Collection[str] = (),
) -> dict[str, Any]:
    """Write the result files of a run; return the data of result.json.

    These are result.json and the study, and for a search also history.csv and its state. Files of
    an earlier run that this run does not write are removed, if this program wrote them and nobody
    has changed them since: they would belong to another result.

    Parameters
    ----------
    outcome, folder
    host : dict of str, optional
        Versions of the host program by name.
    later : collection of str
        Names of files that the caller writes afterwards; old ones stay until they are replaced.

    Raises
    ------
    InputError
        The folder cannot be written, or one of these files in it was not written by this program;
        it then stays unchanged.
    """
    folder = prepare_folder(folder)
    data = result_dict(outcome, host)
    writers = study_writers(outcome.study, STUDY)
    if outcome.kind == "optimize":
        text = history_csv(outcome.history, outcome.figure)
        writers[HISTORY] = text.encode(errors="backslashreplace")
        writers[SEARCH] = SearchState(outcome.start, outcome.inputs).to_bytes(
            {outcome.journal_name: outcome.evaluated}
        )
    add_to_result(data, folder, writers, unwanted=set(BESIDE_RESULT) - set(later))
    return data


def add_to_result(
    data: dict[str, Any],
    folder: Path,
    writers: Mapping[str, Write | bytes],
    unwanted: Collection[str] = (),
) -> None:
    """Write files of a run together with its result.json. `unwanted` files are removed, unless they
    are in `writers` or were not written by this program. `InputError` if the folder cannot be
    written, or one of the files in it was not written by this program."""
    with FileSet(folder) as files:
        files.take_away(unwanted)
        for name, content in writers.items():
            files.add(name, content)
        files.add(RESULT, dump_json(data).encode(errors="backslashreplace"))


def history_csv(history: tuple[HistoryRow, ...], figure: SearchedFigure = IN_NATS) -> str:
    """Return the history as CSV: one row each time a better placement was found."""
    names = [s.name for s in history[0].rig] if history else []
    units = {a: "m" if a in "xyz" else "deg" for a in AXES}
    columns = [f"{name}.{axis}_{units[axis]}" for name in names for axis in AXES]
    rows: list[list[object]] = [["evaluation", "round", figure.key, VIOLATION, *columns]]
    for row in history:
        poses = [(*s.pose.position, *s.pose.rotation_deg) for s in row.rig]
        shown = ("" if cell is None else cell for cell in figure.cells(row.value))
        rows.append([row.evaluation, row.round, *shown, *(v for p in poses for v in p)])
    return csv_text(rows)


def condition_lines(table: ConditionTable) -> list[str]:
    """Return a line for each condition, and the mean and the worst of them."""
    worst = table.worst
    sensor, lossy = table.worst_loss
    lines = [f"conditions, on {table.samples:,} samples:", *map(_line, table.rows)]
    lines.append(f"mean of the conditions {table.mean:.3f} nats, worst {worst.entropy:.3f}")
    lines[-1] += f" ({worst.name})"
    if len(table.sensors) > 1:
        lines.append(
            f"worst with one sensor lost {lossy.without[sensor]:.3f} nats: "
            f"without {sensor}, {lossy.name}"
        )
    return lines


def _line(row: ConditionScore) -> str:
    ap = "" if row.ap is None else f", expected AP {row.ap:.3f}"
    return (
        f"  {row.name}: {row.entropy:.3f} nats, coverage {percent(row.coverage, 1)}{ap}, "
        f"weight {row.weight:g}"
    )


class SearchState:
    """The state of a job's searches, which is saved in its folder while they run. `inputs` is the
    provenance at the beginning of the search, if file names have changed since."""

    def __init__(self, study: Study, inputs: dict[str, Any] | None = None) -> None:
        self._study = study
        self._inputs = inputs

    @cached_property
    def _head(self) -> dict[str, Any]:
        """The constant part of the state: cached, because it is expensive for a large mesh."""
        return {
            PROGRAM: "search",
            "version": __version__,
            "study_sha256": fingerprint(self._study),
            "study": study_text(self._study),
            "inputs": self._inputs or inputs_of(self._study),
        }

    def to_bytes(self, journals: EntriesOfSearches) -> bytes:
        """Return the content of the state file."""
        rows = {name: write(list(entries)) for name, entries in journals.items()}
        return json.dumps({**self._head, "journals": rows}, ensure_ascii=False).encode()

    def save(
        self,
        folder: Path,
        study: Study,
        journals: EntriesOfSearches,
        *,
        own: bool = True,
        other: bool = True,
    ) -> None:
        """Write the state into a folder, with the file of a study (`own`), such as the best so far,
        and the `other` files that it names. The folder stays unchanged after an `InputError`: it
        cannot be written, or this program did not write one of the files in it."""
        with FileSet(prepare_folder(folder)) as files:
            for name, content in study_writers(study, STUDY).items():
                if own if name == STUDY else other:
                    files.add(name, content)
            files.add(SEARCH, self.to_bytes(journals))
