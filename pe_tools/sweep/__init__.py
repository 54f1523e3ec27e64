"""Sweeps: many studies, or one with many changes, run by the workers of any executor."""

from .parameter_grid import read_settings, sweep_runs
from .sweep_runner import LocalWorkers, RunTask, SweepRun, run_all, run_task
from .sweep_table import (
    BEGUN,
    DONE,
    ELSEWHERE,
    SWEEP_CSV,
    SWEEP_JSON,
    UNWRITTEN,
    WAITING,
    SweepRow,
    row_of,
    row_of_result,
    table_data,
    table_lines,
    write_table,
)

__all__ = [
    "BEGUN",
    "DONE",
    "ELSEWHERE",
    "SWEEP_CSV",
    "SWEEP_JSON",
    "UNWRITTEN",
    "WAITING",
    "LocalWorkers",
    "RunTask",
    "SweepRow",
    "SweepRun",
    "read_settings",
    "row_of",
    "row_of_result",
    "run_all",
    "run_task",
    "sweep_runs",
    "table_data",
    "table_lines",
    "write_table",
]
