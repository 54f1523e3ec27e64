"""Mounting errors and failures that a search reckons with: their keys in the study file."""

from __future__ import annotations

import math
from typing import Any

from ..errors import InputError
from ..search import Tolerance
from ..text.degrees import degrees_in_file
from ..text.tables import Table

ERRORS = ("position", "angle", "draws")


def read_tolerance(table: Table) -> Tolerance:
    """Return what `[optimize]` says of them: the table `tolerance`, and two keys."""
    errors, default = table.table("tolerance"), Tolerance()
    values: dict[str, Any] = {
        "position": errors.number("position", default.position),
        "angle": math.radians(errors.number("angle", default.angle)),
        "draws": errors.whole("draws", default.draws),
    }
    errors.finish()
    cases = {key: table.raw(key, False) for key in ("failures", "worst")}
    try:
        return Tolerance(**values, **cases)
    except InputError as error:
        raise table.error(error.field, error.expected, error.found) from None


def tolerance_keys(tolerance: Tolerance) -> dict[str, Any]:
    """Return the keys of `[optimize]` that `read_tolerance` reads; None for what is as usual."""
    usual = Tolerance()
    errors = {
        "position": tolerance.position,
        "angle": degrees_in_file(tolerance.angle),
        "draws": tolerance.draws,
    }
    said = any(getattr(tolerance, key) != getattr(usual, key) for key in ERRORS)
    return {
        "tolerance": errors if said else None,
        "failures": tolerance.failures or None,
        "worst": tolerance.worst or None,
    }
