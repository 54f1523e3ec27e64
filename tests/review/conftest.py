"""One small study, scored and searched once for all tests of the page."""

import dataclasses

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.catalog import load
from pe_tools.page import ReportContext, page_bytes
from pe_tools.page.pictures import sensor_views, vehicle_picture
from pe_tools.page.sections import SECTIONS
from tests.engine.processes import finished
from tests.review.browser import started

NAMES = ("</script><b>roof", "front & left / 60°")
"""Names that would end a script, and begin an element, if they were not escaped."""


@pytest.fixture(scope="session", autouse=True)
def small_pictures():
    """Pictures of few pixels: what is in them does not depend on their size."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(vehicle_picture, "SIZE", (192, 108))
        patch.setattr(sensor_views, "MAX_WIDTH", 128)
        yield


def html_of(function, *contexts):
    """The HTML of the section that a function has the values of; empty if it is left out."""
    section = next(section for section in SECTIONS if section.data is function)
    data = function(contexts if section.joint else contexts[0])
    return "" if data is None else str(section.html(contexts, data))


def box(low, high):
    """(12, 3, 3) triangles of a box [m]."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (2, 3, 7),
        (2, 7, 6),
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),
    ]
    return (np.array(low) + corners * (np.array(high) - np.array(low)))[np.array(faces)]


def small_study(shift=0.0):
    """A car of a box, a LiDAR on its roof and a camera at its front: few voxels."""
    space = pe.PerceptionSpace(x=(-14, 14), y=(-12, 12), z=(0, 2), interval=0.5)
    lidar = pe.Lidar("small LiDAR", np.radians([-20.0, -10.0, -3.0, 2.0]), 120, 100.0)
    rig = pe.Rig(
        [
            pe.Sensor(NAMES[0], lidar, pe.Pose((shift, 0.0, 1.8))),
            pe.Sensor(NAMES[1], load("Camera 60 deg"), pe.Pose((2.3, 0.2, 1.2))),
        ]
    )
    search = pe.Search(samples=1024, evaluations=24)
    vehicle = pe.Vehicle(box((-2.2, -0.9, 0.2), (2.2, 0.9, 1.5)))
    return pe.Study(rig, vehicle, space, search=search)


@pytest.fixture(scope="session")
def scored():
    """The study scored as it stands."""
    return ReportContext("a/b <i>c</i>", finished(pt.ScoreJob(small_study())))


@pytest.fixture(scope="session")
def other():
    """Another study, with the LiDAR farther back."""
    return ReportContext("B & co", finished(pt.ScoreJob(small_study(-1.5))))


@pytest.fixture(scope="session")
def searched():
    """The study after a search."""
    return ReportContext("searched", finished(pt.OptimizeJob(small_study())))


@pytest.fixture(scope="session")
def bare():
    """A study without a vehicle."""
    study = dataclasses.replace(small_study(), vehicle=None)
    return ReportContext("bare", finished(pt.ScoreJob(study)))


@pytest.fixture(scope="session")
def page(scored):
    """The page of the study that was scored, as text."""
    return page_bytes([scored]).decode()


@pytest.fixture(scope="session")
def searched_page(searched):
    """The page of the search, as text."""
    return page_bytes([searched]).decode()


@pytest.fixture(scope="session")
def bare_page(bare):
    """The page of a study without a vehicle, as text."""
    return page_bytes([bare]).decode()


@pytest.fixture(scope="session")
def page_of_two(scored, other):
    """The page of two studies, as text."""
    return page_bytes([scored, other]).decode()


@pytest.fixture(scope="session")
def chromium():
    """A headless Chromium for all tests of pages."""
    with started() as browser:
        yield browser
