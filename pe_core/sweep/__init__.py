"""Sweeps: many studies, or one with many changes, run by the workers of any executor."""

from .grid import sweep_runs
from .run import FolderCheckpoints, RunCheckpoints, RunTask, SweepRun, carried_out
from .runner import Workplace, run_all
from .settings import TriedKey, read_settings
from .table import (
    BEGUN,
    DONE,
    FAILED,
    SWEEP_CSV,
    SWEEP_JSON,
    WAITING,
    SweepRow,
    row_of,
    row_of_result,
    table_lines,
    write_table,
)

__all__ = [
    "BEGUN",
    "DONE",
    "FAILED",
    "SWEEP_CSV",
    "SWEEP_JSON",
    "WAITING",
    "FolderCheckpoints",
    "RunCheckpoints",
    "RunTask",
    "SweepRow",
    "SweepRun",
    "TriedKey",
    "Workplace",
    "carried_out",
    "read_settings",
    "row_of",
    "row_of_result",
    "run_all",
    "sweep_runs",
    "table_lines",
    "write_table",
]
