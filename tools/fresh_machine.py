#!/usr/bin/env python3
"""Follow README.md, a workflow or a Dockerfile, line by line on a bare Debian; time each line.

usage: tools/fresh_machine.py [SUITE ...] [--user NAME] [--tests]
       [--workflow FILE | --dockerfile FILE]

A machine is a new Debian folder with nothing but its essential packages, and a clone of the last
commit. README.md is followed twice in each suite: as root, and as a user; `--user` chooses one. The
lines are those of the code blocks below the heading "Get it"; `apt-get` is always root's, and lines
that run tests are left out without `--tests`. Lines of the same block share a shell. A line that
fails ends its machine, not the others. The table has the time and the size of each line; below it
stand how many tests passed, failed and were skipped, and why.

The host lends what reaches the network: its resolver, and the files of certificates that its
environment names. It needs Debian, root and debootstrap; each machine takes 3 GB for a while.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
SUITES = ("bookworm", "trixie")
USER = "newcomer"
CERTIFICATES = ("PIP_CERT", "SSL_CERT_FILE", "REQUESTS_CA_BUNDLE")
BARE_PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
# What a hosted runner has before the first line: git and make, and the Python of `setup-python`.
RUNNER_PACKAGES = "apt-get update && apt-get install -y git make python3-venv"
RUNNER_PYTHON = "/opt/python"
# Processes and mounts of a machine end with the script that runs in it, also when it is killed.
ENTER = ("unshare", "--mount", "--pid", "--fork", "--kill-child")
MOUNTS = 'mount --rbind /dev "$0/dev" && mount -t proc proc "$0/proc"; exec chroot "$0" "$@"'


PRINTED_CHARACTERS = 3000
"""Of what a line that fails has printed."""


class Failed(Exception):
    """A line failed: a message with the end of what it printed, and all that it printed."""


class Step(NamedTuple):
    """A line that was followed: how long it took, and how much larger the machine is then."""

    line: str
    seconds: float
    megabytes: int
    printed: str
    failed: bool


class Machine:
    """A Debian folder that lines are typed into."""

    def __init__(self, folder: Path, user: str = "root") -> None:
        self.folder = folder
        self.user = user
        self.home = "/root" if user == "root" else f"/home/{user}"
        self.env = {"PATH": BARE_PATH, "LC_ALL": "C.UTF-8", "DEBIAN_FRONTEND": "noninteractive"}
        self.env |= self._lent_certificates()
        # An installed Debian has it, debootstrap's has not; without it Blender warns on its output.
        mounts = self.folder / "etc" / "mtab"
        if not mounts.is_symlink():
            mounts.symlink_to("../proc/self/mounts")
        if user != "root":
            self.type(f"useradd --create-home --shell /bin/bash {user}", as_root=True)

    def _lent_certificates(self) -> dict[str, str]:
        shutil.copyfile("/etc/resolv.conf", self.folder / "etc" / "resolv.conf")
        lent = {name: os.environ[name] for name in CERTIFICATES if name in os.environ}
        for name, path in lent.items():
            shutil.copyfile(path, self.folder / "etc" / f"lent-{name}.pem")
        return {name: f"/etc/lent-{name}.pem" for name in lent}

    def clone(self, where: str) -> None:
        """Put a fresh clone of the last commit into the machine."""
        target = self.folder / where.strip("/")
        source = ("git", "clone", "--quiet", "--no-hardlinks", "--depth", "1", f"file://{ROOT}")
        subprocess.run([*source, target], check=True)
        self.type(f"chown -R {self.user} {shlex.quote(where)}", as_root=True)

    def type(self, line: str, *, where: str = "/", as_root: bool = False) -> str:
        """Type lines into a shell of the machine; return what they print."""
        user = "root" if as_root else self.user
        home = "/root" if as_root else self.home
        env = [f"{name}={value}" for name, value in {**self.env, "HOME": home}.items()]
        shell = f"cd {shlex.quote(where)} && {line}"
        inside = ["setpriv", f"--reuid={user}", f"--regid={user}", "--init-groups"]
        inside = [] if user == "root" else inside
        command = ["sh", "-c", MOUNTS, self.folder, *inside, "/usr/bin/env", "-i", *env]
        printed, status = printed_by([*ENTER, *command, "bash", "-c", shell])
        if status != 0:
            raise Failed(f"{line}\n{printed[-PRINTED_CHARACTERS:]}", printed)
        return printed

    def follow(self, lines: list[str], where: str) -> Iterator[Step]:
        """Type lines that share a shell one after the other; yield what each of them took.

        The first line that fails is the last.
        """
        activated = ""
        for line in lines:
            begin = time.monotonic()
            before = self.megabytes()
            failed = False
            try:
                as_root = line.startswith("apt-get")
                printed = self.type(activated + line, where=where, as_root=as_root)
            except Failed as failure:
                printed = failure.args[1]
                failed = True
            seconds = time.monotonic() - begin
            yield Step(line, seconds, self.megabytes() - before, printed, failed=failed)
            if failed:
                return
            if found := re.search(r"(^|&& )(\. \S+/activate)$", line):
                activated = f"{found[2]} && "

    def megabytes(self) -> int:
        """Return how large the machine is."""
        run = subprocess.run(["du", "-sxm", self.folder], capture_output=True, text=True)
        return int(run.stdout.split()[0])


def printed_by(command: list[str | Path]) -> tuple[str, int]:
    """Run a command; return what it printed, which is also shown as it comes, and its status."""
    run = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    printed = []
    for line in run.stdout:
        print(line, end="", file=sys.stderr, flush=True)
        printed.append(line)
    return "".join(printed), run.wait()


def make_base(suite: str, folder: Path) -> Path:
    """Make a bare Debian of a suite in a folder, and return its path."""
    script = ROOT / "tools" / "blender_chroot.sh"
    asked = subprocess.run([script, "--archive"], capture_output=True, text=True, check=True)
    archive, proxy = asked.stdout.split("\n")[:2]
    env = {**os.environ, "http_proxy": proxy.removeprefix("proxy ").replace("none", "")}
    base = folder / suite
    command = ["debootstrap", "--variant=minbase", suite, base, archive]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=env)
    return base


def copy_of(base: Path, name: str) -> Path:
    """Return a copy of a bare Debian."""
    copy = base.with_name(f"{base.name}-{name}")
    subprocess.run(["cp", "-a", base, copy], check=True)
    return copy


def lines_of_readme(text: str) -> list[str]:
    """Return the lines to type below "Get it", without their comments."""
    section = re.split(r"^## ", text, flags=re.MULTILINE)
    chapter = next(part for part in section if part.startswith("Get it"))
    blocks = re.findall(r"^```sh\n(.*?)^```", chapter, re.MULTILINE | re.DOTALL)
    typed = (line.partition("  #")[0].strip() for line in "".join(blocks).splitlines())
    return [line for line in typed if line]


def without_tests(lines: list[str]) -> list[str]:
    """Return the lines that run no tests."""
    return [line for line in lines if line != "make test" and "pytest " not in line]


def follow_readme(machine: Machine, tests: bool) -> list[Step]:
    """Follow README.md in a clone in the home of the machine's user."""
    lines = lines_of_readme((ROOT / "README.md").read_text("utf-8"))
    where = f"{machine.home}/perception-entropy"
    machine.clone(where)
    return list(machine.follow(lines if tests else without_tests(lines), where))


