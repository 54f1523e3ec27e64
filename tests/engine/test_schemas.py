"""The JSON Schemas of docs/schemas: of the declarations, true of files, strict as the reader."""

import json
import sys
import tomllib

import jsonschema
import pytest

import pe_core as pe
import pe_tools as pt
from tests.engine.test_docs import ROOT
from tests.engine.test_docs_examples import files_of_a_reader

sys.path.insert(0, str(ROOT / "tools"))
import schemas

MADE = schemas.pages()
STUDY_SCHEMA, RESULT_SCHEMA, _ = map(json.loads, MADE.values())
STUDIES = sorted(
    path
    for folder in ("examples", "blend_assets")
    for path in (ROOT / folder).rglob("*.toml")
    if "plugin" not in path.parts
)
READ = [path for path in STUDIES if path.stem in ("4_tail", "1_pandar64")]
"""Those that are read: of them all kinds of tables are known."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("study")
    files_of_a_reader(made, "")
    return made


def test_the_files_are_what_the_tool_makes():
    assert {p.name: p.read_text("utf-8") for p in schemas.FOLDER.iterdir()} == MADE


@pytest.mark.parametrize("path", STUDIES, ids=lambda p: p.relative_to(ROOT).as_posix())
def test_examples_are_valid_as_written_by_hand_and_by_the_program(path):
    jsonschema.validate(tomllib.loads(path.read_text("utf-8")), STUDY_SCHEMA)
    if path in READ:
        jsonschema.validate(pe.study_to_dict(pe.load_study(path)), STUDY_SCHEMA)


@pytest.mark.parametrize("made", [pt.ScoreJob, pt.OptimizeJob], ids=["score", "optimize"])
def test_results_are_valid_and_a_changed_type_is_not(made, folder):
    job = made(pe.load_study(folder / "study.toml"), workers=1)
    data = pt.result_dict(job.run())
    jsonschema.validate(data, RESULT_SCHEMA)
    for key in ("entropy", "before", "inputs"):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**data, key: "text"}, RESULT_SCHEMA)
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({k: v for k, v in data.items() if k != key}, RESULT_SCHEMA)
    jsonschema.validate({**data, "later": 1}, RESULT_SCHEMA)  # as the promise says
