"""Languages of what users read: one catalogue for Blender's interface and the review page.

The engine writes English, and English is what files keep. A text is translated where it is shown.
So a stored warning or a result of another machine is shown in the reader's language, too.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from .catalog import Catalog, Style
from .html_text import texts_of, translated_html
from .po_file import PLACEHOLDER, placeholders, read_po

__all__ = [
    "ENGLISH",
    "FOLDER",
    "LANGUAGES",
    "LOCALES",
    "PLACEHOLDER",
    "STYLES",
    "Catalog",
    "catalog",
    "language_of_locale",
    "placeholders",
    "read_po",
    "texts_of",
    "translated_html",
]

FOLDER = Path(__file__).parent
ENGLISH = "en"
LANGUAGES = {"de": "Deutsch", "ja": "日本語", "zh": "简体中文"}
"""Codes of the languages that there is a catalogue of, and their own names."""
LOCALES = {"de": "de", "ja": "ja", "zh_HANS": "zh", "zh_CN": "zh"}
"""How Blender's locales begin, and their languages. zh_HANT, traditional Chinese, has none."""
ASIAN = Style(
    {".": "。", ":": "：", ";": "；", "?": "？", "!": "！", ",": "、"},
    list_comma="、",
    list_and="、",
    sentence_gap="",
)
STYLES = {"de": Style(list_and=" und "), "ja": ASIAN, "zh": ASIAN}


def language_of_locale(locale: str) -> str:
    """Return the language of a locale of Blender's; English where there is no catalogue."""
    starts = (start for start in LOCALES if locale == start or locale.startswith(f"{start}_"))
    return LOCALES[start] if (start := next(starts, "")) else ENGLISH


@cache
def catalog(language: str) -> Catalog:
    """Return the catalogue of a language, read once; an empty one for English."""
    if language == ENGLISH:
        return Catalog({})
    return Catalog(read_po(FOLDER / f"{language}.po"), STYLES[language])
