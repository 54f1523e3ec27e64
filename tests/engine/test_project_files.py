"""Citation, forms, workflows, Dockerfiles, and the lines that a bare machine is given."""

import re
import sys
import tomllib
from importlib import metadata
from itertools import chain

import pytest
from packaging.specifiers import SpecifierSet
from ruamel.yaml import YAML

from pe_core.version import __version__
from tests.engine.test_docs import ROOT

sys.path.insert(0, str(ROOT / "tools"))
import fresh_machine

GITHUB = ROOT / ".github"


OPTIONAL = ("distributed", "matplotlib", "pandas", "tqdm", "pyarrow", "pycollada", "usd-core")
"""Libraries that pe_core and pe_tools take where they are installed."""
DEBIAN_LIBS = (ROOT / "tools/debian_libs.sh").read_text("utf-8")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def read(path):
    return YAML(typ="safe").load(path.read_text("utf-8"))


def packages_of(name):
    """The packages of a list in `debian_libs.sh`."""
    found = re.search(rf"{name}=\(\s*(.*?)\s*\)", DEBIAN_LIBS, re.S)
    return set(found[1].split())


def instructions_for_people_and_machines():
    """Files with lines that someone types, or a machine runs; by path."""
    folders = ((ROOT, "*.md"), (ROOT / "docs", "**/*.md"), (ROOT / "containers", "*"))
    folders += ((GITHUB / "workflows", "*.yml"), (ROOT / "tools", "*.sh"), (ROOT / ".ci", "run"))
    found = chain.from_iterable(folder.glob(pattern) for folder, pattern in folders)
    return {path: path.read_text("utf-8") for path in (*found, ROOT / "Makefile")}


def test_the_citation_is_of_this_version_and_of_the_paper():
    cited = read(ROOT / "CITATION.cff")
    assert cited["version"] == __version__ and cited["license"] == "GPL-3.0-or-later"
    paper = cited["preferred-citation"]
    assert [each["family-names"] for each in paper["authors"]] == ["Ma", "Liu", "Li"]
    assert paper["title"] in (ROOT / "README.md").read_text("utf-8")


def test_workflows_do_what_the_makefile_does_and_cover_all_systems():
    steps = {}
    for path in (GITHUB / "workflows").glob("*.yml"):
        (job,) = read(path)["jobs"].values()
        steps[path.stem] = "\n".join(step.get("run", "") for step in job["steps"])
    assert "make lint" in steps["linux"] and "make test" in steps["linux"]
    for folder in re.findall(r"tests/\w+", steps["windows_macos"]):
        assert (ROOT / folder).is_dir()
    assert "tests/addon" in steps["windows_macos"] and "tests/engine" in steps["windows_macos"]


@pytest.mark.parametrize(
    "path", sorted((GITHUB / "workflows").glob("*.yml")), ids=lambda path: path.stem
)
def test_hosted_runners_skip_what_they_do_not_have(path):
    """GitHub sets CI=true, with which a missing Blender is a failure."""
    assert read(path)["env"]["CI"] == "false"


@pytest.mark.parametrize("name", ["linux", "windows_macos"])
def test_lines_of_a_workflow_are_those_that_a_fresh_machine_follows(name):
    text = (GITHUB / "workflows" / f"{name}.yml").read_text("utf-8")
    (job,) = read(GITHUB / "workflows" / f"{name}.yml")["jobs"].values()
    runs = [step["run"] for step in job["steps"] if "run" in step]
    assert fresh_machine.lines_of_workflow(text) == runs
    assert 0 < len(fresh_machine.without_tests(runs)) < len(runs)


def test_extras_that_are_installed_anywhere_exist():
    """In `pip install ".[blender,test]"`, `perception-entropy[meshes]`, and make_venv.sh's list."""
    extras = set(PYPROJECT["project"]["optional-dependencies"])
    unknown = []
    installs = (
        r"(?:[\"'./]|/src|perception-entropy|\.whl)\[([a-z][a-z,]*)\]|make_venv\.sh ([a-z,]+) "
    )
    for path, text in instructions_for_people_and_machines().items():
        for match in re.finditer(installs, text):
            named = (match[1] or match[2]).split(",")
            unknown += [(path.name, name) for name in named if name not in extras]
    assert not unknown


def pinned():
    """Requirements of one version, as pip reads them."""
    listed = chain.from_iterable(PYPROJECT["project"]["optional-dependencies"].values())
    return [line for line in listed if re.fullmatch(r"[\w-]+==[\d.]+", line)]


@pytest.mark.thorough  # what is pinned is installed for these alone
@pytest.mark.parametrize("requirement", pinned())
def test_what_is_pinned_can_be_had_on_debian_12(requirement):
    """Its Python is 3.11.2; of what is not pinned pip takes an older version."""
    name, _, version = requirement.partition("==")
    found = metadata.metadata(name)
    if found["Version"] != version:
        pytest.skip(f"{requirement} is not installed")
    assert SpecifierSet(found["Requires-Python"] or "").contains("3.11.2")


