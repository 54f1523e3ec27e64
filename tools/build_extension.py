#!/usr/bin/env python3
"""Build the Blender extension: ``dist/perception_entropy-VERSION.zip``.

``blender_addon/`` and copies of ``pe_core/`` and ``pe_tools/`` inside it are staged in a temporary
folder, then validated and built by Blender's own tool. There all imports of the two packages become
relative: an extension may not add packages to the top level. The same sources give the same bytes.
"""

import ast
import hashlib
import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ADDON = ROOT / "blender_addon"
ENGINE = ROOT / "pe_core"
TOOLS = ROOT / "pe_tools"
MANIFEST = ADDON / "blender_manifest.toml"
PACKED = (ENGINE.name, TOOLS.name)
BUNDLED = ROOT / "tools" / "extension_wheels.txt"
"""Libraries of the tools that Blender does not have: official wheels, by hash."""
KEPT_WHEELS = Path(sys.prefix) / "extension_wheels"
"""Where they are kept once they were downloaded: in the environment."""
FOR_ANY = (
    "--platform",
    "any",
    "--implementation",
    "py",
    "--abi",
    "none",
    "--python-version",
    "3.11",
)
EXAMPLE = "assets/examples/sedan.blend"
"""What the button *Open an Example* opens; a copy of that in `blend_assets`."""
FROM_PACKED = re.compile(r"^(\s*)from ((?:pe_core|pe_tools)\b[\w.]*) import", re.MULTILINE)
PACKED_AS = re.compile(r"^(\s*)import ((?:pe_core|pe_tools)(?: as \w+)?)$", re.MULTILINE)

# Of no use inside Blender, or in the way of the same bytes again.
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.pyc", "tests", ".*", "*.blend1")

TOOL_TIMEOUT_S = 300
ZIP_TIME = (1980, 1, 1, 0, 0, 0)  # the earliest a zip can say
ZIP_FILE_MODE = 0o100644 << 16


class BuildError(Exception):
    """The extension can't be built; the message is one line that says why."""


def agreed_version() -> str:
    """Return the version that engine and manifest give; they must agree."""
    for needed in (MANIFEST, ENGINE / "version.py"):
        if not needed.exists():
            raise BuildError(f"{needed.relative_to(ROOT)} is missing")
    said = {
        "pe_core/version.py": re.findall(r'__version__ = "(.+)"', read("pe_core/version.py"))[0],
        "blender_addon/blender_manifest.toml": tomllib.loads(read(MANIFEST))["version"],
    }
    if len(set(said.values())) > 1:
        listed = ", ".join(f"{version} in {file}" for file, version in said.items())
        raise BuildError(f"the version is to be the same everywhere: {listed}")
    return said["pe_core/version.py"]


def read(path: str | Path) -> str:
    """Return the text of a file of the project."""
    return (ROOT / path).read_text("utf-8")


def stage(target: Path) -> None:
    """Copy add-on, engine, tools, licence and the example.

    Links become files: Blender's tool would drop them.
    """
    shutil.copytree(ADDON, target, ignore=LEFT_OUT)
    for package in (ENGINE, TOOLS):
        # A developer's link to it may stand in the add-on's folder.
        shutil.rmtree(target / package.name, ignore_errors=True)
        shutil.copytree(package, target / package.name, ignore=LEFT_OUT)
    for name in ("LICENSE", "CHANGELOG.md"):
        shutil.copy(ROOT / name, target / name)
    (target / "wheels").mkdir(exist_ok=True)
    wheels = [Path(shutil.copy(wheel, target / "wheels")) for wheel in official_wheels()]
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    manifest = read(MANIFEST).replace("[permissions]", f"wheels = [{listed}]\n\n[permissions]", 1)
    (target / MANIFEST.name).write_text(manifest, "utf-8")
    (target / EXAMPLE).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(ROOT / "blend_assets" / Path(EXAMPLE).name, target / EXAMPLE)
    for path in target.rglob("*.py"):
        source = path.read_text("utf-8")
        relative = with_relative_imports(source, len(path.relative_to(target).parts))
        if relative != source:
            path.write_text(relative, "utf-8")


def official_wheels() -> list[Path]:
    """Return the wheels of the extension, which pip downloads where they are not kept yet."""
    wanted = re.findall(r"sha256:([0-9a-f]{64})", BUNDLED.read_text("utf-8"))
    kept = kept_wheels()
    if missing := [digest for digest in wanted if digest not in kept]:
        download = (
            "-m",
            "pip",
            "download",
            "--quiet",
            "--no-deps",
            "--only-binary=:all:",
            *FOR_ANY,
        )
        where = ("--require-hashes", f"--requirement={BUNDLED}", f"--dest={KEPT_WHEELS}")
        answer = subprocess.run([sys.executable, *download, *where], capture_output=True, text=True)
        kept = kept_wheels()
        missing = [digest for digest in wanted if digest not in kept]
        if answer.returncode != 0 or missing:
            sys.stderr.write(answer.stderr)
            raise BuildError(f"pip could not download the wheels of {BUNDLED.relative_to(ROOT)}")
    return [kept[digest] for digest in wanted]


