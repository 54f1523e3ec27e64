"""Sentences broken to fit a sidebar of any width, and where panels stand."""

import itertools

import bpy
import pytest

from blender_addon.panels import CLASSES, layout

SENTENCE = "the vehicle collection Sedan is excluded from the view layer: nothing of it is scored"


@pytest.mark.parametrize("size", [11.0, 22.0])
@pytest.mark.parametrize("room", [60.0, 120.0, 260.0, 2000.0])
@pytest.mark.parametrize(
    "text", [SENTENCE, "bl_ext_a_name_without_any_gap_that_is_long", "WWWW ii", ""]
)
def test_no_line_is_wider_than_its_room_and_no_word_is_lost(addon, text, room, size):
    lines = layout.wrapped_lines(text, room, size)
    blf = layout.blf  # Blender has it once bpy is there
    blf.size(0, size)
    assert all(blf.dimensions(0, line)[0] <= room for line in lines)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
    for line, after in itertools.pairwise(lines):  # as much as fits stands in a line
        joined = f"{line} {after.split()[0]}"
        assert blf.dimensions(0, joined)[0] > room


def test_sections_are_root_panels_that_can_be_moved_and_pinned(addon):
    panels = {cls.bl_idname: cls for cls in CLASSES if issubclass(cls, bpy.types.Panel)}
    roots = {name for name, cls in panels.items() if not hasattr(cls, "bl_parent_id")}
    assert {"PE_PT_prior", "PE_PT_targets", "PE_PT_search", "PE_PT_export"} <= roots
    for cls in panels.values():
        assert getattr(cls, "bl_parent_id", "PE_PT_main") in panels