def lines_of_workflow(text: str) -> list[str]:
    """Return what the steps of a workflow run."""
    return re.findall(r"^ +- run: (.*)$", text, re.MULTILINE)


def follow_workflow(machine: Machine, path: Path, tests: bool) -> list[Step]:
    """Follow a workflow, where its first steps have given a checkout and a Python of their own."""
    text = path.read_text("utf-8")
    machine.env |= dict(re.findall(r'^env: \{ (\w+): "(\w+)" \}', text, re.MULTILINE))
    machine.env["PATH"] = f"{RUNNER_PYTHON}/bin:{BARE_PATH}"
    machine.type(f"{RUNNER_PACKAGES} && python3 -m venv {RUNNER_PYTHON}", as_root=True)
    where = f"{machine.home}/perception-entropy"
    machine.clone(where)
    lines = lines_of_workflow(text)
    return list(machine.follow(lines if tests else without_tests(lines), where))


def instructions(text: str) -> Iterator[tuple[str, str]]:
    """Yield the instructions of a Dockerfile and their arguments; lines are joined."""
    text = re.sub(r"^\s*#.*\n", "", text, flags=re.MULTILINE).replace("\\\n", " ")
    for line in filter(None, (line.strip() for line in text.splitlines())):
        name, _, rest = line.partition(" ")
        yield name, " ".join(rest.split())


