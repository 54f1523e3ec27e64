"""The built zip, installed as a user's own extension into a Blender of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import pe_core as pe
from tests.limits import HANG_S

ROOT = Path(__file__).resolve().parents[2]
SEDAN = ROOT / "blend_assets" / "sedan.blend"

INSTALL_AND_SCORE = """
import pathlib
import sys
import bpy
archive, blend, study = sys.argv[1:]
bpy.ops.extensions.package_install_files(
    filepath=archive, repo="user_default", enable_on_install=True, overwrite=True
)
import bl_ext.user_default.perception_entropy as addon
assert addon.engine.pe.__name__.startswith("bl_ext."), addon.engine.pe
wheels = [path for path in sys.path if "extensions" in path and path.endswith("site-packages")]
assert any(pathlib.Path(path, "ruamel", "yaml").is_dir() for path in wheels), sys.path
bpy.ops.wm.open_mainfile(filepath=blend)
settings = bpy.context.scene.perception_entropy
settings.score_samples = 8192
assert bpy.ops.pe.score() == {"FINISHED"}
bpy.ops.pe.export_study(filepath=study)
print("scored", settings.result_json)
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.perception_entropy")
"""


@pytest.fixture(scope="module")
def archive():
    answer = subprocess.run(
        [sys.executable, str(ROOT / "tools" / "build_extension.py")],
        capture_output=True,
        text=True,
        timeout=HANG_S,
    )
    assert answer.returncode == 0, answer.stderr
    return answer.stdout.strip().splitlines()[-1]


def test_the_zip_installs_and_scores_the_sedan_as_the_engine_does(archive, tmp_path):
    env = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user")}
    study = tmp_path / "study.toml"
    answer = subprocess.run(
        [sys.executable, "-c", INSTALL_AND_SCORE, archive, str(SEDAN), str(study)],
        cwd=tmp_path,  # where no checked-out engine could be picked up by mistake
        env=env,
        capture_output=True,
        text=True,
        timeout=HANG_S,
    )
    assert answer.returncode == 0, answer.stdout + answer.stderr
    loaded = pe.load_study(study)
    score = loaded.evaluator().score(loaded.rig)
    assert f'"entropy": {score.entropy!r}' in answer.stdout
