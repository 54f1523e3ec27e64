"""The panel in the language of Blender's interface.

Names of operators, panels, properties and items of menus, and short labels, have a catalogue
(``languages/*.po``). Blender looks up the names; `shown` looks up what is drawn as a label.
Sentences, messages, files and the review page are English: a text without a translation is shown
as it is.
"""

import ast
import re
from functools import cache
from pathlib import Path

import bpy

from .choices import SIMPLE
from .engine import pe
from .translation_context import CONTEXT

FOLDER = Path(__file__).parent / "languages"
LANGUAGES = {"de": "Deutsch", "ja": "日本語", "zh": "简体中文"}
"""Codes of the languages that there is a catalogue of, and their own names."""
LOCALES = {"de": "de", "ja": "ja", "zh_HANS": "zh", "zh_CN": "zh"}
"""How Blender's locales begin, and their languages. zh_HANT, traditional Chinese, has none."""
CONTEXTS = (CONTEXT, "*")
"""Contexts in which Blender looks a message up: ours, and that of tooltips and of categories."""
NAME = __package__ or __name__


def read_po(path: Path) -> dict[str, str]:
    """Return the translations of a gettext file by message; those that are empty are left out.

    Contexts and plural forms are not used.

    `InputError` when a line is none of such a file, or the file is not in UTF-8.
    """
    try:
        lines = path.read_text("utf-8").splitlines()
    except UnicodeDecodeError:
        raise pe.InputError(path, "text", "UTF-8", "another encoding") from None
    entries: list[dict[str, str]] = [{}]
    key = ""
    for number, line in enumerate(map(str.strip, lines), 1):
        if not line or line.startswith("#"):
            continue
        if line.startswith(("msgid ", "msgstr ")):
            key, _, line = line.partition(" ")
            if key == "msgid":
                entries.append({})
        try:
            text = ast.literal_eval(line)
        except (ValueError, SyntaxError):
            text = None
        if not isinstance(text, str) or not key:
            expected = "msgid or msgstr with a text in quotes"
            raise pe.InputError(path, f"line {number}", expected, line)
        entries[-1][key] = entries[-1].get(key, "") + text
    pairs = ((entry.get("msgid"), entry.get("msgstr")) for entry in entries)
    return {message: to for message, to in pairs if message and to}


@cache
def catalog(language: str) -> dict[str, str]:
    """Return the translations of a language, read once; none for English."""
    return read_po(FOLDER / f"{language}.po") if language in LANGUAGES else {}


def current() -> str:
    """Return the code of the interface's language; empty for English and all without catalogue."""
    if not bpy.context.preferences.view.use_translate_interface:
        return ""
    return language_of_locale(bpy.app.translations.locale or "")


def language_of_locale(locale: str) -> str:
    """Return the language of a locale of Blender's; empty where there is no catalogue."""
    starts = (start for start in LOCALES if locale == start or locale.startswith(f"{start}_"))
    return LOCALES.get(next(starts, ""), "")


def shown(text: str) -> str:
    """Return a text that is drawn or reported, in the interface's language."""
    return catalog(current()).get(text, text).replace(" m2", " m²").replace("[m2]", "[m²]")


PLAIN = (
    (r" (?:nats\b|\[nats\])", ""),
    (r"\b(?:Perception entropy|Entropy)\b", "Score"),
    (r"\b(?:perception entropy|entropy)\b", "score"),
    (r"\bof the prior\b", "of where objects are expected"),
)
"""Words of the metric, and those that *Simple* has in sentences instead."""


def plain(text: str) -> str:
    """Return a sentence in plain words."""
    for term, word in PLAIN:
        text = re.sub(term, word, text)
    return text


def is_simple(scene: bpy.types.Scene) -> bool:
    """Whether the tab has the panels of the first hour alone, and plain words."""
    return scene.perception_entropy.panels == SIMPLE


def worded(scene: bpy.types.Scene, text: str) -> str:
    """Return a text in the interface's language, and in plain words in *Simple*."""
    return plain(shown(text)) if is_simple(scene) else shown(text)


def draw_label(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    """Draw a label in the interface's language."""
    layout.label(text=shown(text), icon=icon, translate=False)


def register() -> None:
    """Give Blender the messages of all languages."""
    by_locale = {
        locale: {(context, text): to for text, to in catalog(code).items() for context in CONTEXTS}
        for locale, code in LOCALES.items()
    }
    bpy.app.translations.register(NAME, by_locale)  # type: ignore[arg-type]  # the stub is wrong


def unregister() -> None:
    """Take the messages back."""
    bpy.app.translations.unregister(NAME)