def test_the_policy_of_blender_versions_is_that_of_manifest_and_tests():
    """Two LTS, both tested as Python modules; the least version is the manifest's, none is last."""
    manifest = tomllib.loads((ROOT / "blender_addon/blender_manifest.toml").read_text("utf-8"))
    text = (ROOT / "docs/platforms.md").read_text("utf-8").partition("## Which Blender")[2]
    lts = re.findall(r"(\d\.\d) LTS", text.partition("\n## ")[0])
    tested = PYPROJECT["project"]["optional-dependencies"]["blender"]
    assert [re.search(r"bpy==(\d\.\d)", line)[1] for line in tested] == lts and len(lts) == 2
    assert f"least version is {manifest['blender_version_min']}" in " ".join(text.split())
    assert "blender_version_max" not in manifest
    assert manifest["blender_version_min"].split(".") <= [*lts[0].split("."), "0"]


def test_every_extra_is_used_and_every_library_that_may_be_missing_has_one():
    """An extra is installed by a target of the Makefile, or named where it is needed."""
    extras = PYPROJECT["project"]["optional-dependencies"]
    texts = " ".join(instructions_for_people_and_machines().values())
    named = r"\[(?:[\w,]+,)?{0}(?:,[\w,]+)?\]|make_venv\.sh (?:[\w,]+,)?{0}[, ]|`{0}`"
    assert [name for name in extras if not re.search(named.format(name), texts)] == []
    listed = " ".join(chain.from_iterable(extras.values()))
    assert [name for name in OPTIONAL if name not in listed] == []
    assert "trimesh>=5.2,<6" in PYPROJECT["project"]["dependencies"]


def test_no_address_is_given_out_that_is_not_there_yet():
    """Nothing is published, so nothing of ours has a page."""
    assert "Nothing is published yet" in (ROOT / "README.md").read_text("utf-8")
    assert "urls" not in PYPROJECT["project"]
    shipped = [
        path
        for room in ("pe_core", "pe_tools", "blender_addon", "docs")
        for suffix in ("py", "toml", "md", "html", "j2")
        for path in (ROOT / room).rglob(f"*.{suffix}")
    ]
    page = "extensions.blender.org/add-ons/perception"
    assert [path for path in shipped if page in path.read_text("utf-8", "replace")] == []


def test_the_lines_of_readme_are_those_that_a_newcomer_types():
    lines = fresh_machine.lines_of_readme((ROOT / "README.md").read_text("utf-8"))
    assert lines[0].startswith("apt-get update && apt-get install -y make python3-venv libx11-6")
    assert {"make demo", "make test", "make extension", "pip install ."} < set(lines)
    assert packages_of("BPY_LIBS") <= set(lines[0].split())


def test_one_list_names_the_packages_that_tests_need():
    """`.ci/run` and CONTRIBUTING.md ask for it; the browser's has what drives the browser."""
    assert packages_of("BROWSER_PACKAGES") == {"chromium", "libatomic1"}
    for path in (ROOT / ".ci/run", ROOT / "CONTRIBUTING.md"):
        assert "tools/debian_libs.sh --tests" in path.read_text("utf-8"), path.name


def test_the_table_of_a_fresh_machine_tells_tests_and_skips():
    printed = (
        "SKIPPED [3] tests/review/browser.py:49: there is no chromium\n"
        "SKIPPED [2] tests/review/browser.py:52: there is no chromium\n"
        "SKIPPED [1] tests/blender/conftest.py:26: no Blender\n"
        "FAILED tests/engine/test_x.py::test_y - assert 1 == 2\n"
        "=== 1 failed, 293 passed, 6 skipped in 100.10s (0:01:40) ===\n"
    )
    demo = fresh_machine.Step("make demo", 60.0, 500, printed="", failed=False)
    tests = fresh_machine.Step("make test", 100.0, 20, printed=printed, failed=True)
    told = fresh_machine.report({"bookworm": [demo], "trixie": [demo, tests]})
    assert "| `make test` |" in told and "failed**" in told
    rows = [line[2:] for line in told.splitlines() if line.startswith("- ")]
    assert rows[:2] == ["1 failed, 293 passed, 6 skipped", "skipped 5: there is no chromium"]
    assert rows[3].startswith("FAILED tests/engine/test_x.py")


@pytest.mark.parametrize("name", ["pe", "blender"])
def test_dockerfiles_begin_with_debian_and_end_with_their_command(name):
    text = (ROOT / "containers" / f"{name}.Dockerfile").read_text("utf-8")
    steps = list(fresh_machine.instructions(text))
    assert steps[0] == ("FROM", "debian:trixie-slim")
    assert steps[-1][0] == "ENTRYPOINT" and f'"{name}"' in steps[-1][1]
    assert ("COPY", ". /src") in steps
