"""The JSON Schemas of docs/schemas: of the declarations, true of files, strict as the reader."""

import json
import re
import sys
import tomllib
from collections import defaultdict

import jsonschema
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.table_reader import Table
from tests.engine.test_docs import ROOT
from tests.engine.test_docs_examples import files_of_a_reader

sys.path.insert(0, str(ROOT / "tools"))
import schemas

MADE = schemas.pages()
STUDY_SCHEMA, RESULT_SCHEMA = map(json.loads, MADE.values())
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


def keys_read(monkeypatch):
    """Keys that the reader asks for in each table, by its path, over all examples."""
    asked = defaultdict(set)

    def noted(self, key, default=schemas.REQUIRED):
        asked[re.sub(r"\[\d+\]", "", self.path)].add(key)
        return raw(self, key, default)

    raw = Table.raw
    monkeypatch.setattr(Table, "raw", noted)
    for path in READ:
        pe.load_study(path)
    return asked


def tables_of(schema, path=""):
    """Yield path and properties of each table whose keys the schema knows."""
    if "items" in schema:
        yield from tables_of(schema["items"], path)
    elif schema.get("additionalProperties") is False:
        yield path, set(schema["properties"])
        for key, inner in schema["properties"].items():
            yield from tables_of(inner, f"{path}.{key}" if path else key)


def test_the_files_are_what_the_tool_makes():
    assert {p.name: p.read_text("utf-8") for p in schemas.FOLDER.iterdir()} == MADE


def test_the_schema_of_a_study_has_the_keys_that_the_reader_asks_for(monkeypatch):
    asked, known = keys_read(monkeypatch), dict(tables_of(STUDY_SCHEMA))
    unknown = {path: left for path in known if (left := asked[path] - known[path])}
    assert not {path: left for path, left in unknown.items() if path}, unknown
    # Where a table was read, whatever the schema has beside was asked for only where it stands.
    at_times = {"ap", "boxes", "grid", "origin", "space", "density", "classes", "class", "options"}
    at_times |= {"objects", "reference", "covers", "model", "preset", "area"}
    left = {path: known[path] - asked[path] - at_times for path in known if asked[path]}
    assert not {path: keys for path, keys in left.items() if keys}
    assert len([path for path in known if asked[path]]) > 20


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
