"""Rows of the panel's lists: four operators add, remove, copy and move a row of any list."""

import bpy
import pytest

from blender_addon.operators import ROW_LISTS
from blender_addon.properties import INDEX_OF


def rows_of(scene, name):
    """The rows of a list, of the scene or of the selected sensor."""
    return getattr(ROW_LISTS[name].owner(bpy.context), name)


def add(name, **kind):
    """Add a row by the button of its list."""
    if ROW_LISTS[name].add is None:
        return bpy.ops.pe.save_variant()
    return bpy.ops.pe.add_row(rows=name, **kind)


@pytest.fixture
def selected(car):
    """The car with its LiDAR selected."""
    bpy.context.view_layer.objects.active = car.objects["roof"]
    return car


def test_each_list_adds_and_removes_a_row_and_selects_one_that_is_left(selected):
    assert set(INDEX_OF) <= set(ROW_LISTS), "a list of the panel has its buttons"
    for name, rows in ROW_LISTS.items():
        assert bpy.ops.pe.remove_row(rows=name) == {"CANCELLED"}, f"{name}: there is none yet"
        assert add(name) == {"FINISHED"}
        one = len(rows_of(selected, name))
        assert add(name) == {"FINISHED"} or name == "curves"
        many = len(rows_of(selected, name))
        assert 0 < one < many or name == "curves"
        assert bpy.ops.pe.remove_row(rows=name, index=many - 1) == {"FINISHED"}
        assert len(rows_of(selected, name)) == many - 1
        assert bpy.ops.pe.remove_row(rows=name, index=many) == {"CANCELLED"}
        if name in INDEX_OF:
            assert getattr(rows.owner(bpy.context), INDEX_OF[name]) < many - 1


def test_a_row_begins_as_its_kind_says(selected):
    for name, rows in ROW_LISTS.items():
        kinds = [kind for kind, *_ in rows.kinds_now() if kind != "ALL"]
        for kind in kinds[:3]:
            assert add(name, kind=kind) == {"FINISHED"}
        assert len({row.name for row in rows_of(selected, name)}) == len(kinds[:3])
    assert selected.perception_entropy.focus[0].region == "front"


def test_a_copy_stands_below_its_row_and_rows_change_places(selected):
    for kind in ("OWN", "r158_detection"):
        add("requirements", kind=kind)
    settings = selected.perception_entropy
    rows = settings.requirements
    first, second = [row.name for row in rows]
    assert bpy.ops.pe.copy_row(rows="requirements", index=0) == {"FINISHED"}
    assert rows[0].table == rows[1].table != rows[2].table
    assert settings.requirement_index == 1
    assert bpy.ops.pe.move_row(rows="requirements", step=1) == {"FINISHED"}
    assert [row.name for row in rows][:2] == [first, second]
    assert settings.requirement_index == 2
    assert bpy.ops.pe.move_row(rows="requirements", step=1) == {"CANCELLED"}, "it is the last"
    assert bpy.ops.pe.copy_row(rows="focus") == {"CANCELLED"}, "a focus has no copy"


def test_an_unknown_list_changes_nothing(selected):
    assert bpy.ops.pe.add_row(rows="sensors") == {"CANCELLED"}
    assert bpy.ops.pe.remove_row(rows="") == {"CANCELLED"}
