"""What installs and builds: `pe doctor`, and the tools behind `make`."""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tomllib

import numpy as np
import pytest

from pe_core.version import __version__
from pe_tools.cli import doctor_verb
from pe_tools.cli.doctor_verb import PACKAGES, extra_text
from pe_tools.cli.verbs import main
from tests.engine.test_docs import ROOT

sys.path.insert(0, str(ROOT / "tools"))
import release

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


def test_a_release_without_its_blenders_installs_them_or_says_how(tmp_path, monkeypatch):
    """`make release` on a fresh clone: nothing is built before all Blenders are there."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(release, "check_tree", lambda: None)
    monkeypatch.setattr(release.build_extension, "build", lambda: pytest.fail("too early"))
    monkeypatch.setattr(release.os, "geteuid", lambda: 1000)
    with pytest.raises(release.real_blender.NoBlender) as refused:
        release.release(argparse.Namespace(dirty=False, install=True, quick=True))
    assert f"sudo XDG_CACHE_HOME={tmp_path} " in str(refused.value)
    assert "tools/real_blender.py --suite trixie --install" in str(refused.value)
    assert not any(tmp_path.iterdir())


def fake_system(folder, *, has_libs, bpy_starts):
    """A checkout's tools beside a fake Python and Debian, of a user who is not root."""
    for name in ("make_venv.sh", "debian_libs.sh", "demo.sh", "real_blender.py"):
        (folder / "tools").mkdir(exist_ok=True)
        shutil.copy(ROOT / "tools" / name, folder / "tools" / name)
    said = "exit 0" if bpy_starts else "echo 'ImportError: libSM.so.6: cannot open' >&2; exit 1"
    cases = f'*"import bpy"*) {said};; *version_info*) echo 3.11;; *real_blender*) exit 1;;'
    python = f'case "$*" in {cases} esac'
    state = "echo installed" if has_libs else "exit 1"
    programs = {"dpkg-query": state, "id": "echo 1000", "sudo": "exit 1", "blender": "exit 1"}
    for path, text in {".venv/bin/python": python, **programs}.items():
        path = folder / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
    env = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}
    return lambda *command: subprocess.run(
        command, cwd=folder, env=env, capture_output=True, text=True
    )


@pytest.mark.parametrize("bpy_starts", [True, False])
def test_missing_libraries_are_named_last_and_again_by_the_next_make(tmp_path, bpy_starts):
    """The stamp was made all the same, and the demo then blamed Python."""
    run = fake_system(tmp_path, has_libs=False, bpy_starts=bpy_starts)
    for _ in range(2):
        made = run("tools/make_venv.sh", "blender", ".venv/run.stamp")
        assert made.returncode == 0 and not (tmp_path / ".venv/run.stamp").exists()
        lines = made.stderr.splitlines()
        assert "sudo apt-get install -y libx11-6" in lines[-1]
        assert ("libSM.so.6: cannot open" in lines[0]) is not bpy_starts
    if not bpy_starts:
        demo = run("tools/demo.sh")
        assert demo.returncode == 1
        assert "sudo apt-get install -y libx11-6" in demo.stderr.splitlines()[-1]
