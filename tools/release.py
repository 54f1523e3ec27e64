#!/usr/bin/env python3
"""Build a release from a clean tree: ``dist/release-VERSION/`` with all that is published.

==========================  ====================================================================
``perception_entropy-*.zip``  the Blender extension, validated by every Blender that is found
``*.whl``, ``*.tar.gz``       wheel and sdist, checked by twine, installed into empty environments
``repository/``               a repository of extensions: ``index.json`` for Blender, and a page
``NOTES.md``                  the changelog of this version
``SHA256SUMS``                checksums of all files above; a second build has to have the same
==========================  ====================================================================

Nothing is published: the folder is what a server or a release page gets.
"""

import argparse
import gzip
import hashlib
import io
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

import build_extension
import real_blender
from build_extension import ROOT, BuildError, agreed_version, bpy_tool, read

WANTED_BLENDERS = ("4.2", "4.3", "4.5", "5")
"""Versions of Blender whose own tool has to validate the extension, by their beginning."""
BPY_VERSIONS = ("4.2", "4.5")
"""Versions of Blender as a Python module that `--install` gets: the LTS versions of Python 3.11."""
DEBIAN_SUITES = ("trixie", "sid")
"""Suites of Debian whose Blenders `--install` gets: 4.3 and 5.x."""
EXTRAS = ("notebook", "cluster", "argoverse", "meshes")
"""Extras of users, each of which is installed into an empty environment of its own."""
EXAMPLE = ROOT / "examples" / "robotaxi_sedan" / "1_roof.toml"
PAGE = ROOT / "tools" / "repository_page.html"
TIMEOUT_S = 1200


def run(*command: str | Path, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    """Run a command to its end and return what it printed; what it says is the error's text."""
    answer = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env={**os.environ, **(env or {})},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TIMEOUT_S,
    )
    if answer.returncode != 0:
        sys.stderr.write(answer.stdout)
        raise BuildError(f"this command failed: {' '.join(str(part) for part in command)}")
    return answer.stdout


def check_tree() -> None:
    """Refuse a tree with changes that are not committed."""
    changed = run("git", "status", "--porcelain").splitlines()
    if changed:
        more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
        raise BuildError(
            f"the tree has changes that are not committed: {changed[0][3:]}{more};"
            " commit them, or use --dirty for a trial"
        )


def notes(version: str) -> str:
    """Return the changelog's section of a version."""
    parts = re.split(r"^## ", read("CHANGELOG.md"), flags=re.MULTILINE)
    for part in parts[1:]:
        if re.match(rf"\[?{re.escape(version)}\b", part):
            return f"# Perception Entropy {part.strip()}\n"
    raise BuildError(f"CHANGELOG.md has no section '## {version}'")


