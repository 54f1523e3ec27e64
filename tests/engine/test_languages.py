"""Texts in other languages: how a composed sentence is found, and what the catalogues lack."""

import ast
import re

import pytest

from pe_tools import languages
from pe_tools.languages import Catalog
from tools import messages

GERMAN = Catalog(
    {
        "ahead": "vorn",
        "it is {gap} clear of {name}": "{name} ist {gap} entfernt",
        "best {best}, worst {worst}": "am besten {best}, am schlechtesten {worst}",
        "{zone} ({entropy} nats)": "{zone}: {entropy} nats",
        "the rig loses most without <b>{name}</b>": "am meisten fehlt <b>{name}</b>",
        "Question": "Frage",
        "behind": "hinten",
        "{n} of {m}": "{n} von {m}",
    },
    languages.STYLES["de"],
)


@pytest.mark.parametrize(
    "english, german",
    [
        ("ahead", "vorn"),
        ("Ahead.", "Vorn."),
        ("it is 0.51 m clear of ahead", "ahead ist 0.51 m entfernt"),  # a user's own name
        (
            "best ahead (2.10 nats), worst behind (3.00 nats)",
            "am besten vorn: 2.10 nats, am schlechtesten hinten: 3.00 nats",
        ),
        ("ahead and behind", "vorn und hinten"),
        ("  ahead", "  vorn"),
        ("the rig of four sensors is fine", "the rig of four sensors is fine"),  # no "{n} of {m}"
        ("3 of 4", "3 von 4"),
        ("Something else", "Something else"),
        ("81.2 %", "81.2 %"),
    ],
)
def test_a_composed_text_is_found_and_its_values_stay(english, german):
    assert GERMAN.translated(english) == german


def test_texts_of_html_are_translated_and_scripts_are_not():
    page = (
        "<script>ahead</script><li><b>Question:</b> ahead</li>"
        '<p title="ahead">The rig loses most without <b>roof</b>. <i>Behind</i></p>'
    )
    assert languages.translated_html(page, GERMAN) == (
        "<script>ahead</script><li><b>Frage:</b> vorn</li>"
        '<p title="vorn">Am meisten fehlt <b>roof</b>. <i>Hinten</i></p>'
    )


def test_locales_of_blender_have_their_languages():
    of = languages.language_of_locale
    assert [of(x) for x in ("de_DE", "ja_JP", "zh_HANS", "zh_HANT", "en_US", "")] == [
        *("de", "ja", "zh", "en", "en", "en")
    ]


def test_a_damaged_catalogue_is_told_with_its_line(tmp_path):
    path = tmp_path / "xx.po"
    path.write_text('msgid "a"\nmsgstr oops\n')
    with pytest.raises(ValueError, match=r"xx\.po: line 2: expected msgid or msgstr"):
        languages.read_po(path)


SPELLED = {*"0123456789", "0.5", "64", "6400"}
"""Figures that a language may write as a word, or with another unit: "64 million", "one"."""


@pytest.mark.parametrize("language", languages.LANGUAGES)
def test_figures_and_units_of_a_message_are_those_of_its_translation(language):
    """Digits, and units in brackets, are the same in all languages."""
    catalog = languages.catalog(language)
    wrong = []
    for message, translation in catalog.messages.items():
        plain = [languages.PLACEHOLDER.sub("", text) for text in (message, translation)]
        figures = [set(re.findall(r"\d+(?:\.\d+)?|\[(?:m|nats)\]", text)) for text in plain]
        if (figures[0] ^ figures[1]) - SPELLED:
            wrong.append((message, translation))
    assert not wrong


def test_a_new_string_of_the_code_is_found_with_its_placeholders(tmp_path):
    """Conditions give several messages; docstrings and code give none."""
    tree = ast.parse(
        '"""No message: a docstring"""\n'
        "def f(many, n, count):\n"
        '    """No message either."""\n'
        "    report(f\"{plural(n, 'sensor')} {'are' if many else 'is'} left of {count:.2f}\")\n"
        '    path = "a/b.toml"\n'
    )
    found = [*messages.nouns(tree), *messages._texts(messages.strings_of(tree))]
    assert found[:4] == [
        *("{count} sensor", "{count} sensors"),
        *("{count} are left of {count2}", "{count} is left of {count2}"),
    ]
