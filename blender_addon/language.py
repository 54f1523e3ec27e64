"""The add-on in the language of Blender's interface.

Blender itself translates the names of operators, panels and properties, and tooltips; it has them
from `register`. All other texts are translated by `shown` where they are drawn or reported: labels,
and sentences with figures in them, which are put together in English. Both have one catalogue,
`pe_tools.languages`, and so does the review page.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import bpy

from . import preferences
from .engine import languages
from .translation_context import CONTEXT

CONTEXTS = (CONTEXT, "*")
"""Contexts in which Blender looks a message up: ours, and that of tooltips and of categories."""
LENGTH = re.compile(r"(?<![\d.,])(\d{1,2}\.\d{1,3}) m(?![\w²³/])")
NAME = __package__ or __name__


def current() -> str:
    """Return the code of the interface's language; English if that one has no catalogue."""
    if not bpy.context.preferences.view.use_translate_interface:
        return languages.ENGLISH
    return languages.language_of_locale(bpy.app.translations.locale or "")


def shown(text: str) -> str:
    """Return a text that is drawn or reported, in the interface's language and units."""
    return with_unit(languages.catalog(current()).translated(text))


def filled(message: str, **values: object) -> str:
    """Return a message in the interface's language, with values that are not translated."""
    return languages.catalog(current()).filled(message, **values)


def draw_label(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    """Draw a label in the interface's language and units."""
    layout.label(text=shown(text), icon=icon, translate=False)


def with_unit(text: str) -> str:
    """Return a text with its lengths in the unit of the preferences: "0.35 m" as "350 mm".

    Only lengths with decimals and below 100 m are dimensions; others are distances and stay.
    """
    if getattr(preferences.stored(), "length_unit", "M") != "MM":
        return text
    return LENGTH.sub(lambda length: f"{1000.0 * float(length[1]):.0f} mm", text)


def _messages(language: str, texts: Iterable[str]) -> dict[tuple[str, str], str]:
    """Return the messages of a language without placeholders, as Blender takes them.

    With them go the translations of texts that are put together: "UN R151: cyclist beside".
    """
    catalog = languages.catalog(language)
    composed = set(texts) - catalog.plain.keys()
    messages = dict(catalog.plain) | {text: catalog.translated(text) for text in composed}
    return {(context, text): to for text, to in messages.items() for context in CONTEXTS}


def register(texts: Iterable[str]) -> None:
    """Give Blender the messages of all languages; `texts` are those of what is registered."""
    texts = tuple(texts)
    by_locale = {locale: _messages(code, texts) for locale, code in languages.LOCALES.items()}
    bpy.app.translations.register(NAME, by_locale)  # type: ignore[arg-type]  # the stub is wrong


def unregister() -> None:
    """Take the messages back."""
    bpy.app.translations.unregister(NAME)
