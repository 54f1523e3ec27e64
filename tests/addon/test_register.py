"""Registering, unregistering, and what is left behind: nothing."""

import bpy

import blender_addon


def traces() -> dict[str, list[str]]:
    """Return everything of ours that Blender knows."""
    lists = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    functions = [f for each in lists.values() if isinstance(each, list) for f in each]
    carriers = (bpy.types.Scene, bpy.types.Object, bpy.types.WindowManager)
    return {
        "classes": [name for name in dir(bpy.types) if name.startswith("PE_")],
        "handlers": [f.__name__ for f in functions if f.__module__.startswith("blender_addon")],
        "properties": [c.__name__ for c in carriers if hasattr(c, "perception_entropy")],
    }


def test_register_unregister_register_leaves_nothing_behind():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    before = traces()
    assert not any(before.values())
    blender_addon.register()
    registered = traces()
    blender_addon.unregister()
    assert traces() == before
    blender_addon.register()
    assert traces() == registered
    blender_addon.unregister()
    assert traces() == before


def test_all_that_is_documented_is_there(addon):
    found = traces()
    operators = ("add_sensor", "score", "optimize", "cancel", "export_study", "render_review")
    operators += ("add_focus", "remove_focus")
    assert {f"PE_OT_{name}" for name in operators} <= set(found["classes"])
    assert found["properties"] == ["Scene", "Object"]


def test_handlers_outlive_a_new_file(addon):
    before = traces()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert traces() == before


def test_every_class_and_property_is_described(addon):
    for cls in blender_addon.CLASSES:
        if cls.__name__.startswith("PE_OT"):
            assert getattr(bpy.ops.pe, cls.bl_idname[3:]).get_rna_type().description, cls
        for prop in cls.bl_rna.properties:
            if cls.__name__.endswith("Settings") and prop.identifier not in ("rna_type", "name"):
                assert prop.description and not prop.description.endswith("."), prop.identifier