def follow_dockerfile(path: Path, folder: Path) -> list[Step]:
    """Build the image of a Dockerfile in a folder, and run its command with --version."""
    steps = []
    where = "/"
    machine = None
    for name, rest in instructions(path.read_text("utf-8")):
        if name == "FROM":
            suite = rest.removeprefix("debian:").removesuffix("-slim")
            machine = Machine(make_base(suite, folder))
            continue
        assert machine is not None, "a Dockerfile begins with FROM"
        if name == "ENV":
            for pair in shlex.split(rest):
                key, _, value = pair.partition("=")
                machine.env[key] = value.replace("$PATH", machine.env["PATH"])
        elif name == "COPY":
            machine.clone(rest.split()[-1])  # of the whole checkout
        elif name == "WORKDIR":
            machine.type(f"mkdir -p {rest}")
            where = rest
        elif name == "RUN":
            steps += machine.follow([rest], where)
        elif name == "ENTRYPOINT":
            words = re.findall(r'"([^"]*)"', rest)
            steps += machine.follow([shlex.join([*words, "--version"])], where)
        else:
            raise Failed(f"{path.name}: {name} is not known here")
        if steps and steps[-1].failed:
            break
    return steps


def table(runs: dict[str, list[Step]]) -> str:
    """Return the steps of several machines side by side, as a table in Markdown."""
    lines = [step.line for step in max(runs.values(), key=len)]
    head = f"| line | {' | '.join(runs)} |\n| --- |{' --- |' * len(runs)}\n"
    rows = []
    for number, line in enumerate(lines):
        cells = [cell(steps[number]) if number < len(steps) else "" for steps in runs.values()]
        short = line if len(line) <= 50 else f"{line[:47]}..."
        rows.append(f"| `{short}` | {' | '.join(cells)} |\n")
    return head + "".join(rows)


def cell(step: Step) -> str:
    """Return what a line took, and whether it failed."""
    return f"{step.seconds:.0f} s, {step.megabytes} MB{', **failed**' if step.failed else ''}"


def summary_of_tests(printed: str) -> list[str]:
    """Return pytest's counts, and its reasons of skips with their numbers, the most first."""
    counts = re.findall(r"^=* ?((?:\d+ \w+,? )+)in [\d.]+s", printed, re.MULTILINE)
    reasons: Counter[str] = Counter()
    for number, reason in re.findall(r"^SKIPPED \[(\d+)\] [^ ]+: (.*)$", printed, re.MULTILINE):
        reasons[reason] += int(number)
    skips = [f"skipped {number}: {reason}" for reason, number in reasons.most_common()]
    problems = re.findall(r"^(?:FAILED|ERROR) .*$", printed, re.MULTILINE)
    return [*(count.strip() for count in counts), *skips, *problems]


def report(runs: dict[str, list[Step]]) -> str:
    """Return the table, the tests of each machine, and the end of what failed."""
    parts = [table(runs)]
    for name, steps in runs.items():
        for step in steps:
            if found := summary_of_tests(step.printed):
                rows = "".join(f"- {each}\n" for each in found)
                parts.append(f"{name}, `{step.line}`:\n\n{rows}")
            elif step.failed:
                parts.append(f"{name}, `{step.line}`:\n\n{step.printed[-PRINTED_CHARACTERS:]}")
    return "\n".join(parts)


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("suites", nargs="*", default=SUITES, metavar="SUITE", help="Debian suites")
    parser.add_argument("--user", choices=("root", USER), help="in place of both")
    parser.add_argument("--tests", action="store_true", help="run the tests, too: an hour")
    others = parser.add_mutually_exclusive_group()
    others.add_argument("--workflow", type=Path, help="follow this file, as root alone")
    others.add_argument("--dockerfile", type=Path, help="follow this file in place of README.md")
    options = parser.parse_args()
    if os.geteuid() != 0 or shutil.which("debootstrap") is None:
        print("fresh_machine: needs root and debootstrap", file=sys.stderr)
        return 1
    try:
        with tempfile.TemporaryDirectory(prefix="pe-fresh-") as scratch:
            runs = follow_all(options, Path(scratch))
    except Failed as failed:
        print(f"fresh_machine: this line failed: {failed.args[0]}", file=sys.stderr)
        return 1
    print(report(runs))
    return int(any(step.failed for steps in runs.values() for step in steps))


def follow_all(options: argparse.Namespace, folder: Path) -> dict[str, list[Step]]:
    """Follow what the command line asks for on each machine; return the steps by machine."""
    if options.dockerfile is not None:
        return {options.dockerfile.name: follow_dockerfile(options.dockerfile, folder)}
    users = ("root", USER) if options.user is None else (options.user,)
    if options.workflow is not None:
        users = ("root",)
    runs = {}
    for suite in options.suites:
        base = make_base(suite, folder)
        for user in users:
            machine = Machine(copy_of(base, user), user)
            if options.workflow is not None:
                steps = follow_workflow(machine, options.workflow, options.tests)
            else:
                steps = follow_readme(machine, options.tests)
            runs[f"{suite}, {user}"] = steps
            shutil.rmtree(machine.folder)
    return runs


if __name__ == "__main__":
    sys.exit(main())
