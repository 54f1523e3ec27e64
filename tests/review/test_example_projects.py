"""The projects of examples/: complete, their studies run, and each figure of a page is a result.

If a figure differs: `make examples`; if only a page does: `make examples ARGS=--pages`.
"""

import importlib.util
import json
import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import pe_core as pe
from pe_tools.cli.verbs import main
from tests.thorough import tries

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples"
FILES = ("decided.toml", "figures.json", "review.html", "vehicle.npz")
MAX_BYTES = 12_000_000
"""Of all projects together."""
PROJECTS = sorted(path.parent.name for path in FOLDER.glob("*/decided.toml"))


def tool():
    """Return the tool that makes the projects."""
    spec = importlib.util.spec_from_file_location("examples", ROOT / "tools" / "examples.py")
    module = sys.modules["examples"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


EXAMPLES = tool()
STUDIES = [path for name in PROJECTS for path in EXAMPLES.studies_of(name)]
RECOMPUTED = [path for path in STUDIES if path.stem == "1_roof"][-tries(1, 4) :]
"""Studies whose figures, verdicts among them, are computed; `make examples` computes all."""


def kept(name):
    """Return the figures of a project, by study."""
    return json.loads((FOLDER / name / "figures.json").read_text("utf-8"))


def by_name(path):
    """Return a study's name in the list of tests."""
    return f"{path.parent.name}-{path.stem}"


def test_there_are_four_and_all_together_are_small():
    assert set(PROJECTS) == set(EXAMPLES.SHOWN) and len(PROJECTS) == 4
    files = (path for path in FOLDER.rglob("*") if path.is_file())
    assert sum(path.stat().st_size for path in files) < MAX_BYTES


@pytest.mark.parametrize("name", PROJECTS)
def test_a_project_is_complete(name):
    assert all((FOLDER / name / file).is_file() for file in (*FILES, f"{name}.blend"))
    assert len(EXAMPLES.tried(name)) >= 3
    studies = {path.stem for path in EXAMPLES.studies_of(name)}
    assert studies == {study.partition(",")[0] for study in kept(name)}


@pytest.mark.parametrize("name", PROJECTS)
def test_the_page_has_the_figures_of_the_studies(name):
    page = (EXAMPLES.PAGES / f"{name}.md").read_text("utf-8")
    assert len(EXAMPLES.MARK.findall(page)) == page.count("<!--=") > 5
    assert "--><!--/-->" not in page
    assert not re.search("^ *<!--=(?!table)", page, re.MULTILINE)  # there it would end a paragraph
    assert EXAMPLES.with_figures(page, kept(name)) == page


@pytest.mark.parametrize("name", PROJECTS)
def test_a_figure_that_differs_is_told_from_the_page_s(name):
    """The comparison above can fail: another figure makes another page."""
    page = (EXAMPLES.PAGES / f"{name}.md").read_text("utf-8")
    others = {study: {key: "0" for key in own} for study, own in kept(name).items()}
    assert EXAMPLES.with_figures(page, others).count("-->0<!--/-->") > 4


@pytest.mark.parametrize("path", RECOMPUTED, ids=by_name)
def test_figures_are_those_of_the_study(path):
    result = EXAMPLES.scored(path)
    assert EXAMPLES.figures_of(result) == kept(path.parent.name)[path.stem]
    for turned in EXAMPLES.in_states(result):
        assert EXAMPLES.figures_of(turned) == kept(path.parent.name)[turned.name]


@pytest.mark.parametrize("name", PROJECTS)
def test_what_was_decided_sees_more_than_the_first(name):
    paths = EXAMPLES.studies_of(name)
    first, last = (replace(pe.load_study(paths[k]), samples=2048) for k in (0, -1))
    scores = [study.evaluator().score(study.rig) for study in (first, last)]
    assert scores[1].entropy < scores[0].entropy
    assert scores[1].coverage > scores[0].coverage
    assert first.requirements == last.requirements and len(last.rig) > len(first.rig)


def test_the_command_says_what_the_page_says_of_requirements():
    path = FOLDER / "delivery_shuttle" / "decided.toml"
    met, _, total = kept(path.parent.name)[path.stem]["met"].partition(" of ")
    assert main(["check", str(path)]) == (0 if met == total else 3)
