"""Sweeps: many studies, or one with many changes, run by the workers of any executor."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from .parameter_grid import sweep_runs
    from .study_changes import (
        SOURCE,
        KeyChange,
        TomlPath,
        changed_study,
        named_study,
        read_changes,
        read_tried,
    )
    from .study_changes import set_value
    from .sweep_runner import LocalWorkers, RunTask, SweepRun, run_all, run_task
