"""Sweeps: many studies, or one with many changes, run by the workers of any executor."""

from .parameter_grid import read_settings, set_value, sweep_runs
from .sweep_runner import LocalWorkers, RunTask, SweepRun, run_all, run_task
