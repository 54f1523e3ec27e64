"""The page and the picture to hand on, from the panel and headless: those of the engine."""

import io
import re

import bpy

import pe_core as pe
from blender_addon import commands
from blender_addon.engine import page
from tests.addon import scenes


def test_headless_blender_writes_the_page_of_the_command_line(car, tmp_path, small_pictures):
    scenes.add_sensor("front", model="Camera 60 deg")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "study.blend"))
    bpy.ops.pe.export_file(filepath=str(tmp_path / "study.toml"))
    arguments = ["--samples", "1024", "-o", str(tmp_path / "inside")]
    said = io.StringIO()
    assert commands.main(["review", *arguments], commands.IN_BLENDER, said) == 0
    inside = (tmp_path / "inside" / page.PAGE).read_text("utf-8")
    assert said.getvalue() == f"{tmp_path / 'inside' / page.PAGE}\n"
    assert "<pre>blender -b study.blend --command pe review --samples 1024 -o" in inside
    from pe_tools.cli.verbs import main

    outside = [str(tmp_path / "study.toml"), *arguments[:2], "-o", str(tmp_path / "outside")]
    assert main(["review", *outside]) == 0
    written = (tmp_path / "outside" / page.PAGE).read_text("utf-8")
    assert without_hosts(inside) == without_hosts(written)
    assert pe.__version__ in written


def without_hosts(text):
    """A page without the programs it was made with, the command line, and the mesh's name."""
    text = re.sub(r"<p>Where its files are, run.*?</pre>\s*", "", text)
    text = re.sub(r"<tr><th scope=\"row\">blender</th>.*?</tr>\s*", "", text)
    return text.replace("study.npz", "vehicle.npz")
