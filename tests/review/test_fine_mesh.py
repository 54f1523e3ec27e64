"""A vehicle with too many triangles for a page is drawn simplified, and the page says so."""

import dataclasses

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_tools.page import ReportContext, report_context
from pe_tools.page.sections.score import warnings_and_text
from tests.review.conftest import html_of, outcome_of, small_study

ACROSS, FEW = 120, 4_000
"""Squares along each side of the hood, and the page's limit: two million meet the same code."""


def hood():
    """(2 * ACROSS^2, 3, 3) triangles of a hood arched both ways [m]."""
    x, y = np.meshgrid(np.linspace(-2, 2, ACROSS + 1), np.linspace(-0.9, 0.9, ACROSS + 1))
    at = np.stack([x, y, 1.2 + 0.2 * np.cos(x) * np.cos(y)], axis=-1)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    return np.concatenate(
        [np.stack(three, -2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))]
    )


def test_it_is_drawn_with_fewer_and_the_page_says_so(monkeypatch):
    monkeypatch.setattr(report_context, "MAX_TRIANGLES", FEW)
    study = dataclasses.replace(small_study(), vehicle=pe.Vehicle(hood()), samples=1024)
    one = ReportContext("fine", outcome_of(pt.ScoreJob(study)))
    shown, moved = one.display_vehicle
    assert len(shown.triangles) <= FEW and moved > 0.0
    assert len(one.vehicle.triangles) == 2 * ACROSS**2, "beams are cast at all"
    html = html_of(warnings_and_text, one)
    assert f"{2 * ACROSS**2:,}" in html and f"{len(shown.triangles):,}" in html
    assert np.abs(np.subtract(shown.bounds, one.vehicle.bounds)).max() <= moved
