"""The table of a sweep, one row for each run: as CSV, as JSON and for the terminal."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.files import csv_text, read_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.table_reader import dump_json, finite, parse_json
from pe_core.search import FIGURES, KEPT, NO_FIGURE, REQUIREMENTS, SHOWN, KeyFigures
from pe_core.study import RESULT
from pe_core.study.study import EXPECTED_AP
from pe_core.version import __version__

from ..jobs import FileSet, Outcome, fingerprint, prepare_folder
from ..wording import aligned, percent
from .sweep_runner import SweepRun

SWEEP_CSV = "sweep.csv"
SWEEP_JSON = "sweep.json"
WAITING = "waiting"
BEGUN = "begun"
DONE = "done"
FAILED = "failed"
UNWRITTEN = "not written"  # The status of a run whose results could not be written
BEST = "*"
BEFORE = "_before"
"""Ends the name of a column of the given study, beside that of the result."""
OVER_FRAMES = "entropy_over_frames"
CHECKED = "requirements_checked"
ALL = tuple(SHOWN)
"""The figures of a study that chooses none."""


@dataclass(frozen=True, slots=True)
class SweepRow:
    """The state of a run. One that is "begun" may have a checkpoint of its search in its folder,
    one that is "done" has its results there. Entropies are those of the given study and of the
    result [nats]; `message` is why the run failed or was not written, or where its results are. APs
    are expected ones in traffic, of a search by them. `figures` are the key figures of the given
    study and of the result; `met` tells how many of how many requirements the result meets."""

    run: SweepRun
    status: str = WAITING
    before: float | None = None
    entropy: float | None = None
    coverage: float | None = None
    message: str = ""
    ap_before: float | None = None
    ap: float | None = None
    figures: tuple[KeyFigures, KeyFigures] | None = None
    met: tuple[int, int] | None = None

    @property
    def figures_after(self) -> KeyFigures | None:
        """The key figures of the result, if they are known."""
        return None if self.figures is None else self.figures[1]


def row_of(
    run: SweepRun, result: Outcome | InputError, status: str = DONE, message: str = ""
) -> SweepRow:
    """Return the row of a run's result, with the status and the message of one that succeeded."""
    if isinstance(result, InputError):
        return SweepRow(run, FAILED, message=str(result))
    before = result.before
    after = result.after
    ap_before, ap = (o.ap for o in result.in_traffic) if result.in_traffic else (None, None)
    met = [verdict.met for verdict in result.verdicts]
    return SweepRow(
        run=run,
        status=status,
        before=before.entropy,
        entropy=after.entropy,
        coverage=after.coverage,
        message=message,
        ap_before=ap_before,
        ap=ap,
        figures=result.figures,
        met=(sum(met), len(met)) if met else None,
    )


@not_noting_inputs()
def row_of_result(run: SweepRun, folder: Path, kind: str) -> SweepRow | None:
    """Return the row of a run whose result is in its folder already; None otherwise. The result
    must be complete, of this study and kind, and of this version."""
    try:
        data: Any = parse_json(RESULT, read_bytes(folder / RESULT))
        made = (data["kind"], data["stopped"], data["run"]["versions"]["perception-entropy"])
        same = data["inputs"]["study_sha256"] == fingerprint(run.study)
        if made != (kind, False, __version__) or not same:
            return None
        before = float(data["before"]["entropy"])
        entropy = float(data["entropy"])
        found = data.get(EXPECTED_AP)
        ends = ("before", "after")
        aps = [None if found is None else float(found[end]["ap"]) for end in ends]
        met = [bool(verdict["met"]) for verdict in data.get("requirements", ())]
        return SweepRow(
            run=run,
            status=DONE,
            before=before,
            entropy=entropy,
            coverage=float(data["coverage"]),
            message="",
            ap_before=aps[0],
            ap=aps[1],
            figures=_read_figures(data.get("figures")),
            met=(sum(met), len(met)) if met else None,
        )
    except (AttributeError, KeyError, TypeError, ValueError):
        return None


def _read_figures(data: Mapping[str, Any] | None) -> tuple[KeyFigures, KeyFigures] | None:
    """Return the key figures of a result's data, if it has them."""
    if data is None:
        return None
    return KeyFigures.from_dict(data["before"]), KeyFigures.from_dict(data["after"])


def table_data(rows: Sequence[SweepRow], kind: str) -> dict[str, Any]:
    """Return what sweep.json holds."""
    runs = [_dict(row, kind) for row in rows]
    return {"kind": f"sweep of {kind}", "version": __version__, "runs": runs}


