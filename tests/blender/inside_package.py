"""Run inside Blender: writes what the extension shows, registers and leaves behind, as JSON."""

import json
import sys
from pathlib import Path

import addon_utils
import bpy
from bl_ext.user_default import perception_entropy
from bl_ext.user_default.perception_entropy import language, translation_context

ADDON = "bl_ext.user_default.perception_entropy"
CONTEXT = translation_context.CONTEXT
OPERATORS = ("add_sensor", "score", "optimize", "export_study", "render_review")


def classes() -> list[str]:
    """Return the classes of ours that Blender knows; operators go by PE_OT_, panels by PE_PT_."""
    return sorted(name for name in dir(bpy.types) if name.startswith("PE_"))


def handlers() -> list[str]:
    """Return the functions of ours that Blender calls by itself."""
    lists = (getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers))
    functions = [function for each in lists if isinstance(each, list) for function in each]
    return sorted(f.__name__ for f in functions if f.__module__.startswith(ADDON))


def properties() -> list[str]:
    """Return the types that carry a property of ours."""
    carriers = (bpy.types.Scene, bpy.types.Object, bpy.types.WindowManager)
    return [each.__name__ for each in carriers if hasattr(each, "perception_entropy")]


def operators() -> list[str]:
    """Return the operators of the contract that can be called."""
    # An operator looked up by name exists only when its type can be had.
    return [name for name in OPERATORS if f"PE_OT_{name}" in dir(bpy.types)]


def state() -> dict[str, list[str]]:
    """Return everything of ours that is registered now."""
    return {
        "classes": classes(),
        "handlers": handlers(),
        "properties": properties(),
        "operators": operators(),
    }


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


view = bpy.context.preferences.view
view.use_translate_interface = view.use_translate_tooltips = True
report = {"languages": {code: shown(code) for code in language.LANGUAGES}}
view.language = "en_US"
report["registered"] = state()
addon_utils.disable(ADDON)
report["unregistered"] = state()
addon_utils.enable(ADDON)
report["again"] = state()
report["pe_core"] = sorted(
    module.__file__ for name, module in sys.modules.items() if name.endswith(".pe_core")
)
Path(sys.argv[-1]).write_text(json.dumps(report))
