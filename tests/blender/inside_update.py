"""Run inside Blender: updates the extension from its repository with a scene open, writes JSON.

usage: inside_update.py REPORT NEWER.json FOLDER; the server's folder gets the newer release first.
"""

import json
import shutil
import sys
from pathlib import Path

import addon_utils
import bpy

REPORT, NEWER, SERVED = (Path(argument) for argument in sys.argv[-3:])
PACKAGE = "bl_ext.pe_site.perception_entropy"


def manifest_version() -> str:
    """Return the version of the extension that is installed."""
    folder = Path(sys.modules[PACKAGE].__file__).parent
    line = next(
        line
        for line in (folder / "blender_manifest.toml").read_text("utf-8").splitlines()
        if line.startswith("version")
    )
    return line.split('"')[1]


def state() -> dict:
    """Return what a user must find again after an update."""
    scene = bpy.context.scene.perception_entropy
    sensors = [each for each in bpy.context.scene.objects if each.perception_entropy.is_sensor]
    return {
        "version": manifest_version(),
        "engine": sys.modules[f"{PACKAGE}.pe_core.version"].__version__,
        "enabled": addon_utils.check(PACKAGE),
        "preference": bpy.context.preferences.addons[PACKAGE].preferences.show_library,
        "interval": scene.space_interval,
        "result": scene.result_json,
        "sensors": [(each.name, each.perception_entropy.model) for each in sensors],
    }


def installed_files() -> list[str]:
    """Return the files of the extension's folder, without what Python keeps beside its modules."""
    folder = Path(sys.modules[PACKAGE].__file__).parent
    files = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".pyc")
    return sorted(path.relative_to(folder).as_posix() for path in files)


def score() -> float:
    """Score the open scene."""
    assert bpy.ops.pe.score() == {"FINISHED"}
    return json.loads(bpy.context.scene.perception_entropy.result_json)["entropy"]


scene = bpy.context.scene.perception_entropy
scene.space_interval = 0.5
scene.score_samples = 4096
bpy.context.preferences.addons[PACKAGE].preferences.show_library = False
report = {"score before": score(), "before": state()}
for path in NEWER.iterdir():
    shutil.copy(path, SERVED)
bpy.ops.extensions.repo_sync_all()
bpy.ops.extensions.package_upgrade_all()
report["after"] = state()
report["score after"] = score()
report["files"] = installed_files()
REPORT.write_text(json.dumps(report))