def tools_of_blender() -> Iterator[tuple[str, list[str]]]:
    """Yield each Blender's version and the start of a command line of its extension tool."""
    if tool := bpy_tool():
        yield tool.parents[4].name, [sys.executable, str(tool)]
    own = real_blender.from_environment() or real_blender.from_path()
    for command in (own, *map(real_blender.from_chroot, DEBIAN_SUITES)):
        if command is not None:
            version = re.findall(r"Blender (\S+)", run(command, "--version"))[0]
            yield version, [command, "--factory-startup", "--command", "extension"]
    for python in filter(Path.exists, map(python_of_bpy, BPY_VERSIONS)):
        code = "import importlib.util as u; print(u.find_spec('bpy').origin)"
        origin = Path(run(python, "-c", code).strip())
        tool = next(origin.parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
        yield tool.parents[4].name, [str(python), str(tool)]


def python_of_bpy(version: str) -> Path:
    """Return where the Python is that has a version of Blender as a module."""
    return real_blender.cache_folder() / f"bpy-{version}" / "bin" / "python"


def install_bpy(version: str) -> Path:
    """Return a Python with a version of Blender as a module; install it where there is none."""
    if (tool := bpy_tool()) and tool.parents[4].name == version:
        return Path(sys.executable)
    python = python_of_bpy(version)
    if not python.exists():
        run(sys.executable, "-m", "venv", python.parents[1])
    run(python, "-m", "pip", "install", "-qq", f"bpy=={version}.*")  # again where it broke off
    return python


def install_blenders() -> None:
    """Install the Blenders to validate with that are not there yet; later releases use them, too.

    Raises
    ------
    real_blender.NoBlender
        One cannot be installed here: the message says what it needs.
    BuildError
        pip could not install bpy.
    """
    for suite in DEBIAN_SUITES:  # first: they may be refused at once
        if real_blender.from_chroot(suite) is None:
            real_blender.install(suite)
    for version in BPY_VERSIONS:
        install_bpy(version)


def validate(archive: Path, every_version: bool) -> list[str]:
    """Have each Blender that is found validate the extension; return their versions.

    Raises
    ------
    BuildError
        One refuses it, or one of ``WANTED_BLENDERS`` is not there.
    """
    versions = []
    for version, command in tools_of_blender():
        build_extension.run_tool(command, "validate", str(archive))
        versions.append(version)
    for wanted in WANTED_BLENDERS if every_version else ():
        if not any(version.startswith(wanted) for version in versions):
            raise BuildError(
                f"no Blender {wanted} to validate the extension with (found:"
                f" {', '.join(versions) or 'none'}); `make release` as root on Debian gets it"
            )
    return versions


def build_packages(folder: Path) -> list[Path]:
    """Build sdist, and from it the wheel, dated as the commit; have twine check both."""
    time = run("git", "log", "-1", "--format=%ct").strip()
    env = {"SOURCE_DATE_EPOCH": time}
    run(sys.executable, "-m", "build", "--outdir", folder, ROOT, env=env)
    made = sorted([*folder.glob("*.whl"), *folder.glob("*.tar.gz")])
    repack_sdist(next(path for path in made if path.suffix == ".gz"), int(time))
    run(sys.executable, "-m", "twine", "check", "--strict", *made)
    return made


def repack_sdist(path: Path, time: int) -> None:
    """Write an sdist again without what differs from build to build: times and owners."""
    made = io.BytesIO()
    with tarfile.open(path) as old, tarfile.open(fileobj=made, mode="w") as new:
        for entry in sorted(old.getmembers(), key=lambda entry: entry.name):
            entry.mtime = time
            entry.uid = 0
            entry.gid = 0
            entry.uname = ""
            entry.gname = ""
            entry.mode = 0o755 if entry.isdir() else 0o644
            entry.pax_headers = {}
            new.addfile(entry, old.extractfile(entry) if entry.isfile() else None)
    path.write_bytes(gzip.compress(made.getvalue(), mtime=time))


def try_wheel(wheel: Path, extra: str = "") -> None:
    """Install the wheel into an empty environment and score the example with it.

    Raises
    ------
    BuildError
        pip, ``pe --version`` or ``pe score`` failed, or the version is another.
    """
    with tempfile.TemporaryDirectory(prefix="pe-wheel-") as scratch:
        run(sys.executable, "-m", "venv", Path(scratch, "venv"))
        binaries = Path(scratch, "venv", "bin" if os.name == "posix" else "Scripts")
        target = f"{wheel}[{extra}]" if extra else str(wheel)
        run(binaries / "python", "-m", "pip", "install", "-qq", target, cwd=Path(scratch))
        said = run(binaries / "pe", "--version", cwd=Path(scratch))
        if agreed_version() not in said:
            raise BuildError(f"the installed command says {said.strip()!r}")
        run(
            binaries / "pe",
            "score",
            EXAMPLE,
            "--samples",
            "4096",
            "-o",
            "scored",
            cwd=Path(scratch),
        )


def build_repository(archive: Path, folder: Path) -> None:
    """Make the folder that a server offers to Blender: the zip, ``index.json`` and a page."""
    folder.mkdir()
    shutil.copyfile(archive, folder / archive.name)
    build_extension.run_tool(
        build_extension.extension_command(),
        "server-generate",
        f"--repo-dir={folder}",
        "--html",
        f"--html-template={PAGE}",
    )


def checksums(folder: Path) -> str:
    """Return the digests of all files in the form that ``sha256sum --check`` reads."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}\n"
        for path in files
    )


def build_all(folder: Path, version: str) -> tuple[Path, list[Path]]:
    """Build all that is published into a new folder; return the extension and the packages.

    Raises
    ------
    BuildError
        A step failed, or the changelog has no section of this version.
    """
    folder.mkdir()
    archive = Path(shutil.copy(build_extension.build(), folder))
    packages = build_packages(folder)
    build_repository(archive, folder / "repository")
    (folder / "NOTES.md").write_text(notes(version), "utf-8")
    (folder / "SHA256SUMS").write_text(checksums(folder), "utf-8")
    return archive, packages


def require_same(first: Path, second: Path) -> None:
    """Raise `BuildError` when two builds differ; the message names a file that does."""
    sums = [(each / "SHA256SUMS").read_text("utf-8").splitlines() for each in (first, second)]
    if different := sorted(set(sums[0]) ^ set(sums[1])):
        raise BuildError(f"two builds differ: {different[0].split()[-1]}")


def release(arguments: argparse.Namespace) -> Path:
    """Build everything and return the folder; an earlier one of this version is replaced."""
    if not arguments.dirty:
        check_tree()
    version = agreed_version()
    notes(version)  # a missing section is noticed before anything is built
    if arguments.install and not arguments.dirty:
        install_blenders()
    made = ROOT / "dist" / f"release-{version}"
    (ROOT / "dist").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".release-", dir=ROOT / "dist") as scratch:
        folder = Path(scratch, "release")
        archive, packages = build_all(folder, version)
        tell(f"extension, {size_of(archive)}", validate(archive, not arguments.dirty))
        build_all(Path(scratch, "again"), version)
        require_same(folder, Path(scratch, "again"))
        tell("built twice", ["the same digests"])
        wheel = next(path for path in packages if path.suffix == ".whl")
        extras = () if arguments.quick else EXTRAS
        for extra in ("", *extras):
            try_wheel(wheel, extra)
        tell("wheel and sdist", [path.name for path in packages])
        tell("wheel installed and run", ["alone", *(f"with [{extra}]" for extra in extras)])
        shutil.rmtree(made, ignore_errors=True)
        folder.rename(made)
    return made


def size_of(archive: Path) -> str:
    """Return how large an archive is, packed and unpacked, as text."""
    with zipfile.ZipFile(archive) as packed:
        unpacked = sum(entry.file_size for entry in packed.infolist())
    return f"{archive.stat().st_size / 1e6:.1f} MB, {unpacked / 1e6:.1f} MB unpacked"


def tell(what: str, details: list[str]) -> None:
    """Print one step that is done."""
    print(f"release: {what}: {', '.join(details)}", flush=True)


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    about = "a trial: allow changes that are not committed, and any versions of Blender"
    parser.add_argument("--dirty", action="store_true", help=about)
    parser.add_argument("--quick", action="store_true", help="try the wheel without its extras")
    about = "first install the Blenders to validate with (Debian, root; 4 GB below ~/.cache, once)"
    parser.add_argument("--install", action="store_true", help=about)
    try:
        print(release(parser.parse_args()))
    except (BuildError, real_blender.NoBlender) as problem:
        print(f"release: {problem}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
