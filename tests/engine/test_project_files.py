"""Citation, forms, workflows, Dockerfiles, and the lines that a bare machine is given."""

import re
import sys

import pytest
from ruamel.yaml import YAML

from pe_core.version import __version__
from tests.engine.test_docs import ROOT

sys.path.insert(0, str(ROOT / "tools"))
import fresh_machine

GITHUB = ROOT / ".github"


def read(path):
    return YAML(typ="safe").load(path.read_text("utf-8"))


def test_the_citation_is_of_this_version_and_of_the_paper():
    cited = read(ROOT / "CITATION.cff")
    assert cited["version"] == __version__ and cited["license"] == "GPL-3.0-or-later"
    paper = cited["preferred-citation"]
    assert [each["family-names"] for each in paper["authors"]] == ["Ma", "Liu", "Li"]
    assert paper["title"] in (ROOT / "README.md").read_text("utf-8")


def test_workflows_do_what_the_makefile_does_and_cover_all_systems():
    steps = {}
    for path in (GITHUB / "workflows").glob("*.yml"):
        (job,) = read(path)["jobs"].values()
        steps[path.stem] = "\n".join(step.get("run", "") for step in job["steps"])
    assert "make lint" in steps["linux"] and "make test" in steps["linux"]
    for folder in re.findall(r"tests/\w+", steps["windows_macos"]):
        assert (ROOT / folder).is_dir()
    assert "tests/addon" in steps["windows_macos"] and "tests/engine" in steps["windows_macos"]


def test_the_lines_of_readme_are_those_that_a_newcomer_types():
    lines = fresh_machine.lines_of_readme((ROOT / "README.md").read_text("utf-8"))
    assert lines[0].startswith("apt-get update && apt-get install -y make python3-venv libx11-6")
    assert {"make demo", "make test", "make extension", "pip install ."} < set(lines)
    needed = re.search(
        r"BPY_LIBS=\(\s*(.*?)\s*\)", (ROOT / "tools/debian_libs.sh").read_text(), re.S
    )
    assert set(needed[1].split()) <= set(lines[0].split())


@pytest.mark.parametrize("name", ["pe", "blender"])
def test_dockerfiles_begin_with_debian_and_end_with_their_command(name):
    text = (ROOT / "containers" / f"{name}.Dockerfile").read_text("utf-8")
    steps = list(fresh_machine.instructions(text))
    assert steps[0] == ("FROM", "debian:trixie-slim")
    assert steps[-1][0] == "ENTRYPOINT" and f'"{name}"' in steps[-1][1]
    assert ("COPY", ". /src") in steps
