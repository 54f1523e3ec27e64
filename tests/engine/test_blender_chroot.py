"""The script that installs Blender takes its packages from where the machine takes its own."""

import os
import shutil
import subprocess

import pytest

from tests.engine.processes import ROOT

pytestmark = pytest.mark.skipif(shutil.which("apt-get") is None, reason="no apt on this system")

SECURITY = "deb http://security.debian.org/debian-security trixie-security main\n"
OTHER = "deb http://deb.nodesource.com/node_20.x nodistro main\n"
STANZA = "Types: deb\nURIs: {}\nSuites: trixie\nComponents: main\n"


def archive(folder, **sources):
    """What the script says on a machine with these files as apt's sources."""
    parts = folder / "parts"
    parts.mkdir()
    for name, text in sources.items():
        (parts / name.replace("_", ".")).write_text(text)
    config = folder / "apt.conf"
    config.write_text(
        f'Dir::Etc::sourcelist "{folder}/none";\nDir::Etc::sourceparts "{parts}";\n'
        f'Dir::State::lists "{folder}/lists";\nAcquire::http::Proxy "http://proxy.example:3128";\n'
    )
    environment = {k: v for k, v in os.environ.items() if not k.endswith(("_proxy", "_ARCHIVE"))}
    return subprocess.run(
        [ROOT / "tools" / "blender_chroot.sh", "--archive"],
        env={**environment, "APT_CONFIG": str(config)},
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "a_list",
            f"{SECURITY}{OTHER}deb [arch=amd64] http://one.example/pub/debian trixie main\n",
        ),
        ("a_sources", STANZA.format("http://one.example/pub/debian/")),
    ],
)
def test_the_archive_and_the_proxy_are_apts_own(tmp_path, name, text):
    run = archive(tmp_path, **{name: text})
    assert run.stdout.splitlines() == [
        "http://one.example/pub/debian/",
        "proxy http://proxy.example:3128",
    ]


def test_without_a_debian_archive_the_line_says_how_to_name_one(tmp_path):
    run = archive(tmp_path, a_list=SECURITY + OTHER)
    assert run.returncode == 1 and not run.stdout
    assert run.stderr.count("\n") == 1 and "DEBIAN_ARCHIVE" in run.stderr
