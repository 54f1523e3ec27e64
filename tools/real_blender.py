#!/usr/bin/env python3
"""Find a real Blender of 4.2 or later, or install one, and print the command that runs it.

The first of these that will do:

1. ``$BLENDER``, which must do when it is set;
2. ``blender`` in ``PATH``;
3. Debian's Blender in a folder of its own below ``~/.cache/perception-entropy``, which
   ``--install`` makes (Debian, root, about two minutes and 1.5 GB).

The command printed behaves like ``blender``. Exit status: 0 found, 1 none, with one line why.
"""

import argparse
import contextlib
import fcntl
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

TOOLS = Path(__file__).resolve().parent
OLDEST = (4, 2)  # the first Blender with extensions and --command
VERSION_TIMEOUT_S = 60


class NoBlender(Exception):
    """No Blender can be had; the message is one line that says why."""


def blender_version(command: str) -> tuple[int, int] | None:
    """Return (major, minor) as the command itself says, or None when it does not run."""
    try:
        answer = subprocess.run(
            [command, "--version"], capture_output=True, text=True, timeout=VERSION_TIMEOUT_S
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    found = re.search(r"^Blender (\d+)\.(\d+)", answer.stdout, re.MULTILINE)
    return (int(found[1]), int(found[2])) if found else None


def from_environment() -> str | None:
    """Return ``$BLENDER`` as a full path; it was asked for, so it must do."""
    named = os.environ.get("BLENDER")
    if not named:
        return None
    command = shutil.which(named)
    version = blender_version(command) if command else None
    if version is None:
        raise NoBlender(f"BLENDER={named} does not run")
    if version < OLDEST:
        raise NoBlender(f"BLENDER={named} is {version[0]}.{version[1]}; 4.2 or later is needed")
    return command


def from_path() -> str | None:
    """Return the ``blender`` in ``PATH`` when it is new enough."""
    command = shutil.which("blender")
    version = blender_version(command) if command else None
    return command if version and version >= OLDEST else None


def cache_folder() -> Path:
    """Return the folder that outlives checkouts."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base).resolve() / "perception-entropy"


def chroot_folder(suite: str) -> Path:
    """Return where the Blender of a Debian suite goes."""
    return cache_folder() / f"blender-{suite}"


def is_finished(folder: Path) -> bool:
    """Tell a whole installation from what a broken-off one left."""
    return (folder / ".finished").exists()


def from_chroot(suite: str) -> str | None:
    """Return the runner of an installed Debian folder, brought up to date with this checkout."""
    folder = chroot_folder(suite)
    if not is_finished(folder):
        return None
    runner = folder.with_suffix(".sh")
    source = TOOLS / "blender_chroot.sh"
    if not runner.exists() or runner.read_bytes() != source.read_bytes():
        fresh = runner.with_suffix(f".{os.getpid()}")
        shutil.copy(source, fresh)
        fresh.replace(runner)  # another process may be starting it
    if blender_version(str(runner)) is None:
        raise NoBlender(f"{runner} does not run here (it needs mount namespaces: root, or unshare)")
    return str(runner)


def find(suite: str, *, host_only: bool = False) -> str | None:
    """Return the command of the first Blender that will do."""
    found = from_environment() or from_path()
    return found or (None if host_only else from_chroot(suite))


@contextlib.contextmanager
def only_one(folder: Path) -> Iterator[int]:
    """Let one installation at a time work in the cache.

    Yields the lock for the processes started to inherit: it ends with the last of them.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "install.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield lock.fileno()


def install(suite: str) -> None:
    """Make the Debian folder of a suite: built under another name, renamed when it works."""
    if os.geteuid() != 0:
        again = f"tools/real_blender.py --suite {suite} --install"
        where = f"XDG_CACHE_HOME={cache_folder().parent}"  # not root's own
        raise NoBlender(f"installing Debian {suite}'s Blender needs root: sudo {where} {again}")
    if shutil.which("apt-get") is None:
        raise NoBlender("--install needs Debian; elsewhere install Blender and set BLENDER")
    if subprocess.run([TOOLS / "debian_libs.sh", "--window"], stdout=sys.stderr).returncode:
        raise NoBlender("the host's packages could not be installed")
    with only_one(cache_folder()) as lock:
        if not is_finished(chroot_folder(suite)):
            build_chroot(suite, lock)


def build_chroot(suite: str, lock: int) -> None:
    """Build the folder of a suite and put it in place."""
    folder = chroot_folder(suite)
    unfinished = folder.with_suffix(".unfinished")
    log = folder.with_suffix(".log")
    print(f"real_blender: installing Debian {suite}'s Blender, log in {log}", file=sys.stderr)
    for leftover in (folder, unfinished):
        shutil.rmtree(leftover, ignore_errors=True)
    command = [TOOLS / "blender_chroot.sh", "--build", suite, unfinished]
    with log.open("w") as output:
        status = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            pass_fds=[lock],
        ).returncode
    if status != 0:
        raise NoBlender(f"installing Debian {suite}'s Blender failed; see the end of {log}")
    (unfinished / ".finished").touch()
    unfinished.rename(folder)


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--install", action="store_true", help="install one when there is none")
    parser.add_argument("--suite", default="trixie", help="Debian suite: trixie or sid")
    parser.add_argument("--host-only", action="store_true", help="look in $BLENDER and PATH")
    options = parser.parse_args()
    try:
        command = find(options.suite, host_only=options.host_only)
        if command is None and options.install:
            install(options.suite)
            command = find(options.suite)
        if command is None:
            raise NoBlender(
                "no Blender 4.2 or later in $BLENDER or PATH; "
                "on Debian, `sudo tools/real_blender.py --install` gets one"
            )
    except NoBlender as problem:
        print(f"real_blender: {problem}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("real_blender: interrupted", file=sys.stderr)
        return 130
    print(command)
    return 0


if __name__ == "__main__":
    sys.exit(main())
