"""Less of what stands beside a result, where it is not what a test is about.

Every search ends with the robustness of its result: a sensor is measured anew for each error. Every
result has key figures, of many scenes of traffic. What fixes a requirement is looked for at many
places. In small studies each takes longer than the rest.
"""

import importlib
import math
from dataclasses import replace

import pytest

from pe_core.scoring.sight import sight
from pe_core.search import processes
from pe_core.study import suggestion

ROBUSTNESS = importlib.import_module("pe_core.search.tolerance")
"""The module: its package has a function of this name."""
WORKSHOP = ROBUSTNESS.WORKSHOP
OBJECTS = sight.ObjectEvaluator
HEIGHTS = sight.SECTOR_HEIGHTS_M
SHORT_S = processes.SHORT_S
FEW_SCENES = 16
FEW_PLACES = {"HELP_PLACES": 8, "ADD_PLACES": 24, "ADD_COMPARED": 2}


def objects_of_few_scenes(*where, targets, **more):
    """The objects in traffic of key figures, of few scenes."""
    few = replace(targets, scenes=min(FEW_SCENES, targets.scenes))
    return OBJECTS(*where, targets=few, **more)


def draw_few(monkeypatch):
    """Draw two mounting errors a sensor, not six; few scenes and places, one height of sectors.

    A search that takes long on a busy machine starts no workers: they would draw all.
    """
    monkeypatch.setattr(processes, "SHORT_S", math.inf)
    monkeypatch.setattr(ROBUSTNESS, "WORKSHOP", replace(WORKSHOP, draws=2))
    monkeypatch.setattr(sight, "ObjectEvaluator", objects_of_few_scenes)
    monkeypatch.setattr(sight, "SECTOR_HEIGHTS_M", HEIGHTS[:1])
    for name, few in FEW_PLACES.items():
        monkeypatch.setattr(suggestion, name, few)


@pytest.fixture
def few_errors(monkeypatch):
    """The same for one test."""
    draw_few(monkeypatch)


@pytest.fixture
def all_errors(few_errors, monkeypatch):
    """Draw as many as the command does: for a comparison with another process."""
    monkeypatch.setattr(ROBUSTNESS, "WORKSHOP", WORKSHOP)
    monkeypatch.setattr(sight, "ObjectEvaluator", OBJECTS)
    monkeypatch.setattr(sight, "SECTOR_HEIGHTS_M", HEIGHTS)
    monkeypatch.setattr(processes, "SHORT_S", SHORT_S)
