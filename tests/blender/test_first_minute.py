"""The first minute in a real window: an empty tab, a vehicle from what is selected, an example."""

import shutil

EFFECT_TIMEOUT_S = 120


def test_from_an_empty_tab_to_a_vehicle_and_an_example(stage, installed, tmp_path, screenshots):
    stage.load(shutil.copy(installed.startup, tmp_path))
    stage.rest()
    stage.photograph(screenshots / "first_empty.png")
    stage.do("bpy.data.objects['Cube'].scale = (2.2, 0.9, 0.7)")
    stage.do("bpy.data.objects['Cube'].location.z = 0.7")
    stage.press("pe.use_selected")
    stage.wait_until("bpy.context.scene.perception_entropy.vehicle is not None", EFFECT_TIMEOUT_S)
    stage.rest()
    stage.photograph(screenshots / "first_vehicle.png")
    stage.do("bpy.ops.wm.save_mainfile()")
    stage.do("bpy.ops.pe.open_example()")
    stage.rest()
    stage.wait_until("'Sedan' in bpy.data.collections and not bpy.data.filepath")
    stage.rest()
    stage.photograph(screenshots / "first_example.png")
    assert "Traceback" not in stage.log.read_text()
