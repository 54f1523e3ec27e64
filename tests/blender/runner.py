"""A real Blender, and a real Blender with the extension installed, as a user would have them."""

import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from tests.blender import process
from tests.limits import HANG_S

ADDON = "bl_ext.user_default.perception_entropy"


@dataclass(frozen=True)
class Blender:
    """The command that starts Blender, and the environment it is started in."""

    command: str
    env: dict[str, str] = field(default_factory=dict)

    def run(
        self, arguments, timeout_s: float = HANG_S, given: str | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run ``blender ARGUMENTS`` to its end, with a text on its standard input."""
        return process.run([self.command, *map(str, arguments)], timeout_s, self.env, given)

    def with_resources(self, folder: Path) -> "Blender":
        """Return the same Blender with a user folder of its own."""
        return Blender(self.command, {**self.env, "BLENDER_USER_RESOURCES": str(folder)})


@dataclass(frozen=True)
class Installed:
    """A Blender whose user folder has the extension in it; a file of its cube, camera and light."""

    blender: Blender
    startup: Path | None = None

    # Nothing of a user's own settings takes part.
    START = ("--factory-startup", "--addons", ADDON)

    def script(self, script: Path, *arguments) -> subprocess.CompletedProcess[str]:
        """Run a Python script inside, without a window; an exception in it gives status 3."""
        return self.blender.run(
            [*self.START, "-b", "--python-exit-code", 3, "--python", script, "--", *arguments]
        )

    def pe(
        self, blend: Path, arguments, given: str | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run ``blender -b BLEND --command pe ARGUMENTS``, with a text on its standard input."""
        command = (*self.START, "-b", blend, "--command", "pe", *arguments)
        return self.blender.run(command, given=given)


def output_of(answer: subprocess.CompletedProcess[str]) -> str:
    """Return all that a run said, for the message of a failed assertion."""
    return f"status {answer.returncode}\n{answer.stdout}\n{answer.stderr}"