def write_table(rows: Sequence[SweepRow], kind: str, folder: Path) -> dict[str, Any]:
    """Write sweep.csv and sweep.json, together; return what sweep.json holds. `InputError` if the
    folder cannot be written, or one of the files is of another program."""
    data = table_data(rows, kind)
    with FileSet(prepare_folder(folder)) as files:
        files.add(SWEEP_CSV, csv_text(_table(rows, kind)).encode(errors="backslashreplace"))
        files.add(SWEEP_JSON, dump_json(finite(data)).encode(errors="backslashreplace"))
    return data


def table_lines(rows: Sequence[SweepRow], kind: str) -> list[str]:
    """Return the lines of the table for the terminal: key figures are those of the results. Lowest
    entropy and highest AP are marked."""
    keys = _keys(rows)
    several = len({row.run.study_name for row in rows}) > 1
    heads = [*["study"] * several, *keys, *["start"] * (kind != "score"), "entropy", "coverage"]
    lowest = min((r.entropy for r in rows if r.entropy is not None), default=None)
    highest = max((r.ap for r in rows if r.ap is not None), default=None)
    texts = len(heads) - 2 - (kind != "score")
    heads += ["start", "expected AP"] * (highest is not None)
    known = _columns(rows)
    checked = any(row.met for row in rows)
    heads += [FIGURES[key].name for key in known] + [REQUIREMENTS] * checked
    table = [heads]
    for row in rows:
        before = [_figure(row.before)] if kind != "score" else []
        best = BEST if row.entropy is not None and row.entropy == lowest else " "
        entropy = row.status if row.entropy is None else f"{row.entropy:.3f}{best}"
        coverage = "-" if row.coverage is None else percent(row.coverage, 1)
        named = [*[row.run.study_name] * several, *(row.run.changes.get(k, "") for k in keys)]
        best = BEST if row.ap is not None and row.ap == highest else " "
        aps = [_figure(row.ap_before), f"{_figure(row.ap)}{best}"] * (highest is not None)
        met = [NO_FIGURE if row.met is None else f"{row.met[0]} of {row.met[1]} met"] * checked
        cells = [_cell(key, row.figures_after) for key in known]
        table.append([*named, *before, entropy, coverage, *aps, *cells, *met])
    return aligned(table, range(texts, len(table[0])))


def _columns(rows: Sequence[SweepRow]) -> list[str]:
    """Return the key figures that have a column in the terminal: those of the dashboard, and what
    can be built where a study chooses its figures."""
    studies = [row.run.study for row in rows]
    chosen = {k for study in studies if study.figures != ALL for k in study.shown_figures}
    return [
        key
        for key, figure in FIGURES.items()
        if (key in KEPT or key in chosen)
        and any(figure.value(row.figures_after) is not None for row in rows)
    ]


def _figure(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _cell(key: str, figures: KeyFigures | None) -> str:
    """Return a key figure with its unit, as the dashboard has it."""
    row = FIGURES[key]
    return row.text(row.value(figures), figures is not None and row.is_cut(figures))


def _keys(rows: Sequence[SweepRow]) -> list[str]:
    return list(dict.fromkeys(key for row in rows for key in row.run.changes))


def _key_figures(figures: KeyFigures | None) -> dict[str, float | None]:
    """Return the figures by the names of their columns."""
    over = {OVER_FRAMES: None if figures is None else figures.over_frames}
    return {key: row.value(figures) for key, row in FIGURES.items()} | over


def _dict(row: SweepRow, kind: str) -> dict[str, Any]:
    """Return a run as plain data; figures that are not known are left out."""
    before, after = row.figures or (None, None)
    columns = {f"{EXPECTED_AP}{BEFORE}": row.ap_before, EXPECTED_AP: row.ap, **_key_figures(after)}
    if kind != "score":
        columns |= {f"{key}{BEFORE}": value for key, value in _key_figures(before).items()}
    if row.met is not None:
        columns |= {REQUIREMENTS: row.met[0], CHECKED: row.met[1]}
    return {
        "run": row.run.name,
        "study": row.run.study_name,
        "changes": dict(row.run.changes),
        "status": row.status,
        "entropy_before": row.before,
        "entropy": row.entropy,
        "coverage": row.coverage,
        "message": row.message,
        **{key: value for key, value in columns.items() if value is not None},
    }


def _table(rows: Sequence[SweepRow], kind: str) -> list[list[object]]:
    """Return the table: the names of its columns, and a line for each run."""
    keys = _keys(rows)
    runs = [_dict(row, kind) for row in rows]
    own = ("run", "study", "changes")
    figures = list(dict.fromkeys(name for data in runs for name in data if name not in own))
    lines: list[list[object]] = [["run", "study", *keys, *figures]]
    for row, data in zip(rows, runs, strict=True):
        changes = row.run.changes
        named = [data["run"], data["study"], *(changes.get(key, "") for key in keys)]
        lines.append([*named, *(data.get(f) for f in figures)])
    return lines