def kept_wheels() -> dict[str, Path]:
    """Return the wheels that are kept, by the SHA-256 of their bytes."""
    paths = sorted(KEPT_WHEELS.glob("*.whl"))
    return {hashlib.sha256(path.read_bytes()).hexdigest(): path for path in paths}


def with_relative_imports(source: str, dots: int) -> str:
    """Return a module's text with imports of the packed packages relative to the extension.

    Parameters
    ----------
    source : str
    dots : int
        How many dots lead from the module to the extension's package: 1 for a module in it.

    Raises
    ------
    BuildError
        An import that has no relative form: ``import pe_core.scene``.
    """
    up = "." * dots
    source = FROM_PACKED.sub(rf"\1from {up}\2 import", source)
    source = PACKED_AS.sub(rf"\1from {up} import \2", source)
    left = [name for name in imported_names(source) if name.split(".")[0] in PACKED]
    if left:
        raise BuildError(f"an import has no relative form: {left[0]}")
    return source


def imported_names(source: str) -> list[str]:
    """Return the modules that a source imports absolutely."""
    names = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names.append(node.module or "")
    return names


def bpy_tool() -> Path | None:
    """Return Blender's extension tool as it comes with bpy, found without starting Blender."""
    spec = importlib.util.find_spec("bpy")
    if spec is None or spec.origin is None:
        return None
    pattern = "*/scripts/addons_core/bl_pkg/cli/blender_ext.py"
    return next(iter(sorted(Path(spec.origin).parent.glob(pattern))), None)


def extension_command() -> list[str]:
    """Return the start of the command line of Blender's extension tool."""
    if tool := bpy_tool():
        return [sys.executable, str(tool)]
    finder = [sys.executable, str(ROOT / "tools" / "real_blender.py")]
    found = subprocess.run(finder, capture_output=True, text=True)
    if found.returncode != 0:
        raise BuildError("needs bpy in this Python (make extension sees to it) or a Blender")
    # Blender would load its user's add-ons first; none of them matters here.
    return [found.stdout.strip(), "--factory-startup", "--command", "extension"]


def run_tool(command: list[str], *arguments: str) -> None:
    """Run one step of Blender's tool; what it says is shown when it fails."""
    answer = subprocess.run(
        [*command, *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TOOL_TIMEOUT_S,
    )
    if answer.returncode != 0:
        sys.stderr.write(answer.stdout)
        raise BuildError(f"Blender's extension tool refused: {arguments[0]}")


def repack(source: Path, target: Path) -> None:
    """Write the files of an archive again in a fixed order, without times and owners."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in sorted(name for name in old.namelist() if not name.endswith("/")):
            new.writestr(zip_entry(name), old.read(name), zipfile.ZIP_DEFLATED, compresslevel=9)


def zip_entry(name: str) -> zipfile.ZipInfo:
    """Return an entry that is the same on whatever system and whenever it is built."""
    entry = zipfile.ZipInfo(name, ZIP_TIME)
    entry.external_attr = ZIP_FILE_MODE
    entry.create_system = 3  # Unix
    return entry


def build() -> Path:
    """Build the archive and return its path."""
    archive = ROOT / "dist" / f"perception_entropy-{agreed_version()}.zip"
    archive.parent.mkdir(exist_ok=True)
    command = extension_command()
    with tempfile.TemporaryDirectory(prefix="pe-extension-") as scratch:
        staged = Path(scratch, "perception_entropy")
        built = Path(scratch, "built.zip")
        stage(staged)
        run_tool(command, "validate", str(staged))
        run_tool(command, "build", f"--source-dir={staged}", f"--output-filepath={built}")
        packed = Path(scratch, archive.name)
        repack(built, packed)
        run_tool(command, "validate", str(packed))
        check_contents(packed)
        shutil.copyfile(packed, archive)
    return archive


def check_contents(archive: Path) -> None:
    """Make sure that engine and page are in: Blender's tool may leave files out."""
    with zipfile.ZipFile(archive) as packed:
        names = set(packed.namelist())
    presets = {path.relative_to(ROOT).as_posix() for path in ENGINE.glob("**/*.toml")}
    always = {"__init__.py", "blender_manifest.toml", "LICENSE", "CHANGELOG.md", EXAMPLE}
    always |= {path.relative_to(ROOT).as_posix() for path in TOOLS.glob("page/**/*.[cjh][st]*")}
    assets = {path.relative_to(ADDON).as_posix() for path in ADDON.glob("assets/*")}
    for wanted in sorted(always | presets | assets):
        if wanted not in names:
            raise BuildError(f"{wanted} did not get into the archive")
    for name in names:
        if re.search(r"__pycache__|\.pyc$", name):
            raise BuildError(f"{name} does not belong into the archive")


def main() -> int:
    """Run the command line."""
    try:
        print(build())
    except BuildError as problem:
        print(f"build_extension: {problem}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
