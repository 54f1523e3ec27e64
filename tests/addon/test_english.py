"""The panel is English in a Blender of any language: nothing is looked up in its catalogue."""

import ast
from pathlib import Path

import bpy

import blender_addon
from blender_addon.preferences import english
from blender_addon.preferences.english import CONTEXT

WITH_CONTEXT = {"operator", "prop", "operator_menu_enum", "prop_search", "prop_menu_enum"}
"""What is drawn of a type or property: a text that is written there is looked up in its context."""
OTHERS = {"label", "menu", "popover", "progress", "invoke_props_dialog", "invoke_confirm"}
TEXTS = {"text", "title", "confirm_text", "message"}


def rna_of(cls):
    """Return the type as Blender has it; of an operator, its own."""
    if issubclass(cls, bpy.types.Operator):
        return getattr(bpy.ops.pe, cls.bl_idname.removeprefix("pe.")).get_rna_type()
    return cls.bl_rna


def test_every_name_is_looked_up_in_our_context_where_blender_has_no_word(addon):
    """In contexts of its own Blender translates "Range" and "Key"."""
    labelled = [c for c in blender_addon.CLASSES if issubclass(c, english.LABELLED)]
    assert len(labelled) > 60
    assert {cls.bl_translation_context for cls in labelled} == {CONTEXT}
    operators = [cls for cls in labelled if issubclass(cls, bpy.types.Operator)]
    assert {rna_of(cls).translation_context for cls in operators} == {CONTEXT}
    for cls in blender_addon.CLASSES:
        declared = english.own_properties(cls).keys() - {"name"}  # Blender's own name
        contexts = {each: rna_of(cls).properties[each].translation_context for each in declared}
        assert set(contexts.values()) <= {CONTEXT}, (cls, contexts)


def is_written_there(node):
    """Whether a text is a literal, or one of two."""
    if isinstance(node, ast.IfExp):
        return is_written_there(node.body) and is_written_there(node.orelse)
    return isinstance(node, ast.Constant)


def left_to_blender(tree):
    """Yield calls that draw a text which Blender looks up in a context of its own."""
    for node in ast.walk(tree):
        called = getattr(getattr(node, "func", None), "attr", "")
        if called not in WITH_CONTEXT | OTHERS:
            continue
        given = {keyword.arg: keyword.value for keyword in node.keywords}
        if {"translate", "text_ctxt"} & given.keys():
            continue
        for text in (given[name] for name in TEXTS & given.keys()):
            is_empty = isinstance(text, ast.Constant) and not text.value
            if not is_empty and not (called in WITH_CONTEXT and is_written_there(text)):
                yield ast.unparse(node)


def test_no_text_is_left_to_blender_s_own_catalogue():
    """It would also translate a sensor that is named Front."""
    found = left_to_blender(ast.parse('layout.label(text="Range"); row.operator("a", text=name)'))
    assert len(list(found)) == 2
    package = Path(blender_addon.__file__).parent
    for path in package.rglob("*.py"):
        if not {"pe_core", "pe_tools"} & set(path.relative_to(package).parts):
            assert not list(left_to_blender(ast.parse(path.read_text("utf-8")))), path
