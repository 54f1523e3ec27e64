"""Where sensors may go, and the built rig, on the page."""

from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import search
from pe_tools.jobs import BuiltJob, RegionJob
from pe_tools.page import ReportContext
from pe_tools.page.sections.mounting import as_built, free_regions
from tests.engine import shapes
from tests.engine.processes import finished


@pytest.fixture(scope="module")
def study():
    car = shapes.box_car()
    lidar = pe.Sensor("roof", shapes.small_lidar(4, 30), pe.Pose((0.4, 0.0, 1.6), (0, 0, 0)))
    mount = search.SurfaceMount(car.part_names, standoff=0.1)
    mounting = search.Mounting({"top": mount}, {"roof": "top"})
    base = pe.Study(pe.Rig([lidar]), car, shapes.small_space(1.0), samples=2048)
    return replace(base, search=replace(base.search, mounting=mounting)).on_mounts()


def test_the_page_has_the_region_and_the_built_rig_or_neither(study):
    region = RegionJob(study, "roof", "blind_sector", allowed=400.0, count=20, workers=1)
    moved = study.rig["roof"].moved(pe.Pose((0.45, 0.0, 1.5), (0, 0, 0)))
    built = BuiltJob(study, pe.Rig([moved]), workers=1)
    for job in (region, built):
        for _ in job:
            pass
    bare = ReportContext("car", finished(pt.ScoreJob(study)))
    assert free_regions(bare) is None and as_built(bare) is None
    both = replace(bare, regions=(region.result,), built=built.result)
    (shown,) = free_regions(both)["regions"]
    assert "<path" in shown["picture"] and shown["tightest"]
    table = as_built(both)
    assert len(table["rows"]) == 1 and len(table["rows"][0]) == 1 + len(table["heads"])
