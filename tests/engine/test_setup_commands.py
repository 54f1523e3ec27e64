"""What installs and builds: `pe doctor`, and the tools behind `make`."""

import json
import sys
import tomllib

import numpy as np

from pe_core.version import __version__
from pe_tools.cli import doctor_verb
from pe_tools.cli.doctor_verb import PACKAGES, extra_text
from pe_tools.cli.verbs import main
from tests.engine.test_docs import ROOT

sys.path.insert(0, str(ROOT / "tools"))

FOR_DEVELOPERS = {"test", "release", "dev", "docs", "bench"}


def offered_extras():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    return project["optional-dependencies"]


def test_the_extras_are_those_that_the_project_offers():
    offered = offered_extras()
    assert set(PACKAGES) == set(offered) - FOR_DEVELOPERS
    for extra, packages in PACKAGES.items():
        needed = {need.split(">")[0].split("=")[0].split("<")[0] for need in offered[extra]}
        assert needed == set(packages), extra


def test_versions_and_what_is_missing_are_said(monkeypatch):
    versions = {"pycollada": "0.9.3", "usd-core": "25.5"}
    monkeypatch.setattr(doctor_verb, "_version", versions.get)
    assert extra_text("meshes") == "pycollada 0.9.3, usd-core 25.5"
    del versions["usd-core"]
    assert extra_text("meshes") == 'missing: pip install "perception-entropy[meshes]"'


def fake_blender(folder, text):
    path = folder / "blender"
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


def doctor(capsys, *more):
    assert main(["doctor", *more]) == 0
    return capsys.readouterr().out


def test_the_doctor_finds_blender_and_hides_the_home_folder(tmp_path, monkeypatch, capsys):
    fake_blender(tmp_path, "echo 'Blender 4.5.1 LTS'")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("BLENDER", raising=False)
    found = json.loads(doctor(capsys, "--json"))
    assert found["blender"] == "~/blender" and found["processors"] >= 1
    assert found["perception_entropy"] == __version__ and found["numpy"] == np.__version__
    assert found["python"].startswith(".".join(map(str, sys.version_info[:3])))
    monkeypatch.setenv("BLENDER", "/nowhere/blender-5")
    assert "none: /nowhere/blender-5 is no program" in doctor(capsys)
