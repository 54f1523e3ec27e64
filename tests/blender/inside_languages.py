"""Run inside Blender: writes what its interface shows of our texts in each language, as JSON."""

import json
import sys
from pathlib import Path

import bpy
from bl_ext.user_default import perception_entropy
from bl_ext.user_default.perception_entropy import language, translation_context

CONTEXT = translation_context.CONTEXT
view = bpy.context.preferences.view
view.use_translate_interface = view.use_translate_tooltips = True


def names() -> set[str]:
    """Return the names of all that is registered."""
    names_of = translation_context.names_of
    return {text for cls in perception_entropy.CLASSES for text in names_of(cls)} - {""}


def shown(code: str) -> dict[str, object]:
    """Return what differs from our catalogue in a language, and what the same words are else."""
    locale = next(each for each in bpy.app.translations.locales if each.startswith(code))
    view.language = locale
    catalog, gettext = language.catalog(code), bpy.app.translations
    iface = gettext.pgettext_iface
    words = {each: iface(each, CONTEXT) for each in names()}
    own = {each: catalog.get(each, each) for each in words}
    others = {each: iface(each) for each in words if iface(each) not in (each, own[each])}
    return {
        "names": len(words),
        "wrong_names": {each: word for each, word in words.items() if word != own[each]},
        "other_words_of_blender": others,
    }


Path(sys.argv[-1]).write_text(json.dumps({code: shown(code) for code in language.LANGUAGES}))
