"""Run inside Blender: writes what the extension shows, registers and leaves behind, as JSON."""

import json
import sys
from pathlib import Path

import addon_utils
import bpy
from bl_ext.user_default import perception_entropy
from bl_ext.user_default.perception_entropy.preferences import english

ADDON = "bl_ext.user_default.perception_entropy"
OPERATORS = ("add_sensor", "score", "optimize", "export_file", "import_file")


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
    """Return the labels of all classes, and the names of their properties and items of menus."""
    texts = {getattr(cls, "bl_label", "") for cls in perception_entropy.CLASSES}
    for cls in perception_entropy.CLASSES:
        for declared in english.own_properties(cls).values():
            items = declared.keywords.get("items", ())
            texts |= {declared.keywords.get("name", "")}
            texts |= set() if callable(items) else {item[1] for item in items}
    return texts - {""}


def translated(code: str) -> dict[str, object]:
    """Return our names that Blender translates in a language: in our context, and in its own."""
    view.language = next(each for each in bpy.app.translations.locales if each.startswith(code))
    iface = bpy.app.translations.pgettext_iface
    return {
        "names": len(names()),
        "in_our_context": [each for each in names() if iface(each, english.CONTEXT) != each],
        "in_blender_s": [each for each in names() if iface(each) != each],
    }


view = bpy.context.preferences.view
view.use_translate_interface = view.use_translate_tooltips = True
report = {"translated": {code: translated(code) for code in ("de", "ja", "zh")}}
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
