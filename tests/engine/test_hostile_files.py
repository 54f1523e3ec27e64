"""Files out to do harm are refused in one line: none hangs, none takes memory, none warns."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.engine.hostile_files import all_cases

GUARD_S = 300
"""Nothing is measured by this: it ends a reader that hangs, so that the test can say which."""
CASES = all_cases()


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    """How each file went, read in another process with little memory."""
    places = {}
    for name, (_, make, _) in CASES.items():
        places[name] = make(tmp_path_factory.mktemp("hostile"))
    cases = [(name, CASES[name][0], str(path)) for name, path in places.items()]
    listed = tmp_path_factory.mktemp("list") / "cases.json"
    listed.write_text(json.dumps(cases))
    command = [sys.executable, "-m", "tests.engine.hostile_reader", str(listed)]
    with subprocess.Popen(
        command, cwd=Path(__file__).parents[2], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE
    ) as child:
        try:
            out, _ = child.communicate(timeout=GUARD_S)
        except subprocess.TimeoutExpired:
            child.kill()
            out, _ = child.communicate()
    return {(told := json.loads(line))["name"]: told for line in out.splitlines()}


@pytest.mark.skipif(sys.platform != "linux", reason="limits memory and asks for it as Linux does")
@pytest.mark.parametrize("name", CASES)
def test_a_hostile_file_is_refused_in_one_line(outcomes, name):
    """One printable line that says what is wrong; files that are only odd are read."""
    assert name in outcomes, "it hung, or took the process with it"
    told, words = outcomes[name], CASES[name][2]
    assert told["how"] == ("read" if words is None else "refused"), told["line"]
    assert not told["warnings"]
    if words is not None:
        assert words in told["line"]
        assert told["line"].isprintable() and len(told["line"]) < 600
