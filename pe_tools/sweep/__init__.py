"""Sweeps: many studies, or one with many changes, run by the workers of any executor."""

from .parameter_grid import read_settings as read_settings
from .parameter_grid import set_value as set_value
from .parameter_grid import sweep_runs as sweep_runs
from .sweep_runner import LocalWorkers as LocalWorkers
from .sweep_runner import RunTask as RunTask
from .sweep_runner import SweepRun as SweepRun
from .sweep_runner import run_all as run_all
from .sweep_runner import run_task as run_task
