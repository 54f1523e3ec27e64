"""Sweeps: many studies, or one with many changes, run by the workers of any executor."""

from .parameter_grid import TriedKey, read_settings, sweep_runs
from .sweep_runner import (
    FolderCheckpoints,
    RunCheckpoints,
    RunTask,
    SweepRun,
    WorkerPool,
    run_all,
    run_task,
)
from .sweep_table import (
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
    "WorkerPool",
    "read_settings",
    "row_of",
    "row_of_result",
    "run_all",
    "run_task",
    "sweep_runs",
    "table_lines",
    "write_table",
]
