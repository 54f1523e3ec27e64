"""Files out to do harm are refused in one line: none hangs, none takes memory, none warns."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import pe_core as pe
from pe_tools.formats.xml_text import parse_xml
from pe_tools.formats.yaml_text import parse_yaml
from tests.engine.hostile_files import all_cases, laughs
from tests.limits import HANG_S

"""Nothing is measured by this: it ends a reader that hangs, so that the test can say which."""


def outcomes_of(cases, new_folder):
    """How each file went, read in another process with little memory."""
    places = {name: make(new_folder("hostile")) for name, (_, make, _) in cases.items()}
    listed = new_folder("list") / "cases.json"
    listed.write_text(json.dumps([(name, cases[name][0], str(places[name])) for name in cases]))
    command = [sys.executable, "-m", "tests.engine.hostile_reader", str(listed)]
    with subprocess.Popen(
        command, cwd=Path(__file__).parents[2], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE
    ) as child:
        try:
            out, _ = child.communicate(timeout=HANG_S)
        except subprocess.TimeoutExpired:
            child.kill()
            out, _ = child.communicate()
    return {(told := json.loads(line))["name"]: told for line in out.splitlines()}


def fault_of(told, words):
    """What is wrong with how a file went; None where it went as its case says."""
    if told is None:
        return "it hung, or took the process with it"
    if told["how"] != ("read" if words is None else "refused"):
        return f"{told['how']}: {told['line']}"
    if told["warnings"]:
        return f"it warned: {told['warnings']}"
    line = told["line"]
    if words is not None and not (words in line and line.isprintable() and len(line) < 600):
        return f"expected one line with {words!r}, found {line!r}"
    return None


@pytest.mark.skipif(sys.platform != "linux", reason="limits memory and asks for it as Linux does")
def test_hostile_files_are_refused_in_one_line(tmp_path_factory):
    """One printable line that says what is wrong; files that are only odd are read."""
    cases = all_cases()
    assert len(cases) > 100
    outcomes = outcomes_of(cases, tmp_path_factory.mktemp)
    faults = {name: fault_of(outcomes.get(name), words) for name, (_, _, words) in cases.items()}
    assert {name: fault for name, fault in faults.items() if fault} == {}


@pytest.mark.parametrize(
    ("parse", "text", "words"),
    [
        (parse_xml, laughs().encode(), "XML without definitions"),
        (parse_xml, laughs().encode("utf-16"), "expected"),
        (parse_xml, b'<!DOCTYPE a [<!ENTITY x SYSTEM "/dev/zero">]><a>&x;</a>', "definitions"),
        (parse_xml, b"<a>" * 100_000, "elements at most 100 deep"),
        (parse_yaml, "a:\n- " + "{" * 100_000, "too many levels"),
        (parse_yaml, "a: " + "9" * 1_000_000, "YAML of at most 262,144 characters"),
        (parse_yaml, "a: &x [1]\nb: *x\n", "YAML without aliases"),
    ],
)
def test_texts_that_unfold_are_refused_in_one_line(parse, text, words):
    with pytest.raises(pe.InputError, match=words) as caught:
        parse("file", text)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 600
