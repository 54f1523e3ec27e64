"""What verbs print with ``--json`` is one document as its schema says; the help is data, too."""

import json
import re
import shutil

import jsonschema
import pytest

from pe_tools.cli.terminal import EXIT_STATUSES
from pe_tools.cli.verbs import VERBS
from tests.engine.processes import pe
from tests.engine.test_docs import ROOT
from tests.engine.test_docs_examples import files_of_a_reader

FEW = ("--set", "optimize.samples=1024", "--evaluations", "4")
CALLS = {
    "new": [
        ["car.glb", "-o", "new.toml", "--replace"],
        ["--rig"],
        ["--rig", "nuscenes"],
        ["--rig", "nuscenes", "-o", "known.toml", "--replace"],
    ],
    "set": [["set.toml", "sensor.roof.name=top", "optimize.seed=3"]],
    "sensors": [[], ["Pandar64"], ["--curves"]],
    "score": [["study.toml"]],
    "explain": [
        ["study.toml"],
        ["study.toml", "--at", "3", "1"],
        ["study.toml", "--at", "3", "1", "--body", "child"],
    ],
    "check": [["study.toml"], ["--list"]],
    "compare": [["study.toml", "car.toml"]],
    "where": [["study.toml", "--model", "Velodyne VLP-16 Puck", "--places", "3"]],
    "optimize": [["study.toml", *FEW, "--method", "random", "-o", "results", "--no-review"]],
    "sweep": [["study.toml", "--set", "optimize.seed=1,2", "-o", "swept"]],
    "review": [["study.toml", "-o", "page", "--replace"]],
    "export": [["study.toml", "-o", "rig.urdf", "--replace"], ["study.toml", "--to", "line"]],
    "import": [["rig.urdf", "--model", "roof=Velodyne VLP-16 Puck", "-o", "in.toml", "--replace"]],
}
"""Calls of each verb in all forms of its answer; `serve` and `verify` have their own tests."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("answers")
    files_of_a_reader(made, "")
    shutil.copy(made / "study.toml", made / "set.toml")
    return made


@pytest.fixture(scope="module")
def described():
    return json.loads(pe(["--help", "--json"]).stdout)


@pytest.mark.parametrize("verb", CALLS)
def test_each_verb_prints_one_document_as_its_schema_says(verb, folder, described, monkeypatch):
    monkeypatch.chdir(folder)
    schema = described["answers"]
    for arguments in CALLS[verb]:
        answer = pe([verb, *arguments, "--json"])
        assert answer.returncode in (0, 3), answer.stderr
        data = json.loads(answer.stdout)
        jsonschema.validate({verb: data}, schema)
        for path in data.get("written", ()):
            assert (folder / path).exists()
        without = {
            key: value for key, value in data.items() if key not in required_keys(verb, schema)
        }
        if without != data:
            with pytest.raises(jsonschema.ValidationError):
                jsonschema.validate({verb: without}, schema)


def required_keys(verb, schema):
    """Keys that one of the forms of a verb's answer must have."""
    own = schema["properties"][verb]
    names = [each["$ref"].rpartition("/")[2] for each in own.get("anyOf", [own])]
    return {key for name in names for key in schema["$defs"][name]["required"]}


def test_the_help_as_data_is_that_of_the_parser(described):
    assert [each["name"] for each in described["verbs"]] == [verb.name for verb in VERBS]
    assert described["answers"]["properties"].keys() == {verb.name for verb in VERBS}
    assert described["exit_statuses"] == {str(n): text for n, text in EXIT_STATUSES.items()}
    verbs = {each["name"]: each["arguments"] for each in described["verbs"]}
    for name, arguments in verbs.items():
        shown = pe([name, "--help"]).stdout
        flags = {flag for each in arguments for flag in each["flags"]}
        printed = set(re.findall(r"(?m)^  (?:-\w(?: [^,\n]+)?, )?(--[\w-]+)", shown))
        assert {flag for flag in flags if flag.startswith("--")} == printed - {"--help"}, name
        own = json.loads(pe([name, "--help", "--json"]).stdout)
        assert [each["arguments"] for each in own["verbs"]] == [arguments]
        assert own["answers"]["properties"].keys() == {name}
    at = next(each for each in verbs["explain"] if each["name"] == "at")
    assert (at["value"], at["several"], at["required"]) == ("X Y Z", True, False)
    (study, *_) = verbs["score"]
    assert (study["flags"], study["required"]) == ([], True)


def test_exit_statuses_of_the_docs_are_those_of_the_table():
    text = (ROOT / "docs" / "results.md").read_text("utf-8").partition("## Exit statuses")[2]
    rows = re.findall(r"(?m)^\| (\d+)[^|]*\| (.*) \|$", text)
    assert {int(number): meaning for number, meaning in rows} == EXIT_STATUSES
