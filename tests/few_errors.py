"""Fewer mounting errors in the robustness of a result, where it is not what a test is about.

Every search ends with the robustness of its result: a sensor is measured anew for each error. In
small studies that takes longer than the search itself.
"""

import importlib
from dataclasses import replace

import pytest

ROBUSTNESS = importlib.import_module("pe_core.search.tolerance")
"""The module: its package has a function of this name."""


@pytest.fixture
def few_errors(monkeypatch):
    """Draw two mounting errors a sensor for the result of a search, instead of six."""
    monkeypatch.setattr(ROBUSTNESS, "WORKSHOP", replace(ROBUSTNESS.WORKSHOP, draws=2))


@pytest.fixture
def all_errors(few_errors, monkeypatch):
    """Draw as many as the command does: for a comparison with another process."""
    monkeypatch.setattr(ROBUSTNESS, "WORKSHOP", replace(ROBUSTNESS.WORKSHOP, draws=6))
