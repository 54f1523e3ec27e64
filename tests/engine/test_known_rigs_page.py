"""Known rigs as studies, and the page of their scores."""

import re
import sys
from pathlib import Path

import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_tools.cli.verbs import main

ROOT = Path(__file__).parents[2]
FEW = 16_384
SIGMAS = 4.0
"""Passes by chance all but once in 16,000 figures."""


@pytest.fixture(scope="module")
def page():
    """The page's rows by the rigs' keys: (entropy, stderr, coverage) in the open and on it."""
    rows = {}
    for line in (ROOT / "docs" / "known_rigs.md").read_text("utf-8").splitlines():
        found = re.match(r"\| .*\(`(\w+)`\) \|", line)
        if found:
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            figures = [cells[4], cells[5], cells[7], cells[8]]
            rows[found[1]] = [float(w) for cell in figures for w in cell.split(" ± ")]
    return rows


@pytest.fixture(scope="module")
def tool():
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import known_rigs
    finally:
        sys.path.remove(str(ROOT / "tools"))
    return known_rigs


def test_the_page_has_every_rig(page):
    assert set(page) == set(catalog.known_rigs())


@pytest.mark.parametrize("key", ["kitti", "paper_bus_front"])
def test_its_figures_are_those_of_a_fresh_score(page, tool, key):
    """Other voxels of another number: apart by no more than both standard errors allow."""
    fresh = tool.scored(key, FEW)
    for score, told in ((fresh.open, page[key][:3]), (fresh.on_vehicle, page[key][3:])):
        entropy, stderr, coverage = told
        apart = SIGMAS * (score.stderr**2 + stderr**2) ** 0.5
        assert score.entropy == pytest.approx(entropy, abs=apart)
        assert 100.0 * score.coverage == pytest.approx(coverage, abs=5.0)
        assert apart < 0.1 * entropy, "a band that would tell another rig's figure apart"


@pytest.mark.parametrize("key", catalog.known_rigs())
def test_each_is_a_study_that_reads_back(key, tmp_path, capsys):
    assert main(["rigs", key, "-o", str(tmp_path / "study.toml")]) == 0
    assert "as published" in capsys.readouterr().err
    study = pe.load_study(tmp_path / "study.toml")
    found, rig = study.rig, catalog.known_rig(key)
    assert study.samples == FIRST_SAMPLES, "seconds, not 64 million voxels"
    assert [s.name for s in found] == [s.name for s in rig.sensors]
    for ours, theirs in zip(rig.sensors, found, strict=True):
        assert theirs.model is catalog.load(ours.model)
        assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-9)
        assert theirs.pose.rotation_deg == pytest.approx(ours.pose.rotation_deg, abs=1e-9)


def test_the_command_lists_tells_and_stretches(tmp_path, capsys):
    assert main(["rigs"]) == 0
    listed = capsys.readouterr().out
    assert all(key in listed for key in catalog.known_rigs())
    assert main(["rigs", "nuscenes"]) == 0
    assert "Source" not in (said := capsys.readouterr().out) and "source   nuScenes" in said
    mesh = ROOT / "blend_assets" / "bus.npz"
    command = ["rigs", "nuscenes", "-o", str(tmp_path / "study.toml"), "--mesh", str(mesh)]
    assert main(command) == 0
    assert "stretched onto this vehicle's box" in capsys.readouterr().err
    study = pe.load_study(tmp_path / "study.toml")
    top = study.vehicle.bounds[1][2]
    assert study.rig["LIDAR_TOP"].pose.position[2] == pytest.approx(top + 1.8402 - 1.562, abs=1e-4)
    assert main(command) == 1 and "an existing file" in capsys.readouterr().err
    assert main([*command, "--replace", "--as-published"]) == 0
    rig = pe.load_study(tmp_path / "study.toml").rig
    assert rig["LIDAR_TOP"].pose.position == (-0.4363, 0.0, 1.8402)
    assert main(["rigs", "zoe"]) == 1
    assert "rig: expected one of" in capsys.readouterr().err
