"""A repository of extensions on a local server: Blender installs from it, and updates from it."""

import functools
import http.server
import json
import re
import shutil
import sys
import threading
import zipfile
from pathlib import Path

import pytest

from tests.blender.runner import output_of
from tests.review.dom import parsed

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools"))
import release  # noqa: E402

HERE = Path(__file__).resolve().parent
OLDER = "0.0.9"


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves a folder and prints nothing."""

    def log_message(self, *_):
        pass


def as_version(archive, version, target):
    """Copy an extension's zip as if it were of another version."""
    with zipfile.ZipFile(archive) as source, zipfile.ZipFile(target, "w") as made:
        for name in source.namelist():
            data = source.read(name)
            if name in ("blender_manifest.toml", "pe_core/version.py"):
                said = re.subn(rb'(?m)^(version|__version__) = ".+"', _line(version), data)
                data, count = said
                assert count == 1, name
            made.writestr(name, data)
    return target


def _line(version):
    return lambda found: found[1] + f' = "{version}"'.encode()


@pytest.fixture(scope="module")
def repositories(extension_zip, tmp_path_factory):
    """Two repositories as `make release` builds them: of an older version, and of this one."""
    folder = tmp_path_factory.mktemp("repositories")
    older = as_version(extension_zip, OLDER, folder / f"perception_entropy-{OLDER}.zip")
    release.build_repository(older, folder / "served")
    release.build_repository(extension_zip, folder / "newer")
    return folder


@pytest.fixture(scope="module")
def served(repositories):
    """The address of the repository that Blender is given."""
    handler = functools.partial(Quiet, directory=str(repositories / "served"))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}/index.json"
        server.shutdown()


@pytest.fixture(scope="module")
def report(blender, repositories, served, sedan, tmp_path_factory):
    """What a scene and the preferences hold before and after an update in a running Blender."""
    folder = tmp_path_factory.mktemp("update")
    own = blender.with_resources(folder / "user")
    add = ("repo-add", "--name", "PE", "--url", served, "pe_site", "--clear-all")
    for verb in (add, ("install", "--sync", "--enable", "perception_entropy")):
        answer = own.run(["--online-mode", "-b", "--command", "extension", *verb])
        assert answer.returncode == 0, output_of(answer)
    scene = shutil.copy(sedan, folder / "scene.blend")
    answer = own.run(
        [
            "--online-mode",
            "-b",
            scene,
            "--python-exit-code",
            3,
            "--python",
            HERE / "inside_update.py",
            "--",
            folder / "report.json",
            repositories / "newer",
            repositories / "served",
        ]
    )
    assert answer.returncode == 0, output_of(answer)
    assert "Traceback" not in answer.stderr, answer.stderr
    return json.loads((folder / "report.json").read_text())


@pytest.mark.thorough
def test_an_update_brings_this_version_and_keeps_scene_preferences_and_score(report, extension_zip):
    before = report["before"]
    after = report["after"]
    version = release.agreed_version()
    assert (before["version"], before["engine"]) == (OLDER, OLDER)
    assert (after["version"], after["engine"]) == (version, version)
    for key in ("enabled", "preference", "interval", "result", "sensors"):
        assert after[key] == before[key], key
    assert not after["preference"] and after["sensors"]
    assert report["score after"] == report["score before"]
    with zipfile.ZipFile(extension_zip) as archive:
        own = sorted(name for name in archive.namelist() if not name.endswith("/"))
    assert report["files"] == own, "nothing is written into the folder of the installation"


def test_the_page_has_a_link_to_drag_into_blender(repositories):
    page = (repositories / "newer" / "index.html").read_text("utf-8")
    version = release.agreed_version()
    links = [each.attributes.get("href", "") for each in parsed(page).all("a")]
    (link,) = (each for each in links if each.startswith(f"./perception_entropy-{version}.zip?"))
    assert "repository=.%2Findex.json" in link and "blender_version_min=4.2.0" in link
