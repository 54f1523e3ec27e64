"""A setting is declared in one file: a line there, and file, panel, scene and fingerprint have it.

The line is added to the source of the module as it is imported, in a process of its own.
"""

import subprocess
import sys

SCRIPT = """
import sys
from importlib.abc import MetaPathFinder
from importlib.machinery import PathFinder, SourceFileLoader

LINES = {
    "pe_core.scene.data_sheet": (
        "    data_rate:",
        '    heat: float | None = _figure("W", "Heat that one sensor gives off", "Heat", 50.0)',
    ),
    "pe_core.geometry.grids": (
        "    z: tuple[",
        '    toy: float = setting(0.5, INTERVAL, "A toy", Panel("space_toy", "Toy"), scored=True)',
    ),
}


class Loader(SourceFileLoader):
    def get_code(self, name):
        begin, added = LINES[name]
        lines = self.get_source(name).splitlines()
        at = next(number for number, line in enumerate(lines) if line.startswith(begin))
        return compile("\\n".join([*lines[: at + 1], added, *lines[at + 1 :]]), self.path, "exec")


class Finder(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name not in LINES:
            return None
        spec = PathFinder.find_spec(name, path)
        spec.loader = Loader(name, spec.origin)
        return spec


sys.meta_path.insert(0, Finder())

import bpy
import blender_addon

bpy.ops.wm.read_factory_settings(use_empty=True)
blender_addon.register()

import pe_core as pe
from blender_addon import document
from blender_addon.panels.layout import draw_declared
from pe_core.study import study_from_dict, study_to_dict
from tests.addon import scenes
from tests.addon.layouts import Layout

scene = bpy.context.scene
scenes.add_car(scene)
roof = scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
settings, own = scene.perception_entropy, roof.perception_entropy
before = document.fingerprint(scene)
assert (settings.space_toy, own.heat) == (0.5, 0.0)
settings.space_toy, own.heat = 0.25, 7.0
assert document.fingerprint(scene).text != before.text

assert '"toy": 0.25' in settings.table and '"heat": 7.0' in own.table
study = scenes.study()
data = study_to_dict(study)
assert data["space"]["toy"] == 0.25 and data["sensor"][0]["heat"] == 7.0
del data["vehicle"]
again = study_from_dict(data)
assert again.space.toy == 0.25 and again.rig["roof"].sheet.heat == 7.0

assert bpy.ops.pe.save_variant() == {"FINISHED"}
settings.space_toy, own.heat = 0.5, 3.0
assert document.load_into(scene, study) == []
assert settings.space_toy == 0.25 and own.heat == 7.0
bpy.ops.pe.switch_variant(key=settings.variants[0].key)
assert own.heat == 7.0

for group, part, name in ((settings, "space", "space_toy"), (own, "sensor", "heat")):
    layout = Layout()
    draw_declared(layout, group, part)
    assert name in layout.texts("prop"), layout.notes
print("all have it")
"""


def test_a_line_in_one_file_adds_a_setting_and_a_field_of_a_sensor():
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True)
    assert "all have it" in done.stdout, done.stderr
