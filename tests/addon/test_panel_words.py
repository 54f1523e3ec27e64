"""Sentences broken to fit a sidebar of any width, and where panels stand."""

import itertools

import bpy

from blender_addon import document
from blender_addon.engine import advice
from blender_addon.panels import CLASSES, layout, main
from tests.addon import layouts

SENTENCE = "the vehicle collection Sedan is excluded from the view layer: nothing of it is scored"


TEXTS = (SENTENCE, "bl_ext_a_name_without_any_gap_that_is_long", "WWWW ii", "")


def test_no_line_is_wider_than_its_room_and_no_word_is_lost(addon):
    blf = layout.blf  # Blender has it once bpy is there
    for text, room, size in itertools.product(TEXTS, (60.0, 120.0, 260.0, 2000.0), (11.0, 22.0)):
        lines = layout.wrapped_lines(text, room, size)
        blf.size(0, size)
        assert all(blf.dimensions(0, line)[0] <= room for line in lines)
        assert "".join(lines).replace(" ", "") == text.replace(" ", "")
        for line, after in itertools.pairwise(lines):  # as much as fits stands in a line
            assert blf.dimensions(0, f"{line} {after.split()[0]}")[0] > room, (text, room, size)


def drawn_of(scene):
    """What the first panel shows, in its order."""
    return layouts.drawn(main.main, **vars(layouts.Window(scene)))


def test_names_that_differ_at_their_ends_differ_where_the_room_is_narrow(car):
    names = [f"Camera fender front {side}" for side in ("left", "right")]
    window = layouts.Window(car)
    assert [layout.fitted(window, each, 60.0, 0.74) for each in names] == names
    window.region.width = 280
    first, second = (layout.fitted(window, each, 60.0, 0.5) for each in names)
    assert first != second and len(first) < len(names[0])
    assert all(
        text.startswith("Cam") and text[-4:] == name[-4:]
        for text, name in zip((first, second), names, strict=True)
    )


def test_score_live_and_optimize_stand_first_and_late_lines_have_their_room(car):
    settings = car.perception_entropy
    before = drawn_of(car)
    assert [text for kind, text in before.notes if kind in ("operator", "prop")][:3] == [
        "pe.score",
        "on",
        "pe.optimize",
    ]
    counts = [len(before.texts("label"))]
    bpy.ops.pe.score()
    settings.result_stale = False
    counts.append(len(drawn_of(car).texts("label")))
    settings.result_stale = True
    shown = drawn_of(car).texts("label")
    assert "Out of date" in shown
    assert {*counts, len(shown)} == {counts[0]}, "as many lines before, after and when it is stale"
    document.store_warnings(settings, [advice.Advice("roof", "clear", {"gap": 0.6})])
    assert len(drawn_of(car).texts("label")) == counts[0], "warnings move nothing"
    order = [cls.__name__ for cls in CLASSES]
    assert order.index("PE_PT_sensor") < order.index("PE_PT_explain"), "nor the selected sensor"
