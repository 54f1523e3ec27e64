"""The warning about AP curves from scans, as long as they rest on a part of their runs."""

from __future__ import annotations

from collections.abc import Iterable

from pe_core.sensors import SCANS, PerceptionModel, scan_curves

from .advice import PROVISIONAL, Advice


def curve_warnings(model: PerceptionModel) -> tuple[Advice, ...]:
    """Return a warning where curves of objects are those from scans and provisional."""
    if model.model != SCANS or (fitted := scan_curves()).complete:
        return ()
    text = (
        f"the curves from scans are provisional: {fitted.runs} of {fitted.planned} runs of their "
        "study are done"
    )
    return (Advice(None, PROVISIONAL, text),)


def curve_note(models: Iterable[PerceptionModel]) -> str:
    """Return that warning as a line, once for several models; empty where none has it."""
    return next((each.line for model in models for each in curve_warnings(model)), "")
