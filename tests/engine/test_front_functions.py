"""A front of functions from Python, alone and beside objectives of a name."""

import json

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.page.build import write_front_page
from tests.engine.test_front_job import study


def spread(rig):
    """How far the sensors are apart along x [m]; lower is better."""
    along = [sensor.pose.position[0] for sensor in rig]
    return max(along) - min(along)


def droop(rig):
    """How far the sensors are below the highest place, summed [m]."""
    return sum(2.6 - sensor.pose.position[2] for sensor in rig)


def front_of(objectives, workers=1):
    job = pt.FrontJob(study(()), workers, objectives=objectives)
    list(job)
    return job.trade_off


def test_functions_are_objectives_beside_those_of_a_name(tmp_path):
    found = front_of(("entropy", droop))
    assert found.objectives == ("entropy", "droop") and len(found.front) >= 2
    for design in found.designs:
        assert design.figures["droop"] == pytest.approx(droop(design.study.rig), abs=1e-9)
    lowest = min(found.front, key=lambda d: d.figures["droop"])
    best = min(found.front, key=lambda d: d.figures["entropy"])
    assert lowest.figures["droop"] < best.figures["droop"]
    assert lowest.figures["entropy"] > best.figures["entropy"]
    pt.write_front(found, tmp_path)
    data = json.loads((tmp_path / "front.json").read_text())
    assert data["objectives"] == ["entropy", "droop"]
    write_front_page(data, tmp_path)
    assert "Droop" in (tmp_path / "front.html").read_text()


def test_several_functions_alone_are_those_of_processes_too():
    here, there = front_of((spread, droop)), front_of((spread, droop), workers=2)
    assert here.objectives == ("spread", "droop")
    assert [d.figures for d in here.front] == [d.figures for d in there.front]
    assert front_of((spread, lambda rig: droop(rig)), workers=2).objectives[1] == "<lambda>"


@pytest.mark.parametrize(
    "objectives", [(droop,), (droop, droop), ("entropy", "beauty"), ("entropy",)]
)
def test_objectives_that_are_none_are_refused(objectives):
    with pytest.raises(pe.InputError, match=r"front\.objectives"):
        pt.FrontJob(study(()), 1, objectives=objectives)
