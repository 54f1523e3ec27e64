"""Our words in a real Blender, whose own catalogue has some of them with another meaning."""

import json
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent


@pytest.fixture(scope="module")
def shown(installed, tmp_path_factory):
    """Return what the interface shows of our texts, by language."""
    path = tmp_path_factory.mktemp("languages") / "shown.json"
    answer = installed.script(HERE / "inside_languages.py", path)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return json.loads(path.read_text())


@pytest.mark.parametrize("code", ("de", "ja", "zh"))
def test_our_word_is_shown_where_blender_has_another(shown, code):
    """More than twenty of our names are in Blender's catalogue with another translation."""
    found = shown[code]
    assert found["names"] > 400 and len(found["other_words_of_blender"]) > 20
    assert not found["wrong_names"]
